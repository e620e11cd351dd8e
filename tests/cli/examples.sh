#!/bin/bash
# The examples of docs/commands.md, which stand in the manual pages, run in their order in one folder.
# Those that need a bench, a key, another machine's files or much time are parsed only.
# Usage: examples.sh WIREBENCH SOURCE_ROOT
set -u
wirebench=$(realpath "$1")
root=$2
export WIREBENCH_DATA=$root
folder=$(mktemp -d /tmp/wb-examples-XXXXXX)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/bin" "$folder/work"
ln -s "$wirebench" "$folder/bin/wirebench"
export PATH=$folder/bin:$PATH
cd "$folder/work" || exit 1
failures=0

awk '/^### /{ inside = /^### Examples/ } /^#+ / && !/^### /{ inside = 0 } inside && /^    wirebench /{ sub(/^ +/, ""); print }' \
    "$root/docs/commands.md" >../examples
[ "$(wc -l <../examples)" -ge 40 ] || { echo "too few examples"; exit 1; }
for command in $(wirebench --help | awk '/^  [a-z]/ { print $1 }'); do
    grep -q "^wirebench $command " ../examples || { echo "no example of $command"; failures=1; }
done

# What the examples of imports and comparisons read.
printf 'wire: w\nsample: 1\nouter_diameter_mm: 5\n' >piece.yaml
cp "$root/fixtures/machines/two-rollers.yaml" machine.yaml
awk 'BEGIN { print "Load (N)\tExtension (mm)"; for (i = 0; i < 60; i++) printf "%g\t%g\n", i / 10, i / 20 }' >bend.txt
cp "$root/docs/cards/type1.yaml" lot-a.yaml
cp "$root/docs/cards/type1.yaml" lot-b.yaml

while read -r line; do
    case $line in
    # A bench of one's own, a process that runs on, a take, a key, minutes of computing.
    *' rig.yaml'* | *'--scan'* | *' bench/'* | *' &' | *take.c3d* | *'--sign'* | *'--check'* | \
        'wirebench report'*' -o report' | *'--method paper'*)
        continue
        ;;
    esac
    said=$(bash -c "$line" 2>&1 </dev/null)
    code=$?
    # 3: of one virtual specimen little is known, or the calibration says so.
    [ $code -eq 0 ] || [ $code -eq 3 ] || [[ $code -eq 4 && $line == *'campaigns/harness.yaml'* ]] || {
        echo "FAILED with $code: $line"
        echo "$said"
        failures=1
    }
done <../examples
for file in type1-1.wbr data/type1-1/dataset.json type1.yaml type1.svg type1-100.svg bend.yaml lots.pdf section.svg \
    type1-1.h5 type1.inp imported/dataset.json type1-validation/scores.csv; do
    [ -e $file ] || { echo "no $file was written"; failures=1; }
done
exit $failures
