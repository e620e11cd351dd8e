#!/bin/bash
# The shipped report of a harness: its files, exit codes and numbers, a signed one that is checked, and files
# that are rejected. Usage: report-harness.sh WIREBENCH SOURCE_ROOT
. "$2/tests/cli/reports.sh"
root=$2
export WIREBENCH_DATA=$root
cd "$folder" || exit 1

# Limits are exceeded.
run 4 fixtures/campaigns/harness.yaml -o r
for part in '2 of 4 limits exceeded' 'small (simulation, elastoplastic): largest force' 'small (simulation, elastic)'; do
    grep -qF "$part" out || fail "'$part' is not said: $(cat out)"
done
for file in report.pdf report.html report.json figures/{harness,forces,residual,residual-perspective,branch-3}.svg \
    figures/step-{1,7}{,-perspective,-forces}.{svg,png}; do
    [ -s "r/$file" ] || fail "no $file"
done
grep -q 'simulations, no tests' r/report.html || fail 'the page does not say that all is computed'
grep -q "$folder\|$root" r/report.html r/report.json && fail 'a path of this machine'
command -v pdftotext >/dev/null && {
    pdftotext -layout r/report.pdf text
    grep -q '2 of 4 limits exceeded; the largest force on the way is' text || fail "the sentence: $(head -30 text)"
    grep -q 'Step 7: take_off' text || fail 'a step is missing'
}

# The numbers are those of `solve harness`, but for round-off; both computations.
"$wirebench" solve harness small --json >plastic.json 2>/dev/null || fail 'solve harness'
"$wirebench" solve harness small --law elastic --json >elastic.json 2>/dev/null || fail 'solve harness --law elastic'
python3 - <<'PYTHON' || fail 'other numbers than those of solve harness'
import json, math
report = json.load(open("r/report.json"))
for name, solved in (("harness", "plastic.json"), ("elastic", "elastic.json")):
    a, b = report[name], json.load(open(solved))
    assert a["law"] == b["law"] and a["wires"] == b["wires"] and len(a["steps"]) == len(b["steps"]) == 7
    for s, t in zip(a["steps"], b["steps"]):
        assert math.isclose(s["plastic_mJ"], t["plastic_mJ"], rel_tol=1e-12, abs_tol=1e-6), (s["name"], s, t)
        for f, g in zip(s["forces"], t["forces"]):
            assert f["name"] == g["name"]
            for key in "force_N", "largest_force_N", "moment_N_mm", "largest_moment_N_mm":
                assert math.isclose(f[key], g[key], rel_tol=1e-12, abs_tol=1e-6), (s["name"], key)
found = report["found"]
forces = [f for s in report["harness"]["steps"] for f in s["forces"]]
assert found["largest_force_N"] == max(f["largest_force_N"] for f in forces)
assert found["limits"] == 4 and found["limits_exceeded"] == len(
    {f["name"] for f in forces if f["exceeds_force"] or f["exceeds_moment"]})
assert report["elastic"]["residual_shape"]["distance_mm"] == 0
PYTHON

# The same bytes from any folder; an existing report is kept.
mkdir elsewhere && (cd elsewhere && "$wirebench" report fixtures/campaigns/harness.yaml -o ../again >/dev/null)
diff -r r again >/dev/null || fail 'other bytes from another folder'
run 1 fixtures/campaigns/harness.yaml -o r
grep -q -- --force err || fail "an existing report: $(cat err)"

# A harness of one's own, which keeps its limits, beside its report.
sed 's/, most_force_N: [0-9]*//; s/holds: axis/holds: slide/; /mount: C1/s/, direction.*/}/' \
    "$root/fixtures/harnesses/small.yaml" >own.yaml
printf 'kind: harness\ntitle: Own\nharness: own.yaml\n' >own-report.yaml
run 0 own-report.yaml -o own
grep -qF 'The only limit is kept' own/report.html || fail 'the limit of the radius'
grep -q 'Since its mount [0-9.]* mm of wire slid through C1 towards the end of B1' own/report.html || fail 'the slid wire'

# The report of a harness has no datasets; a harness file is no campaign, and a campaign no harness file.
run 1 own-report.yaml --stale
run 1 own.yaml -o x
grep -q 'is a harness file, expected a campaign file; for this file: wirebench quicklook' err || fail "$(cat err)"
"$wirebench" solve harness own-report.yaml 2>err && fail 'a campaign was solved'
grep -q 'is a campaign file, expected a harness file; for this file: wirebench report' err || fail "$(cat err)"
"$wirebench" quicklook own-report.yaml -o x 2>err && fail 'a campaign was looked at'
grep -q 'is a campaign file, expected a recording or a harness file' err || fail "$(cat err)"

rejects() { # WORDS LINE...: of a campaign with these lines
    local words=$1
    shift
    printf '%s\n' "$@" >wrong.yaml
    run 1 wrong.yaml -o x
    grep -qF -- "$words" err || fail "'$words' is not said: $(cat err)"
    [ "$(wc -l <err)" -eq 1 ] || fail "more than one message: $(cat err)"
}
rejects 'wrong.yaml:3: harnes: unknown key; known here: kind, laboratory, title, notes, harness' \
    'kind: harness' 'title: T' 'harnes: small'
rejects "wrong.yaml:3: harness: no 'none' among the shipped harnesses" 'kind: harness' 'title: T' 'harness: none'
rejects 'wrong.yaml:1: title: this key is missing' 'kind: harness' 'harness: small'
rejects "wrong.yaml:3: harness: no file 'gone.yaml'" 'kind: harness' 'title: T' 'harness: gone.yaml'
sed 's/most_force_N: 10/most_force_N: ten/' "$root/fixtures/harnesses/small.yaml" >damaged.yaml
rejects 'damaged.yaml:17: most_force_N: expected a plain number' 'kind: harness' 'title: T' 'harness: damaged.yaml'
head -c 700 "$root/fixtures/harnesses/small.yaml" >damaged.yaml
rejects 'damaged.yaml:' 'kind: harness' 'title: T' 'harness: damaged.yaml'
[ ! -e x ] || fail 'a rejected file leaves a folder'
finish 'the report of a harness'
