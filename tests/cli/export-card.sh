#!/bin/sh
# wirebench export --to: cards of wire and properties files, refusals, and the examples in docs/cards,
# which are what the tool writes of docs/cards/type1.yaml but for its own version. Usage:
#     export-card.sh WIREBENCH SOURCE_ROOT
set -eu
tool=$(realpath "$1")
examples=$2/docs/cards
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() {
    echo "$*"
    exit 1
}
expect() { # CODE WORDS ARGUMENTS...
    wanted=$1 words=$2 code=0
    shift 2
    "$tool" export "$@" >"$folder/out" 2>"$folder/err" || code=$?
    [ "$code" = "$wanted" ] || fail "export $*: exit code $code: $(cat "$folder/err")"
    cat "$folder/out" "$folder/err" >"$folder/both"
    grep -qF -e "$words" "$folder/both" || fail "export $*: does not say '$words': $(cat "$folder/both")"
}
without_version() {
    sed -e '/Written by wirebench/d' -e '/"revision":/d' -e '/"version":/d' "$1"
}

for kind in calculix:calculix.inp abaqus:abaqus.inp mujoco:mujoco.xml table:json table-csv:csv; do
    "$tool" export "$examples/type1.yaml" --to "${kind%:*}" -o "$folder/card"
    without_version "$folder/card" >"$folder/now"
    without_version "$examples/type1.${kind#*:}" >"$folder/then"
    cmp -s "$folder/now" "$folder/then" ||
        fail "docs/cards/type1.${kind#*:} is not what --to ${kind%:*} writes: $(diff "$folder/now" "$folder/then" | head -5)"
    head -n 1 "$folder/card" | grep -q 'MADE OF VIRTUAL DATA' || fail "$kind: not in the first line"
    rm "$folder/card"
done

expect 0 'LOADING ONLY' type2 --to calculix
expect 0 '"wire": "type2"' type2 --to=table
expect 0 'segment7' type1 --to mujoco --segments 7 --length-mm 50 --curvature 5
expect 2 'expected one of calculix' type1 --to nastran
expect 2 'without a kind, with -o FILE.h5' type1 --to hdf5
expect 2 '--to mujoco' type1 --to table --segments 3
expect 1 'none.yaml' "$folder/none.yaml" --to table
expect 1 'is a material file, expected a properties file or a wire file' "$2/fixtures/materials/pvc.yaml" --to table
printf 'SQLite format 3\0\0' >"$folder/test.wbr"
expect 1 'is a recording, expected a properties file or a wire file' "$folder/test.wbr" --to table
"$tool" export type1 --to table -o "$folder/once"
expect 1 'exists; --force' type1 --to table -o "$folder/once"
echo old >"$folder/once"
"$tool" export type1 --to table -o "$folder/once" --force
grep -q moment_curvature "$folder/once" || fail "--force does not overwrite"
