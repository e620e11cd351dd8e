"""Calibrates a wire on datasets and prints its properties and bending moments. Recordings are aligned in
memory; folders are those written by `wirebench align`.

    python3 calibrate_dataset.py recordings/type1-L85-1.wbr.zst
"""

import sys
import warnings

import numpy as np
import wirebench


def get(path):
    if path.endswith((".wbr", ".wbr.zst")):
        return wirebench.align(path)
    return wirebench.Dataset(path)


def main(paths):
    warnings.simplefilter("ignore", wirebench.Remark)
    properties = wirebench.calibrate([get(path) for path in paths])
    info = properties.info
    print("wire %s, method %s, %d sample%s" %
          (info.wire, info.method, info.n_samples, "" if info.n_samples == 1 else "s"))
    print("EI %.9g N m2, candidates %.9g to %.9g" %
          (info.rigidity.value, info.rigidity.candidates_low, info.rigidity.candidates_high))
    curvature = info.largest_curvature * np.arange(1, 5) / 4
    for at, moment in zip(curvature, properties.moments(curvature)):
        print("M at %.4g 1/m: %.9g N m" % (at, moment))
    print("residual curvature ratio %.9g from %.4g 1/m" %
          (properties.bend(info.largest_curvature).residual_curvature_ratio, info.largest_curvature))


if __name__ == "__main__":
    main(sys.argv[1:])
