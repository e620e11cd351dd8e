"""Solves a three-point bending test and prints force over deflection, loading and unloading.

    python3 solve_three_point.py type1 0.04 0.008
"""

import sys

import numpy as np
import wirebench

STEPS = 10  # of each branch


def main(wire, span, largest):
    down = largest * np.arange(STEPS + 1) / STEPS
    # Rollers and nose of 3 mm radius, without friction.
    solution = wirebench.solve_three_point(wirebench.Properties.read(wire), span,
                                           np.concatenate([down, down[-2::-1]]),
                                           roller_radius=0.003, nose_radius=0.003)
    print("deflection_m,force_N,middle_moment_Nm")
    for i in range(solution.n_done):
        print("%.9g,%.9g,%.9g" %
              (solution.deflection[i], solution.force[i], solution.middle_moment[i]))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), float(sys.argv[3]))
