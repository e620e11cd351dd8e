#!/usr/bin/env bash
# Tests the guarantees of the recorder and writes docs/reliability.md: each event, its number of
# trials and the result. Includes the slow tests and ten minutes at ten times a bench's rates; takes
# half an hour. Usage: reliability.sh BUILD [quick]; quick leaves out the slow ones and
# writes to standard output.
set -eu
build=$(realpath "${1:?usage: reliability.sh BUILD [quick]}")
quick=${2:-}
root=$(cd "$(dirname "$0")/.." && pwd)
trials=$(mktemp)
trap 'rm -f "$trials"' EXIT
export WIREBENCH_TRIALS=$trials

# Names of the tests that count their trials, from their source files.
names() {
    (cd "$root" && git grep -l 'count_trials(' -- 'tests/**/test_*.c' 'tests/**/fuzz_*.c') |
        sed 's|.*/||; s|^test_||; s|\.c$||'
    (cd "$root" && git grep -l 'include "tests/.*fuzz.*\.h"' -- 'tests/**/fuzz_*.c') |
        sed 's|.*/||; s|\.c$||'
    [ "$quick" = quick ] || printf '%s\n' storage_slow recording_flips_all
}

known=$(meson test -C "$build" --list 2>/dev/null | sed 's/^[^/]*\/ *//' | sort -u)
# If a slow test repeats a fast test with more trials, only the slow test is run.
wanted=$(names | sort -u | grep -Fx "$known" || true)
[ "$quick" = quick ] || wanted=$(printf '%s\n' "$wanted" | grep -vx -e storage -e recording_flips)

# shellcheck disable=SC2086 # names of tests are words
meson test -C "$build" $wanted >&2
[ "$quick" = quick ] || "$build/tests/bench/bench_acquisition" 600 >&2

table() {
    echo '| event | trials | result | test |'
    echo '| --- | --- | --- | --- |'
    sort -t "$(printf '\t')" -k1,1 -k3,3 "$trials" |
        awk -F '\t' '
            { key = $1 FS $3 }
            !(key in tried) { order[++n] = key }
            { tried[key] += $2 }
            index(tests[key], "`" $4 "`") == 0 {
                tests[key] = tests[key] (tests[key] == "" ? "" : ", ") "`" $4 "`"
            }
            END {
                for (i = 1; i <= n; i++) {
                    split(order[i], part, FS)
                    printf "| %s | %d | %s | %s |\n", part[1], tried[order[i]], part[2],
                        tests[order[i]]
                }
            }'
}

if [ "$quick" = quick ]; then
    table
    exit
fi
page=$root/docs/reliability.md
{
    sed '/^<!-- counts -->$/q' "$page"
    echo
    table
} >"$page.new"
mv "$page.new" "$page"
