#!/usr/bin/env bash
# The checks that take too long for .ci/run: slow tests, all fast tests under sanitizers, process
# tests beside busy processes, Slurm, packages, bare Debian systems. Run as root (debootstrap and
# chroot require it) before an issue is closed; takes some hours and 12 GB below FOLDER.
# Passed steps are recorded with their times in build/nightly.txt, and passed slow tests in
# build/nightly-slow.txt: the same command on the same revision continues with the remaining ones.
# The output ends with the table for docs/verification.md.
# Usage: tests/nightly.sh FOLDER [STEP...]   (names of steps as printed; default: all)
set -uo pipefail
folder=${1:?usage: tests/nightly.sh FOLDER [STEP...]}
shift
mkdir -p "$folder" || exit 1
folder=$(cd "$folder" && pwd)
cd "$(dirname "$0")/.." || exit 1
# shellcheck source=tests/steps.sh
. tests/steps.sh

[ -z "$(git status --porcelain)" ] || {
    echo 'uncommitted changes: commit them first, packages and bare systems use the last commit' >&2
    exit 2
}
revision=$(git describe --always --abbrev=12)
state=build/nightly.txt slow=build/nightly-slow.txt
mkdir -p build
[ "$(sed -n 1p $state 2>/dev/null)" = "$revision" ] || {
    echo "$revision" >$state
    : >$slow
}

# Like step, but does not repeat a step that passed before.
wanted=("$@")
known=()
nightly() { # NAME COMMAND...
    known+=("$1")
    [ ${#wanted[@]} -eq 0 ] || printf '%s\n' "${wanted[@]}" | grep -qxF "$1" || return 0
    ! grep -q "^$1|ok|" $state || return 0
    step "$@"
    grep -vF "$1|" $state >"$scratch/state"
    { cat "$scratch/state"; echo "${steps[-1]}"; } >$state
}

build_with_clang() {
    [ -f build-clang/build.ninja ] || CC=clang meson setup build-clang --werror -Dtests=enabled >/dev/null || return 1
    ninja -C build-clang --quiet
}

# The output of earlier runs is kept, unbuffered, so that a passed test is not repeated. The time
# limit only stops a test that hangs; it must not depend on the speed of the machine.
test_slow() {
    local all left
    all=$(list_tests build --suite slow)
    [ -n "$all" ] || return 1
    mapfile -t left < <(comm -23 <(echo "$all") \
        <(sed -nE 's#^ *[0-9]+/[0-9]+ wirebench:slow / ([^ ]+) +(OK|SKIP) .*#\1#p' $slow | sort -u))
    [ ${#left[@]} -eq 0 ] || PYTHONUNBUFFERED=1 meson test -C build --no-rebuild --suite slow \
        --timeout-multiplier 10 --print-errorlogs "${left[@]}" | tee -a $slow
}

test_under_sanitizers() {
    configure_sanitizers build-sanitize address,undefined -Dvector_kernels=true &&
        meson test -C build-sanitize --setup sanitize --no-suite slow --no-suite headers --print-errorlogs
}

# Its tests are skipped without Slurm, so the number of passed tests is checked.
test_slurm() {
    install_packages slurm-wlm munge &&
        meson test -C build --no-rebuild jobs_slurm --print-errorlogs | tee "$scratch/slurm" &&
        grep -q '^Ok: *1' "$scratch/slurm"
}

nightly 'build' ./bootstrap build
nightly 'clang build' build_with_clang
nightly 'slow tests' test_slow
nightly 'fast tests under sanitizers' test_under_sanitizers
nightly 'process tests beside busy processes' tests/repeat.sh build 0 3 0
nightly 'Slurm' test_slurm
nightly 'packages' tests/packages.sh "$folder/packages"
nightly 'bare Debian 12' tests/bare-debian.sh "$folder/bare" bookworm
nightly 'bare Debian 13' tests/bare-debian.sh "$folder/bare" trixie

for name in "${wanted[@]+"${wanted[@]}"}"; do
    printf '%s\n' "${known[@]}" | grep -qxF "$name" || failed+=("$name")
done
for name in "${failed[@]+"${failed[@]}"}"; do
    echo "FAILED: $name"
done

echo
echo "Revision $revision, $(date +%F), $(nproc) cores:"
echo
echo '| step | result | seconds |'
echo '| --- | --- | --- |'
sed 1d $state | awk -F '|' '{ printf "| %s | %s | %s |\n", $1, $2, $3 }'
[ ${#failed[@]} -eq 0 ]
