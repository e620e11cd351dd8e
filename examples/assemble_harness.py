"""Assembles a harness by the steps of its file and prints the forces on what is mounted; then it
undoes the last step and prints them again.

    python3 assemble_harness.py small
"""

import sys

import wirebench


def print_forces(harness):
    info, forces = harness.info, harness.table("forces")
    for item, force in zip(forces["item"], forces["force_N"]):
        print("%d,%s,%s,%.9g" % (info.state, info.step, item, force))


def main(path_or_name):
    with wirebench.Harness(path_or_name) as harness:
        print("state,step,item,force_N")
        for step in harness.planned_steps:
            harness.take_step(step)
            print_forces(harness)
        harness.undo()
        print_forces(harness)


if __name__ == "__main__":
    main(sys.argv[1])
