#!/bin/bash
# `wirebench solve harness --gltf`: the scene against the table of shapes, and what goes wrong.
# Usage: harness-gltf.sh WIREBENCH SOURCE_ROOT PYTHON, which has NumPy.
. "$2/tests/cli/reports.sh"
root=$2 python=$3
export WIREBENCH_DATA=$root
cd "$folder" || exit 1

check() { # HARNESS ARGUMENTS...
    local file=$1 name
    name=$(basename "$file" .yaml)
    shift
    "$wirebench" solve harness "$file" "$@" --no-figure -o "$name" --gltf "$name.glb" >said 2>warned ||
        fail "$name: $(cat said warned)"
    [ -f "$file" ] || file=$root/fixtures/harnesses/$name.yaml
    "$python" "$root/tests/cli/gltf.py" "$name.glb" "$name/shapes.csv" "$file" ||
        fail "the scene of $name is wrong"
}
check small --frames 5
check door --law elastic --frames 5
# The mark of a sliding clip follows the place where the wire slides, also within a step.
sed 's/name: small/name: slides/; s/holds: axis/holds: slide/; /mount: C1/s/, direction.*/}/' \
    "$root/fixtures/harnesses/small.yaml" >slides.yaml
check slides.yaml --law elastic --frames 8
awk -F, '$2 == "C1" && $1 > 2 && $1 < 4 { slid[$NF] } END { exit length(slid) < 8 }' slides/forces.csv ||
    fail "C1 does not slide within its steps: $(cut -d, -f1,2,13 slides/forces.csv)"
"$wirebench" info small.glb >kind && grep -q 'glTF' kind || fail "info small.glb: $(cat kind)"

# The same bytes again; without steps beyond the first, and where nothing yields.
"$wirebench" solve harness small --frames 5 --gltf again.glb >said 2>warned || fail 'again'
cmp small.glb again.glb || fail 'the same command gives other bytes'
grep -q 'again.glb' said || fail "the scene is not named: $(cat said)"
sed '/^  - {m/d; /^  - {r/d; /take_off/d' "$root/fixtures/harnesses/small.yaml" >hung.yaml
"$wirebench" solve harness hung.yaml --gltf hung.glb -o hung --no-figure >said || fail 'hang alone'
"$python" "$root/tests/cli/gltf.py" hung.glb hung/shapes.csv hung.yaml || fail 'hung.glb is wrong'

ends_with 2 "'scene.gltf' does not end in .glb" solve harness small --gltf scene.gltf
ends_with 1 "'small.glb' exists; --force" solve harness hung.yaml --gltf small.glb
cmp -s small.glb again.glb || fail 'a rejected command writes'
ends_with 1 'nowhere' solve harness hung.yaml --gltf nowhere/a.glb
ends_with 0 hung.glb solve harness hung.yaml --gltf hung.glb --force
[ -z "$(find . -name '*.glb?*')" ] || fail "parts remain: $(find . -name '*.glb?*')"
finish 'solve harness --gltf'
