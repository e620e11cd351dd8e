#!/bin/sh
# The examples in Python print the same as those in C. Usage:
#     examples-python.sh PYTHON EXAMPLES_FOLDER SOURCE_ROOT RECORDING DATASET
set -eu
python=$1 examples=$2 source=$3 recording=$4 dataset=$5
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
compare() { # EXAMPLE ARGUMENTS...
    name=$1
    shift
    "$examples/$name" "$@" >"$folder/c"
    "$python" "$source/examples/$name.py" "$@" >"$folder/python"
    [ -s "$folder/c" ] && cmp "$folder/c" "$folder/python" || { echo "$name differs"; exit 1; }
}
compare read_recording "$recording"
compare calibrate_dataset "$dataset"
compare calibrate_dataset "$recording"
compare solve_cantilever type1 0.085 0.05
compare solve_three_point type1 0.04 0.008
compare assemble_harness small
