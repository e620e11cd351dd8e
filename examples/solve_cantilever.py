"""Solves a cantilever test and prints force over deflection, loading and unloading.

    python3 solve_cantilever.py type1 0.085 0.05
"""

import sys

import numpy as np
import wirebench

STEPS = 10  # of each branch


def main(wire, length, largest):
    up = largest * np.arange(STEPS + 1) / STEPS
    solution = wirebench.solve_cantilever(wirebench.Properties.read(wire), length,
                                          np.concatenate([up, up[-2::-1]]))
    print("deflection_m,force_N,root_moment_Nm")
    for i in range(solution.n_done):
        print("%.9g,%.9g,%.9g" %
              (solution.deflection[i], solution.force[i], solution.root_moment[i]))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), float(sys.argv[3]))
