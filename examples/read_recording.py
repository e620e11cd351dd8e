"""Reads a recording and prints whether it is complete, its streams, and the range of the load
cell's readings.

    python3 read_recording.py recordings/type1-L85-1.wbr.zst
"""

import sys

import numpy as np
import wirebench


def main(path):
    with wirebench.Recording(path) as recording:
        info = recording.info
        print("%s, %.3f s, %s" % ("virtual rig" if info.is_virtual else "bench", info.duration,
                                  "whole" if info.is_whole else "damaged"))
        for problem in recording.problems:
            print("problem:", problem)
        for stream in recording.streams:
            print("stream %d %s: %d samples, %.1f/s" %
                  (stream.id, stream.protocol, stream.samples, stream.rate))
        force = recording.table("load")["force_N"]
        print("load: %d readings, %.9g to %.9g N" %
              (force.size, np.nanmin(force), np.nanmax(force)))


if __name__ == "__main__":
    main(sys.argv[1])
