#!/bin/sh
# libwirebench exports exactly the functions that its header declares, and each declaration stands
# below a comment; it needs no MPI. Usage: exports.sh LIBRARY HEADER
set -eu
library=$1 header=$2
bad=0
exported=$(nm -D --defined-only "$library" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' |
    LC_ALL=C sort)
# The word before an opening bracket is the name of a declaration.
declared=$(grep -v '^ \*\|^/\*\|^    ' "$header" | grep -oE '\bwirebench_[a-z_]+\(' | tr -d '(' |
    LC_ALL=C sort -u)
[ "$(echo "$declared" | wc -l)" -ge 20 ] || { echo "the header was not understood"; exit 1; }
[ "$exported" = "$declared" ] || {
    echo "exported and declared differ:"
    echo "exported: $exported" >&2
    echo "declared: $declared" >&2
    bad=1
}
readelf -d "$library" | grep -q 'SONAME.*\[libwirebench\.so\.0\]' || { echo "wrong soname"; bad=1; }
! readelf -d "$library" | grep 'NEEDED.*mpi' || { echo "needs MPI"; bad=1; }
exit $bad
