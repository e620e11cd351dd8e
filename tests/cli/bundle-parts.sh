#!/bin/sh
# wirebench solve bundle in parts: on two threads and on two ranks the same dataset; a run that was
# killed goes on from its checkpoint to the same dataset. Usage: bundle-parts.sh WIREBENCH
set -eu
tool=$(realpath "$1")
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cat >three.yaml <<YAML
name: three
wires: [{wire: type3, count: 3}]
packing: triangle
tape: tape
length_mm: 114
interface: {cohesive_stiffness_N_mm3: 30, friction: 0.4}
meshes: [{name: coarse, core_quads: 2, rings: 0, elements_along: 40}]
run: {mesh: coarse, deflection_mm: 20, rows: 5, selective_mass_scaling: 100, duration_s: 0.04}
loads: {weight: false, strand_mm: 760}
YAML
same() { # what two datasets have in common: all but the times
    for file in force_deflection energies shape surface; do
        cmp "$1/$file.csv" "$2/$file.csv" || { echo "$1 and $2 differ"; exit 1; }
    done
}
# What a kill in the middle of writing leaves under a name of its own is no state.
same_states() { # of two folders of VTK files
    [ "$(ls "$1"/*.vtu | wc -l)" -eq 6 ] || { echo "states are missing:"; ls "$1"; exit 1; }
    for file in "$1"/*.vtu "$1"/*.pvd; do
        cmp "$file" "$2/${file##*/}" || { echo "states of $1 and $2 differ"; exit 1; }
    done
}
"$tool" solve bundle three.yaml --threads 2 -o threads --vtk threads-vtk 2>log || { cat log; exit 1; }
grep -q '"threads": 2' threads/dataset.json || { echo "the dataset does not name its threads"; exit 1; }

# Killed as soon as there is a checkpoint and a row, again and again until it is through.
kills=0
while :; do
    "$tool" solve bundle three.yaml --threads 2 -o killed --vtk vtk --checkpoint state \
        --checkpoint-minutes 0.001 2>log &
    process=$!
    rows=$(ls vtk 2>/dev/null | wc -l)
    while kill -0 $process 2>/dev/null && [ $kills -lt 2 ]; do
        [ -f state ] && [ "$(ls vtk 2>/dev/null | wc -l)" -gt "$rows" ] && {
            kill -9 $process 2>/dev/null || true
            break
        }
        sleep 0.05
    done
    wait $process && break
    [ -f state ] || { echo "it failed without a checkpoint:"; cat log; exit 1; }
    kills=$((kills + 1))
    [ $kills -lt 5 ] || { cat log; exit 1; }
done
[ $kills -gt 0 ] || { echo "it was never killed"; exit 1; }
grep -q ': continues at [0-9.]* mm, step' log || { echo "it did not go on:"; cat log; exit 1; }
[ ! -e state ] || { echo "the checkpoint was left behind"; exit 1; }
same threads killed
same_states vtk threads-vtk

# Another run's checkpoint is refused, and left alone.
printf 'wirebench checkpoint 2\nanother\n0\n0\nend\n' >state
! "$tool" solve bundle three.yaml --threads 2 -o other --checkpoint state 2>log || exit 1
grep -q 'another run' log || { cat log; exit 1; }
[ -f state ] || exit 1

# A run that was stopped goes on by the same binary, with the same --vtk, over no other's dataset.
rm state
mkdir other
"$tool" solve bundle three.yaml --threads 2 -o other --vtk states --checkpoint state 2>log &
process=$!
until ls states/*-0001.vtu >/dev/null 2>&1 || ! kill -0 $process 2>/dev/null; do sleep 0.05; done
kill -INT $process
wait $process && { echo "it was not stopped"; exit 1; }
grep -q 'run the same command again to continue' log || { cat log; exit 1; }
refused() { # WHY COMMAND...
    why=$1
    shift
    ! "$@" 2>log || { echo "not refused: $why"; exit 1; }
    grep -q -e "$why" log || { echo "not refused with '$why':"; cat log; exit 1; }
    [ -f state ] || { echo "the checkpoint is gone: $why"; exit 1; }
}
set -- solve bundle three.yaml --threads 2 --checkpoint state
refused "of a run with --vtk=.*states" "$tool" "$@" -o other --vtk vtk
refused "of a run with --vtk=.*states" "$tool" "$@" -o other --vtk states --vtk-every 2
refused "of a run with --vtk=.*states" "$tool" "$@" -o other
refused "of a run with -o" "$tool" "$@" --vtk states
cp "$tool" changed
printf 'x' >>changed
refused "another run" ./changed "$@" -o other --vtk states
refused "or --force" "$tool" "$@" -o threads --vtk states
refused "cannot\|can be written" "$tool" solve bundle three.yaml -o other --checkpoint nowhere/state
"$tool" "$@" -o other --vtk states 2>log || { cat log; exit 1; }
same threads other
same_states states threads-vtk
[ ! -e state ] || { echo "the checkpoint was left behind"; exit 1; }

# A result that cannot be written leaves the checkpoint.
"$tool" "$@" -o whole --checkpoint-minutes 0.001 2>log &
process=$!
until [ -f state ] || ! kill -0 $process 2>/dev/null; do sleep 0.05; done
rmdir whole && touch whole
! wait $process || { echo "it wrote into a file"; exit 1; }
[ -f state ] || { echo "the checkpoint went with its result"; exit 1; }

command -v mpirun >/dev/null || { echo "no mpirun: ranks were left out"; exit 0; }
if ! "$here/../ranks.sh" 2 "$tool" solve bundle three.yaml -o ranks --vtk ranks-vtk \
    >log 2>&1; then
    grep -q 'built without MPI' log || { cat log; exit 1; }
    echo "built without MPI: ranks were left out"
    exit 0
fi
grep -q '"ranks": 2' ranks/dataset.json || { echo "the dataset does not name its ranks"; exit 1; }
same threads ranks
same_states ranks-vtk threads-vtk

# Ranks that are stopped go on, too.
"$here/../ranks.sh" 2 "$tool" solve bundle three.yaml -o resumed --checkpoint state \
    --checkpoint-minutes 0.001 >log 2>&1 &
process=$!
until [ -f state ] || ! kill -0 $process 2>/dev/null; do sleep 0.05; done
[ -f state ] || { echo "no checkpoint of ranks:"; cat log; exit 1; }
kill -TERM $process
wait $process && { echo "ranks were not stopped"; exit 1; }
"$here/../ranks.sh" 2 "$tool" solve bundle three.yaml -o resumed --checkpoint state >log 2>&1 ||
    { cat log; exit 1; }
grep -q ': continues at [0-9.]* mm, step' log || { echo "ranks did not go on:"; cat log; exit 1; }
same threads resumed
${WIREBENCH_CHECK_FILES:-true} .
