#!/bin/sh
# What a program prints on one rank with N threads is what it prints on N ranks, bit for bit:
# ranks_equal.sh N PROGRAM; the program takes the number of threads of a rank.
set -eu
command -v mpirun >/dev/null || {
    echo "skipped: no mpirun (Debian: openmpi-bin)"
    exit 77
}
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$2" "$1" >"$folder/threads"
"$(dirname "$0")/ranks.sh" "$1" "$2" 1 >"$folder/ranks"
[ -s "$folder/threads" ] || { echo "nothing was printed"; exit 1; }
diff "$folder/threads" "$folder/ranks"
