#!/bin/sh
# A program must print the same on one rank with N threads and on N ranks, bit for bit:
# ranks_equal.sh N PROGRAM; the argument of the program is the number of threads of a rank.
set -eu
command -v mpirun >/dev/null || {
    echo "skipped: no mpirun (Debian: openmpi-bin)"
    exit 77
}
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$2" "$1" >"$folder/threads"
"$(dirname "$0")/ranks.sh" "$1" "$2" 1 >"$folder/ranks"
[ -s "$folder/threads" ] || { echo "the program printed nothing"; exit 1; }
diff "$folder/threads" "$folder/ranks"
