#!/bin/sh
# Runs the tests of data acquisition and of the virtual rig beside processes that keep every core
# busy, as often as told: none of them may depend on how busy the machine is. Says which failed, and
# exits with 1 if any did.
# Usage: busy.sh BUILD_FOLDER [RUNS (default 10) [SUITE|TEST...]]
set -u

build=${1:?usage: busy.sh BUILD_FOLDER [RUNS [TEST...]]}
runs=${2:-10}
[ $# -lt 2 ] && shift 1 || shift 2
[ -f "$build/build.ninja" ] || { echo "no build folder $build" >&2; exit 2; }
ninja -C "$build" --quiet || exit 2

# Longest that one run may take; the busy processes end by themselves at the latest with the last.
run_s=600
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
    if [ $# -gt 0 ]; then
        timeout $run_s meson test -C "$build" --no-rebuild -t 4 "$@" >"$folder/log" 2>&1
    else
        timeout $((run_s / 2)) meson test -C "$build" --no-rebuild -t 4 --suite daq >"$folder/log" 2>&1 &&
            timeout $((run_s / 2)) meson test -C "$build" --no-rebuild -t 4 --suite cli record rig \
                >"$folder/log" 2>&1
    fi
    if [ $? = 0 ]; then
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
