#!/bin/bash
# `wirebench record --series` on virtual benches in virtual time: answers from standard input, an
# exclusion and where it is reported, a series that was stopped, killed, or run twice at once.
# Usage: series.sh WIREBENCH SOURCE_ROOT
set -u
. "$(dirname "$0")/wait.sh"

wirebench=$(realpath "$1")
root=$2
folder=$(mktemp -d /tmp/wb-series-XXXXXX)
failures=0
rig=$root/fixtures/rigs/paper.yaml
virtual=(--virtual --start 2026-11-25 --seed 3)
trap 'rm -rf "$folder"' EXIT
cp "$root/fixtures/specimens/type1-L85-1.yaml" "$folder/like.yaml"
cat >"$folder/series.yaml" <<END
series: s
specimen: like.yaml
specimens: 3
ask: [notes]
travel_mm: 12
END

# A person judges on a real day, whatever day the virtual test has: today, or at midnight tomorrow.
day="\\($(date -u +%F)\\|$(date -u -d tomorrow +%F)\\)"
fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# series NAME ANSWERS OPTIONS...: the series into $folder/NAME; exit code in $code.
series() {
    local name=$1 answers=$2
    shift 2
    printf '%b' "$answers" | "$wirebench" record "$rig" "${virtual[@]}" \
        --series "$folder/series.yaml" -o "$folder/$name" --operator 'A. Tester' "$@" \
        >"$folder/$name.out" 2>"$folder/$name.err"
    code=$?
}

expect() { # NAME CODE WORDS: the exit code, and what was said
    [ "$code" = "$2" ] || fail "$1: exit code $code, expected $2: $(cat "$folder/$1.err")"
    grep -q -- "$3" "$folder/$1.err" "$folder/$1.out" || fail "$1: '$3' not said: $(cat "$folder/$1.err")"
}

holds() { # FILE WORDS
    grep -q -- "$2" "$folder/$1" || fail "$1 does not hold '$2': $(cat "$folder/$1")"
}

# The first specimen is tested and kept; the second one's test is excluded, and then the answers end.
stopped_and_gone_on_with() {
    series a 'first note\n\n\n\n\nx the wire slipped\n' --figure "$folder/a.svg"
    expect a 3 '2 of 3 specimens done; run the same command again to continue'
    holds a.out '^next    run the same command again to continue$'
    holds a.err 'standard input is not a terminal: answers are read from it'
    holds a.out 'excluded: the wire slipped'
    grep -Eq '^tests +1 +1 +1 +1$' "$folder/a.out" || fail "a: not one test counts: $(cat "$folder/a.out")"
    [ -s "$folder/a.svg" ] || fail 'a: no figure'
    "$wirebench" info "$folder/a/s-001-type1-L85-1.wbr" >"$folder/info" 2>&1
    holds info 'notes  *first note'
    holds info 'series  *s, test 1'
    "$wirebench" info "$folder/a/s-002-type1-L85-2.wbr" >"$folder/info" 2>&1
    holds info "EXCLUDED  *by A. Tester on $day: the wire slipped"
    holds info 'sample 2'
    "$wirebench" info "$folder/a/s-002-type1-L85-2.wbr" --json >"$folder/info" 2>&1
    holds info '"reason": "the wire slipped"'
    "$wirebench" align "$folder/a/s-002-type1-L85-2.wbr" -o "$folder/dataset" >/dev/null 2>&1
    holds dataset/dataset.json 'the test was excluded by A. Tester'
    "$wirebench" calibrate "$folder/dataset" -o "$folder/properties.yaml" 2>"$folder/refused" &&
        fail 'an excluded test was calibrated'
    holds refused "the test was excluded by A. Tester on $day: the wire slipped. Leave"
    # The third one twice: somebody leaned on the bench.
    series a 'n\n\nr I leaned on the bench\nn\n\n\n' --figure "$folder/a.svg" --json
    expect a 0 '"specimens_done": 3'
    grep -q '"number": 4' "$folder/a.out" || fail "a: no fourth test: $(cat "$folder/a.out")"
    [ "$(ls "$folder/a" | tr '\n' ' ')" = \
        'index.yaml s-001-type1-L85-1.wbr s-002-type1-L85-2.wbr s-003-type1-L85-3.wbr s-004-type1-L85-3.wbr ' ] ||
        fail "a: other files: $(ls "$folder/a")"
    cp "$folder/a/index.yaml" "$folder/index.before"
    series a ''
    expect a 0 '3 of 3 specimens done'
    holds a.out '^found   series s: 3 of 3 specimens done, 4 tests (2 excluded) of type1, L = 85 mm (virtual rig)$'
    holds a.out '^trust   yes: 2 tests aligned without warnings$'
    holds a.out "^next    wirebench align $folder/a/s-001-type1-L85-1.wbr $folder/a/s-004-type1-L85-3.wbr -o $folder/a/datasets$"
    cmp -s "$folder/a/index.yaml" "$folder/index.before" || fail 'a: a series that is done was changed'
}

# Who excluded what, and why, is on the report's page.
reported() {
    cat >"$folder/campaign.yaml" <<END
title: A series
index: a/index.yaml
calibration_length_mm: 85
samples: 3
whole_cycle: false
wires:
  - wire: type1
END
    "$wirebench" report "$folder/campaign.yaml" -o "$folder/report" >"$folder/report.out" 2>&1
    holds report.out '2 of 2 recordings used'
    holds report/report.html "s-002-type1-L85-2.wbr</b>: excluded by A. Tester on $day: the wire slipped"
    holds report/report.html "s-003-type1-L85-3.wbr</b>: excluded by A. Tester on $day: I leaned on"
    holds report/report.json '"reason": "the wire slipped"'
}

# Killed while it waits for the operator's judgement: the test is judged at the next start, under
# its number, and no other is recorded for that sample. The kill is the series' own only process.
killed_before_the_judgement() {
    mkfifo "$folder/answers"
    exec 8<>"$folder/answers"
    "$wirebench" record "$rig" "${virtual[@]}" --series "$folder/series.yaml" -o "$folder/b" \
        --operator 'A. Tester' <"$folder/answers" >"$folder/b.out" 2>"$folder/b.err" &
    local recorder=$!
    printf 'n\n\n' >&8
    wait_until $recorder grep -qs '^Enter: keep it' "$folder/b.err" || fail "b: $(cat "$folder/b.err")"
    series c '' -o "$folder/b"
    expect c 1 'another series is recorded into'
    kill -KILL $recorder
    wait $recorder 2>/dev/null
    exec 8>&-
    [ ! -e "$folder/b/index.yaml" ] || fail 'b: listed before it was judged'
    series b '\nn\nq\n'
    expect b 3 'not yet kept or excluded'
    expect b 3 '1 of 3 specimens done'
    holds b.err 'recording s-002-type1-L85-2.wbr'
    holds b/index.yaml "file: 's-001-type1-L85-1.wbr'"
}

# Answers that are none are asked for again; a test that did not begin is asked for again under the
# next number, and is not in the index.
wrong_answers_and_refused_tests() {
    series d 'n\n\nx\nwhat?\nk\nn\nq\n'
    expect d 3 'give a reason'
    holds d.err "'what?'"
    holds d.err '1 of 3 specimens done'
    # The bench's own ports are not there.
    virtual=()
    series d 'n\n\nn\nq\n'
    expect d 3 '1 of 3 specimens done'
    [ "$(grep -c 'recording s-002-type1-L85-2.wbr' "$folder/d.err")" = 2 ] ||
        fail "d: the specimen is not asked for again: $(cat "$folder/d.err")"
    printf 'series: s\nspecimen: like.yaml\nspecimens: 3\noutput: "{series}.wbr"\n' >"$folder/bad.yaml"
    "$wirebench" record "$rig" --series "$folder/bad.yaml" </dev/null >"$folder/e.out" 2>"$folder/e.err"
    code=$?
    expect e 1 'bad.yaml:4: output: expected {number}'
    "$wirebench" record --series "$folder/series.yaml" </dev/null >"$folder/e.out" 2>"$folder/e.err"
    code=$?
    expect e 1 "name the rig file before --series, or with 'rig'"
    "$wirebench" record --series "$folder/series.yaml" --cycles 2 </dev/null >"$folder/e.out" 2>"$folder/e.err"
    code=$?
    expect e 2 '--cycles cannot be combined with --series: write cycles into'
}

for case in stopped_and_gone_on_with reported killed_before_the_judgement wrong_answers_and_refused_tests; do
    before=$failures
    $case
    [ $failures = $before ] && echo "ok: $case" || echo "not ok: $case"
done
${WIREBENCH_CHECK_FILES:-true} "$folder" || fail 'a file does not follow its schema'
[ $failures = 0 ]
