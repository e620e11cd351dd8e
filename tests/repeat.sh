#!/bin/sh
# Repeats tests, to find tests that depend on the load of the machine. By default the suites daq, live
# and process run ten times on the machine as it is and ten times beside four busy processes per core,
# and all fast tests run three times. Results are kept in BUILD_FOLDER/repeat.txt, so that the same
# command continues after an interrupt; a change of the source, or removing the file, starts over.
# Prints the number of runs without a failure and the failed tests; exits with 1 if any test failed.
# Usage: repeat.sh BUILD_FOLDER [ALONE BUSY WHOLE [TEST...]]   (default 10 10 3; with TEST..., these
# tests instead of the suites)
set -u

build=${1:?usage: repeat.sh BUILD_FOLDER [ALONE BUSY WHOLE [TEST...]]}
alone=${2:-10} beside=${3:-10} whole=${4:-3}
if [ $# -gt 4 ]; then
    shift 4
else
    set -- --suite daq --suite live --suite process
fi
[ -f "$build/build.ninja" ] || { echo "$build is not a build folder" >&2; exit 2; }
ninja -C "$build" --quiet || exit 2

# The first line of the file identifies source and tests.
state=$build/repeat.txt
root=$(cd "$(dirname "$0")/.." && pwd)
subject="$(git -C "$root" describe --always --abbrev=12) $(git -C "$root" diff HEAD | cksum) $*"
[ "$(sed -n 1p "$state" 2>/dev/null)" = "$subject" ] || echo "$subject" >"$state"

longest_s=3600 # time limit of one run; busy processes also end after it
busy=
folder=$(mktemp -d)
calm_down() {
    # shellcheck disable=SC2086 # process numbers are words
    [ -z "$busy" ] || kill $busy 2>/dev/null
    busy=
}
trap 'calm_down; rm -rf "$folder"' EXIT
trap 'exit 130' INT TERM

# A line of the state file: KIND RUN RESULT SECONDS [TEST...].
run() { # KIND RUN ARGUMENT...
    kind=$1 number=$2
    shift 2
    ! grep -q "^$kind $number " "$state" || return 0
    began=$(date +%s)
    code=0
    timeout $longest_s meson test -C "$build" --no-rebuild "$@" >"$folder/log" 2>&1 || code=$?
    [ $code -lt 128 ] || exit $code # interrupted
    # meson succeeds without running anything if it does not know the name of a test.
    grep -q '^Ok: *[1-9]' "$folder/log" || code=1
    wrong=
    if [ $code != 0 ]; then
        wrong=$(sed -nE 's|^ *[0-9]+/[0-9]+ [^/]* / ([^ ]+) +(FAIL\|TIMEOUT\|ERROR\|INTERRUPT) .*|\1|p' "$folder/log" | sort -u | tr '\n' ' ')
        cp "$build/meson-logs/testlog.txt" "$build/meson-logs/repeat-$kind-$number.txt"
        wrong=${wrong:-unknown}
    fi
    echo "$kind $number $([ $code = 0 ] && echo ok || echo FAILED) $(($(date +%s) - began)) $wrong" >>"$state"
    tail -n 1 "$state"
}

for number in $(seq "$alone"); do
    run alone "$number" "$@"
done
for number in $(seq "$beside"); do
    for _ in $(seq "$(($(nproc) * 4))"); do
        timeout $longest_s sh -c 'while :; do :; done' &
        busy="$busy $!"
    done
    # The time limit only stops a test that hangs; it must not depend on the speed of the machine.
    run busy "$number" --timeout-multiplier 20 "$@"
    calm_down
done
for number in $(seq "$whole"); do
    run whole "$number" --no-suite slow
done

runs=$(sed 1d "$state" | wc -l)
good=$(sed 1d "$state" | grep -c '^[a-z]* [0-9]* ok ')
echo "$good of $runs runs without a failure"
[ "$good" = "$runs" ] || {
    echo "failed: $(sed 1d "$state" | grep -v '^[a-z]* [0-9]* ok ' | cut -d ' ' -f 5- | tr ' ' '\n' | sort | uniq -c | awk 'NF == 2 { printf "%s%s (%d)", separator, $2, $1; separator = ", " }')"
    echo "logs: $build/meson-logs/repeat-*.txt"
    exit 1
}
