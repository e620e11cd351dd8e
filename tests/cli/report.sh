#!/bin/bash
# `wirebench report` as a user meets it: exit codes, what it prints, what it leaves alone.
# Usage: report.sh WIREBENCH
. "$(dirname "$0")/reports.sh"

cat >"$folder/empty.yaml" <<'YAML'
title: Nothing there
index: none.yaml
calibration_length_mm: 85
validation_length_mm: 100
samples: 2
wires:
  - wire: type1
YAML

run 2
run 2 "$folder/empty.yaml"
run 2 "$folder/empty.yaml" -o "$folder/r" --threads 0
run 2 "$folder/empty.yaml" other.yaml -o "$folder/r"
[ -e "$folder/r" ] && fail 'wrong usage made a folder'

run 1 "$folder/none.yaml" -o "$folder/r"
grep -q 'none.yaml' "$folder/err" || fail 'a missing campaign is not named'
echo 'speed: 3' >"$folder/bad.yaml"
run 1 "$folder/bad.yaml" -o "$folder/r"
grep -q 'bad.yaml:1: .*speed' "$folder/err" || fail 'an unknown key is not named with its line'
[ -e "$folder/r" ] && fail 'a bad campaign made a folder'

# Without recordings all is written, and the code says that it is incomplete.
run 3 "$folder/empty.yaml" -o "$folder/r"
for file in report.pdf report.html report.json; do
    [ -s "$folder/r/$file" ] || fail "no $file"
    grep -qF "$folder/r/$file" "$folder/out" || fail "$file is not named"
done
grep -q 'not used: type1, 85 mm, sample 1: ' "$folder/out" || fail 'a missing recording is not named'
grep -qF 'calibration missing' "$folder/out" || fail 'the missing calibration is not named'
[ "$(find "$folder/r" -name '.new*' | wc -l)" -eq 0 ] || fail 'something half-written is left'

# A folder that holds something is left alone without --force, before anything is computed.
cp "$folder/r/report.json" "$folder/before.json"
run 1 "$folder/empty.yaml" -o "$folder/r"
grep -q -- '--force' "$folder/err" || fail 'the message does not name --force'
run 3 "$folder/empty.yaml" -o "$folder/r" --force --json
cmp -s "$folder/before.json" "$folder/r/report.json" || fail 'the same campaign gave other bytes'
cmp -s "$folder/out" "$folder/r/report.json" || fail '--json does not print report.json'

# Measurements are not computed: a message says so, and the report is written.
run 3 "$folder/empty.yaml" -o "$folder/solved" --solve
grep -q 'recordings cannot be computed' "$folder/err" || fail 'what --solve leaves out is not named'
[ "$(grep -c 'cannot be computed' "$folder/err")" -eq 1 ] || fail 'the message comes more than once'
cmp -s "$folder/before.json" "$folder/solved/report.json" || fail '--solve changed a report of recordings'
[ -e "$folder/solved.jobs" ] && fail 'a campaign of recordings has runs'

# Where none is missing there is nothing to tell: this one is there, though it is no recording.
echo text >"$folder/there.wbr"
cat >"$folder/there.yaml" <<'YAML'
title: All there
calibration_length_mm: 85
wires: [{wire: type1, calibration: [there.wbr]}]
YAML
run 3 "$folder/there.yaml" -o "$folder/there" --solve
grep -q 'cannot be computed' "$folder/err" && fail 'existing recordings are called missing'

# A dry run has nothing to list of recordings, and writes no report.
run 0 "$folder/empty.yaml" -o "$folder/dry" --slurm-dry-run
grep -q 'there are no runs to list' "$folder/err" || fail 'no message that there are no runs'
[ -e "$folder/dry" ] && fail 'a dry run wrote a report'

# No place to write.
echo text >"$folder/file"
run 1 "$folder/empty.yaml" -o "$folder/file/r"
run 1 "$folder/empty.yaml" -o /proc/wirebench

finish 'report'
