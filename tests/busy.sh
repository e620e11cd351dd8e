#!/bin/sh
# Runs the suites daq and cli beside processes that keep every core busy: none of their tests may
# depend on how busy the machine is. Prints which failed, and exits with 1 if any did.
# Usage: busy.sh BUILD_FOLDER [RUNS [TEST...]]   (10 runs; of these tests in place of the suites)
set -u

build=${1:?usage: busy.sh BUILD_FOLDER [RUNS [TEST...]]}
runs=${2:-10}
shift
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- --suite daq --suite cli
[ -f "$build/build.ninja" ] || { echo "no build folder $build" >&2; exit 2; }
ninja -C "$build" --quiet || exit 2

# Longest that one run may take; the busy processes end by themselves at the latest with the last.
run_s=1200
busy=
cleaned=
clean_up() {
    [ -z "$cleaned" ] || return
    cleaned=yes
    # shellcheck disable=SC2086 # process numbers are words
    kill $busy 2>/dev/null
    rm -rf "$folder"
}
folder=$(mktemp -d)
trap clean_up EXIT
trap 'exit 130' INT TERM
for _ in $(seq "$(($(nproc) * 2))"); do
    timeout $((run_s * runs)) sh -c 'while :; do :; done' &
    busy="$busy $!"
done

failures=0
for run in $(seq "$runs"); do
    began=$(date +%s)
    code=0
    timeout $run_s meson test -C "$build" --no-rebuild "$@" >"$folder/log" 2>&1 || code=$?
    # meson is content with a name that it does not know.
    grep -q '^Ok: *[1-9]' "$folder/log" || code=1
    if [ $code = 0 ]; then
        echo "run $run: ok, $(($(date +%s) - began)) s"
    else
        echo "run $run: FAILED, $(($(date +%s) - began)) s"
        grep -E '(FAIL|TIMEOUT|ERROR) +[0-9]' "$folder/log"
        cp "$build/meson-logs/testlog.txt" "$build/meson-logs/busy-$run.txt"
        echo "    see $build/meson-logs/busy-$run.txt"
        failures=$((failures + 1))
    fi
done
echo "$failures of $runs runs failed"
[ $failures = 0 ]
