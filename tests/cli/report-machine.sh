#!/bin/bash
# A campaign of testing machines: whole, with a file missing, without its folder, wrong keys.
# Usage: report-machine.sh WIREBENCH SOURCE_ROOT
. "$2/tests/cli/reports.sh"

# F = 48 E I d / L^3 with E I = 30 N mm2 and L = 10 mm, from a contact at 0.5 mm.
mkdir -p "$folder/data"
for test in 1 2 3; do
    awk -v t=$test 'BEGIN { print "Load (N)\tTravel (mm)"
        for (i = 0; i <= 200; i++) { d = i * 0.01 - 0.5
            f = 0.0001 * (i % 2); if (d > 0) f = 48 * (28 + t) * d / 1000
            printf "%.7g\t%.7g\n", f, i * 0.01 } }' \
        >"$folder/data/test-$test.txt"
done
cat >"$folder/m.yaml" <<'END'
name: m
kind: three-point
span_mm: 10
roller_radius_mm: 1
END
cat >"$folder/c.yaml" <<'END'
kind: machine
title: Three made-up tests
data_environment: WIREBENCH_TEST_DATA
groups:
  - name: a
    machine: m.yaml
    outer_diameter_mm: 0.5
    zero_force_mN: 1
    usable_travel_mm: 1
    tests: [test-1.txt, test-2.txt, test-3.txt]
END

number() { # KEY: the first in report.json
    sed -n "s/.*\"$1\": \([-0-9.e]*\).*/\1/p" "$folder/r/report.json" | head -1
}

export WIREBENCH_TEST_DATA=$folder/data
run 0 "$folder/c.yaml" -o "$folder/r"
[ "$(number tests_used)" = 3 ] || fail "not all tests are used"
# The first contact is taken where 1 mN is exceeded, up to a row late.
awk -v v="$(number early_rigidity_N_mm2)" 'BEGIN { exit !(v > 29.9 && v < 32) }' ||
    fail "E I is $(number early_rigidity_N_mm2)"
awk -v v="$(number early_rigidity_deviation_N_mm2)" 'BEGIN { exit !(v > 0.9 && v < 1.1) }' ||
    fail "s is $(number early_rigidity_deviation_N_mm2)"
[ -e "$folder/r/figures/group-1.svg" ] || fail "no figure"

# Calibrated, the law has cards, which name the machine's files by their checksums.
[ -e "$folder/r/cards" ] && fail "cards without a calibration"
sed 's/^groups:/calibrate: true\ngroups:/; s/travel_mm: 1/travel_mm: 1.9/; s/zero_force_mN/wire: mine\n    zero_force_mN/' "$folder/c.yaml" >"$folder/fit.yaml"
run 0 "$folder/fit.yaml" -o "$folder/fit"
"$wirebench" export "$folder/fit/cards/mine.yaml" --to calculix >"$folder/card" || fail "no card of mine.yaml"
cmp -s "$folder/card" "$folder/fit/cards/mine.calculix.inp" || fail "the card is not that of the properties beside it"
grep -q "$(sha256sum "$folder/data/test-3.txt" | cut -d ' ' -f 1)" "$folder/card" || fail "no checksum of test-3.txt"
grep -q 'Recording: test-3.txt' "$folder/card" || fail "test-3.txt is not named"
# Nobody said what the wire weighs.
[ -e "$folder/fit/cards/mine.mujoco.xml" ] && fail "a chain without a mass"
grep -q '<b>mine</b>, no card for mujoco: .*mass_per_length' "$folder/fit/report.html" ||
    fail "the pages do not tell the card that is missing"

rm "$folder/data/test-2.txt"
run 3 "$folder/c.yaml" -o "$folder/r" --force
[ "$(number tests_missing)" = 1 ] || fail "the missing file is not counted"

echo nonsense >"$folder/data/test-2.txt"
run 3 "$folder/c.yaml" -o "$folder/r" --force
grep -q '"state": "refused"' "$folder/r/report.json" || fail "a refused file is missing"
grep -q "$folder" "$folder/r/report.json" && fail "a path of this machine is in the report"

unset WIREBENCH_TEST_DATA
run 3 "$folder/c.yaml" -o "$folder/r" --force
grep -q "WIREBENCH_TEST_DATA is not set" "$folder/err" || fail "the variable is not named"

# A cable of six such wires of E I = 30 N mm2 round a core of 5 N mm2: sliding freely 185 N mm2, bonded
# 3 E A r^2 = 300 N mm2 more, with E = 1000 MPa, A = 0.1 mm2 and r = 1 mm.
curve() { # FILE EI SPAN: without noise, from a contact at 0.1 mm
    awk -v EI="$2" -v L="$3" 'BEGIN { print "Load (N)\tTravel (mm)"
        for (i = 0; i <= 600; i++) { d = i * 0.005 - 0.1
            printf "%.9g\t%.9g\n", (d > 0 ? 48 * EI * d / L ^ 3 : 0), i * 0.005 } }' >"$folder/data/$1"
}
curve wire.txt 30 10
curve core.txt 5 10
curve sliding.txt 185 20
curve bonded.txt 485 20
sed 's/span_mm: 10/span_mm: 20/' "$folder/m.yaml" >"$folder/m20.yaml"
printf 'name: metal\nsource: made up\nyoungs_modulus_MPa: 1000\npoissons_ratio: 0.3\ndensity_g_cm3: 1\n' >"$folder/metal.yaml"
group() { # NAME MACHINE
    printf '  - {name: %s, machine: %s, outer_diameter_mm: 0.5, zero_force_mN: 0.01, tests: [%s.txt]}\n' \
        "$1" "$2" "$1"
}
{
    printf 'kind: machine\ntitle: A made-up cable\ndata_environment: WIREBENCH_TEST_DATA\ngroups:\n'
    group wire m.yaml
    group core m.yaml
    group sliding m20.yaml
    group bonded m20.yaml
    cat <<'END'
cable:
  wires: [wire]
  core: core
  layers: [sliding, bonded]
  wire_count: 6
  wire_circle_radius_mm: 1
  conductor: metal.yaml
  conductor_area_mm2: 0.1
END
} >"$folder/cable.yaml"
export WIREBENCH_TEST_DATA=$folder/data
run 0 "$folder/cable.yaml" -o "$folder/cable"
grep 'chi = ' "$folder/out" >"$folder/chi"
grep -q 'group sliding .* M / M_free = \(0.99\|1.00\), chi = -*0.00 ' "$folder/chi" || fail "$(cat "$folder/chi")"
grep -q 'group bonded .* M / M_free = 2.6[0-9], chi = 1.0[01] ' "$folder/chi" || fail "$(cat "$folder/chi")"
[ -e "$folder/cable/figures/layer-2.svg" ] || fail "no figure of a layer"
sed 's/core: core/core: kernel/' "$folder/cable.yaml" >"$folder/odd.yaml"
run 1 "$folder/odd.yaml" -o "$folder/odd"
grep -q "'kernel': expected the name of a group" "$folder/err" || fail "$(cat "$folder/err")"
unset WIREBENCH_TEST_DATA

sed 's/outer_diameter_mm/diameter/' "$folder/c.yaml" >"$folder/odd.yaml"
run 1 "$folder/odd.yaml" -o "$folder/odd"
grep -q "odd.yaml:7: diameter: unknown key" "$folder/err" || fail "$(cat "$folder/err")"
[ -e "$folder/odd" ] && fail "a refused campaign left a folder"
finish "campaigns of testing machines"
