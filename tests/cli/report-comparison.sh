#!/bin/bash
# `wirebench report` of a comparison as a user meets it: what is missing and how to make it, what has
# changed, limits. Solids take long to solve, so rods stand in for them: the same files, but for the
# solver's name.
# Usage: report-comparison.sh WIREBENCH
. "$(dirname "$0")/reports.sh"

cat >"$folder/c.yaml" <<'YAML'
kind: comparison
title: Solid and rod
simulations: sim
elastic: {model: follower-8awg-elastic}
elastoplastic: {model: follower-8awg}
fit: {elements: 10, fibres: 12}
YAML

sed 's/^kind: .*/kind: novel/' "$folder/c.yaml" >"$folder/novel.yaml"
run 1 "$folder/novel.yaml" -o "$folder/r"
grep -q 'novel.yaml:1: kind' "$folder/err" || fail 'an unknown kind is not named with its line'
[ -e "$folder/r" ] && fail 'a bad campaign made a folder'

# Without datasets the report is written, and says how to make them.
run 3 "$folder/c.yaml" -o "$folder/r"
for file in report.pdf report.html report.json; do
    [ -s "$folder/r/$file" ] || fail "no $file"
done
grep -qF 'wirebench solve wire3d fixtures/models/follower-8awg.yaml -o sim/follower-8awg-3d' \
    "$folder/out" || fail 'how to make a dataset is missing'
cp "$folder/out" "$folder/before"
run 1 "$folder/c.yaml" -o "$folder/r"
grep -q -- '--force' "$folder/err" || fail 'the message does not name --force'

for model in follower-8awg-elastic follower-8awg; do
    "$wirebench" solve wire1d $model -o "$folder/sim/$model-1d" >/dev/null 2>&1 ||
        fail "cannot solve $model"
    cp -r "$folder/sim/$model-1d" "$folder/sim/$model-3d"
    file=$WIREBENCH_SOURCE_ROOT/fixtures/models/$model.yaml
    along=$(sed -n 's/^  elements_along: //p' "$file") density=$(sed -n 's/^  section_density: //p' "$file")
    mesh="{\"elements_along\": ${along:-60}, \"section_density\": ${density:-1}, \"integration\": \"selective\"}"
    sed -i 's/": "wire1d"/": "wire3d"/; s/^ *"fields_at_mm"/"mesh": '"$mesh"', &/' \
        "$folder/sim/$model-3d/dataset.json"
done
run 0 "$folder/c.yaml" -o "$folder/r" --force
grep -q '4 of 4 datasets used' "$folder/out" || fail 'not all datasets are used'
grep -q 'fitted rod: yield stress' "$folder/out" || fail 'the fitted rod is missing'
run 0 "$folder/c.yaml" -o "$folder/again" --json
cmp -s "$folder/r/report.json" "$folder/again/report.json" || fail 'another run gave other bytes'
cmp -s "$folder/out" "$folder/again/report.json" || fail '--json does not print report.json'
diff -r "$folder/r" "$folder/again" >/dev/null || fail 'another run gave other files'
grep -qiE "experiment|$folder" "$folder/r/report.html" "$folder/r/report.json" &&
    fail 'a word or path that must not be there'

# A rod that costs as much as a solid.
(cat "$folder/c.yaml" && echo 'limits: {cost_max: 0.02}') >"$folder/strict.yaml"
run 4 "$folder/strict.yaml" -o "$folder/strict"
grep -q 'limit of the campaign is exceeded' "$folder/out" || fail 'the exceeded limit is missing'

# A dataset of other inputs, and one of an older solver, are left out.
sed -i 's/"poissons_ratio": 0.34/"poissons_ratio": 0.3/' "$folder/sim/follower-8awg-3d/dataset.json"
run 3 "$folder/c.yaml" -o "$folder/r" --force
other='parts[0].poissons_ratio is 0.3 in it, and 0.34 is wanted'
grep -qF "$other" "$folder/out" || fail 'the other input is missing'
grep -qF "$other" "$folder/r/report.html" || fail 'the report hides the other input'
grep -q 'no fitted rod' "$folder/out" || fail 'the missing fit is not named'

# --solve makes what is missing: solids and rods of a coarse wire under a small force.
for model in follower-8awg-elastic follower-8awg; do
    sed -E 's/elements_along: .*/elements_along: 10/; s/section_density: .*/section_density: 1/
        s/rows: .*/rows: 12/; s/24, 0\]/16, 0]/' \
        "$WIREBENCH_SOURCE_ROOT/fixtures/models/$model.yaml" >"$folder/$model.yaml"
done
cat >"$folder/own.yaml" <<'YAML'
kind: comparison
title: Solid and rod, made here
simulations: own
elastic: {model: ./follower-8awg-elastic.yaml}
elastoplastic: {model: ./follower-8awg.yaml}
fit: {elements: 10, fibres: 12}
YAML
run 3 "$folder/own.yaml" -o "$folder/without"
grep -q '<tt>wirebench report --solve</tt> makes them' "$folder/without/report.html" ||
    fail 'the report does not say that --solve makes its datasets'

# An array that is only written, and no report.
run 0 "$folder/own.yaml" -o "$folder/dry" --slurm-dry-run --cores-per-run 2
[ -e "$folder/dry" ] && fail 'a dry run wrote a report'
grep -rq 'solve wire3d' "$folder/dry.jobs" || fail 'no list of runs was written'
grep -rq -e '--checkpoint\|--threads' "$folder/dry.jobs" && fail 'a wire has options of bundles'

run 0 "$folder/own.yaml" -o "$folder/made" --solve --workers 2
grep -q '4 of 4 datasets used' "$folder/out" || fail '--solve did not make all datasets'
grep -q '^wirebench solve wire3d' "$folder/made.jobs/follower-8awg-3d.log" || fail 'there is no log'
before=$(sha256sum "$folder"/own/*/dataset.json)
run 0 "$folder/own.yaml" -o "$folder/remade" --solve
[ "$before" = "$(sha256sum "$folder"/own/*/dataset.json)" ] ||
    fail 'datasets that are there were made again'
diff -r "$folder/made" "$folder/remade" >/dev/null || fail 'the same datasets gave other bytes'

# A changed model: its datasets are outdated, and replaced; the others stay. A comment changes nothing.
echo '# changed' >>"$folder/follower-8awg-elastic.yaml"
run 0 "$folder/own.yaml" -o "$folder/made" --force
sed -i 's/rows: 12/rows: 13/' "$folder/follower-8awg-elastic.yaml"
run 3 "$folder/own.yaml" -o "$folder/made" --force
grep -q '2 of 4 datasets used' "$folder/out" || fail 'datasets of a changed model are used'
run 0 "$folder/own.yaml" -o "$folder/made" --force --solve
grep -q '4 of 4 datasets used' "$folder/out" || fail '--solve did not replace outdated datasets'
[ "$(echo "$before" | grep '8awg-3d')" = "$(sha256sum "$folder"/own/follower-8awg-3d/dataset.json)" ] ||
    fail 'a dataset that fits was made again'

finish 'report of a comparison'
