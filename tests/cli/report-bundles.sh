#!/bin/bash
# `wirebench report` of bundles as a user meets it: what is missing and how to make it, --solve makes
# it, runs again only what has changed, and the report comes out. One wire stands in for a bundle: it
# is solved in a second, and its published beam is the wire's own.
# Usage: report-bundles.sh WIREBENCH
. "$(dirname "$0")/reports.sh"

cat >"$folder/one.yaml" <<'YAML'
name: one
title: One wire
wires: [{wire: type3, count: 1}]
packing: hexagon
length_mm: 85
interface: {cohesive_stiffness_N_mm3: 30, friction: 0.4}
meshes: [{name: coarse, core_quads: 2, rings: 1, elements_along: 20, formulation: 2x2x1}]
run: {mesh: coarse, deflection_mm: 20, rows: 40, mass_scaling: 25, selective_mass_scaling: 10}
loads: {strand_mm: 760, weight: true}
published: {outer_diameter_mm: 1.4, density_g_cm3: 4.97, beam: type3}
YAML
cat >"$folder/c.yaml" <<'YAML'
kind: bundles
title: One wire
simulations: sim
defaults: {dead_force: true, weight: false, duration_s: 1.5}
runs:
  - {name: one, bundle: ./one.yaml}
  - {name: one-0.2, bundle: ./one.yaml, friction: 0.2}
groups:
  - label: A wire
    bundles: [{label: one wire, dynamic: one, constant: one-0.2, rod: one-1d}]
fit: {elements: 10, fibres: 12}
YAML
cd "$folder" || exit 1

# Without datasets the report is written, and says how to make them.
run 3 c.yaml -o r
for file in report.pdf report.html report.json figures/sections-1.svg; do
    [ -s "r/$file" ] || fail "no $file"
done
grep -qF 'wirebench solve bundle one.yaml --dead-force --no-weight --friction 0.2 --duration-s 1.5 -o sim/one-0.2' out ||
    fail 'how to make a dataset is missing'
grep -q '0 of 3 datasets used' out || fail 'datasets come from nowhere'

# The printed command makes it, in the campaign's folder.
# shellcheck disable=SC2016 # $wirebench is expanded by eval
eval "$(sed -n 's/^ *wirebench \(solve cantilever .*\)/"$wirebench" \1/p' out)" 2>/dev/null
run 3 c.yaml -o r --force
grep -q '1 of 3 datasets used' out || fail 'the printed command did not make the dataset'

# An array that is only written, and no report.
run 0 c.yaml -o dry --slurm-dry-run --cores-per-run 2
[ -e dry ] && fail 'a dry run wrote a report'
grep -rq -e '--dead-force' dry.jobs || fail 'no list of runs was written'
grep -rq -e '--checkpoint' dry.jobs || fail 'runs of the array cannot go on where they ended'
grep -rq -e '--threads' dry.jobs || fail 'runs of the array do not use their cores'

# The missing ones are made here.
run 0 c.yaml -o r --force --solve --workers 2
grep -q '3 of 3 datasets used' out || fail 'not all datasets were made'
[ -d r.jobs ] || fail 'there are no logs'
rms=$(sed -n 's/^one wire .* published curve \([0-9.]*\) .*/\1/p' out)
awk -v rms="$rms" 'BEGIN { exit !(rms > 0 && rms < 0.02) }' ||
    fail "one wire is $rms from its own beam"

# Then an array has no runs: a message says so, and no report is written.
run 0 c.yaml -o dry --slurm-dry-run
grep -q 'there are no runs to list' err || fail 'no message that there are no runs'
[ -e dry ] && fail 'a dry run without runs wrote a report'

before=$(sha256sum sim/*/dataset.json)
mkdir -p again.jobs
touch again.jobs/one-0123456789ab.checkpoint again.jobs/one-0123456789ab.checkpoint.Ab1234 \
    again.jobs/one-more-0123456789ab.checkpoint again.jobs/one-0123456789ab.log
run 0 c.yaml -o again --solve
[ "$(ls again.jobs)" = "$(printf 'one-0123456789ab.log\none-more-0123456789ab.checkpoint')" ] ||
    fail "checkpoints of runs that are there: $(ls again.jobs)"
[ "$before" = "$(sha256sum sim/*/dataset.json)" ] || fail 'datasets that are there were made again'
diff -r r again >/dev/null || fail 'another run gave other bytes'
run 0 c.yaml -o json --json
cmp -s out again/report.json || fail '--json does not print report.json'
grep -qiE "experiment|$folder" r/report.html r/report.json && fail 'a word or path that must not be there'

# What is outdated is listed with why and how to make it, and nothing is written.
run 0 c.yaml --stale
grep -q '^0 of 3 datasets' out || fail "datasets that fit are listed: $(cat out)"
cp sim/one-1d/dataset.json kept.json
sed -i 's/"version": 1,/"version": 0,/' sim/one-1d/dataset.json
run 3 c.yaml --stale
grep -q '^1 of 3 datasets' out || fail 'an older solver is not listed'
grep -q 'sim/one-1d: version is 0 in it, and 1 is wanted' out || fail 'the older solver is not named'
[ -s err ] && fail "what is listed is warned of, too: $(cat err)"
run 3 c.yaml --stale --json
grep -q '"problem": "version is 0 in it, and 1 is wanted"' out || fail 'the list is no JSON'
cp kept.json sim/one-1d/dataset.json
run 2 c.yaml --stale --solve
run 2 c.yaml
grep -q -e '--stale' err || fail 'without a folder --stale is not named'

# A comment changes nothing. Another friction: the dataset is outdated, left out, and replaced.
echo '# a comment' >>one.yaml
run 0 c.yaml -o r --force
sed -i 's/friction: 0.2/friction: 0.3/' c.yaml
run 3 c.yaml -o r --force
grep -q 'interface.friction.static is 0.2 in it, and 0.3 is wanted' out || fail 'outdated datasets are not named'
first=$(sha256sum sim/one/dataset.json)
run 0 c.yaml -o r --force --solve
grep -q '"static": 0.3' sim/one-0.2/dataset.json || fail 'the outdated dataset was not replaced'
[ "$first" = "$(sha256sum sim/one/dataset.json)" ] || fail 'a dataset that fits was made again'

# A run that cannot be made is named, and the others are reported.
cat >>c.yaml <<'YAML'
limits: {kinetic_max: 1e-6}
YAML
sed -i 's/^  - {name: one-0.2.*/&\n  - {name: lost, bundle: .\/one.yaml, mass_scaling: 1e6, duration_s: 1e-3}/' c.yaml
run 3 c.yaml -o r --force --solve
grep -q 'lost' err || fail 'the failed run is not named'
grep -q 'sim/lost: there is no such dataset' out || fail 'the missing dataset is not named'
grep -q 'limit kinetic_max exceeded by one' out || fail 'the exceeded limit is not named'
sed -i '/name: lost/d' c.yaml
run 4 c.yaml -o r --force

finish 'report of bundles'
