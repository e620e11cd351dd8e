#!/bin/bash
# `wirebench calibrate` and `validate` on simulated datasets, as a user meets them: results, files,
# and everything that goes wrong, each with one message and its exit code.
# Usage: calibrate.sh WIREBENCH
set -u

wirebench=$(realpath "$1")
folder=$(mktemp -d /tmp/wb-calibrate-XXXXXX)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# expect CODE TEXT COMMAND...: exit code, and TEXT somewhere in what it says.
expect() {
    local code=$1 text=$2 said got
    shift 2
    said=$("$@" 2>&1)
    got=$?
    [ "$got" -eq "$code" ] || fail "$* ended with $got, not $code: $said"
    case $said in
    *"$text"*) ;;
    *) fail "$* did not say '$text': $said" ;;
    esac
    [ "$code" -eq 0 ] || [ "$code" -eq 2 ] || [ "$code" -eq 3 ] || [ "$(wc -l <<<"$said")" -eq 1 ] ||
        fail "$* said more than one line: $said"
}

# within VALUE LOW HIGH
within() {
    awk -v v="$1" -v l="$2" -v h="$3" 'BEGIN { exit !(v != "" && v >= l && v <= h) }' ||
        fail "$1 is not within $2 and $3"
}

# number FILE KEY: the first number of a key in JSON or YAML.
number() {
    sed -n "s/^ *\"\\{0,1\\}$2\"\\{0,1\\}: *\\([-0-9.e+]*\\),\\{0,1\\}\$/\\1/p" "$1" | head -n 1
}

solve() {
    "$wirebench" solve cantilever --no-figure --wire type3 --deflection-mm 53 --strand-mm 760 --weight \
        --points 106 "$@" || fail "solve $*"
}
quick="--method paper --yield-point 0.04 --elements 12 --step-mm 1 --no-restart"

solve --length-mm 85 -o L85
solve --length-mm 100 -o L100
solve --length-mm 85 --law elastic -o elastic
solve --length-mm 85 --cycles 1 -o cycle

# shellcheck disable=SC2086
{
    expect 0 'elastic zone 0.05 L, yield point 0.04 L' \
        "$wirebench" calibrate L85 $quick -o type3.yaml
    within "$(number type3.yaml youngs_modulus_MPa)" 4480 4575
    within "$(number type3.yaml yield_stress_MPa)" 4.45 4.6
    within "$(number type3.yaml hardening_exponent)" 0.85 0.95
    within "$(number type3.yaml rms)" 0 1e-3
    grep -q 'force_deflection_sha256: [0-9a-f]\{64\}$' type3.yaml || fail 'no sha256 in the properties'

    expect 1 'type3.yaml' "$wirebench" calibrate L85 $quick -o type3.yaml
    expect 0 'wire type3' "$wirebench" calibrate L85 $quick -o type3.yaml --force
    expect 0 'trust   for loading only: fits it within' "$wirebench" calibrate L85 $quick -o 'a type3.yaml'
    expect 0 "next    wirebench validate 'a type3.yaml' DATASET..., with tests of another length" \
        "$wirebench" calibrate L85 $quick -o 'a type3.yaml' --force

    "$wirebench" calibrate L85 $quick --youngs-modulus-mpa 4528 --yield-stress-mpa 4.52 --json \
        >exact.json || fail 'calibrate --json'
    within "$(number exact.json strength_coefficient_MPa)" 1290 1370
    within "$(number exact.json samples)" 1 1

    expect 3 'the iterations ran out' "$wirebench" calibrate L85 $quick --max-iterations 2
    expect 1 'yield is not reached' "$wirebench" calibrate elastic $quick
    expect 1 'different kinds' "$wirebench" calibrate L85 L100 $quick
    expect 1 'nowhere' "$wirebench" calibrate nowhere $quick
}
expect 2 'at least one dataset' "$wirebench" calibrate
expect 2 '--elastic-zone' "$wirebench" calibrate L85 --elastic-zone 5mm
expect 2 'properties and at least one dataset' "$wirebench" validate type3.yaml

expect 0 'unloading' "$wirebench" validate type3.yaml L85 L100 -o curves
for length in 85 100; do
    [ "$(wc -l <"curves/type3-L$length.csv")" -eq 109 ] || fail "curves/type3-L$length.csv"
done
expect 1 '--force' "$wirebench" validate type3.yaml L100 -o curves
"$wirebench" validate type3.yaml L100 --json >validate.json || fail 'validate --json'
within "$(number validate.json length_mm)" 100 100
within "$(number validate.json rms)" 0 2e-3
within "$(number validate.json shape_rms_mm)" 0 0.05

"$wirebench" solve cantilever --wire type1 --length-mm 85 --deflection-mm 53 -o type1
expect 1 "wire 'type1'" "$wirebench" validate type3.yaml type1
sed 's/^youngs_modulus_MPa: .*/youngs_modulus_MPa: 4528 MPa/' type3.yaml >unit.yaml
expect 1 'youngs_modulus_MPa' "$wirebench" validate unit.yaml L100
sed 's/^wire: /colour: red\nwire: /' type3.yaml >unknown.yaml
expect 1 'unknown.yaml:2: colour' "$wirebench" validate unknown.yaml L100
expect 1 'missing.yaml' "$wirebench" validate missing.yaml L100

# What is given where a dataset or the properties are expected, and a command misspelt.
mkdir several && cp -r L85 several/b && cp -r L100 several/a && touch test.wbr
expect 1 "wirebench align test.wbr" "$wirebench" calibrate test.wbr
expect 1 "several datasets: several/a, several/b;" "$wirebench" calibrate several
expect 1 'expected a properties file' "$wirebench" validate L100 type3.yaml
expect 2 "unknown command 'calibrat': did you mean \`wirebench calibrate\`?" "$wirebench" calibrat
expect 2 "unknown command 'xyz'" "$wirebench" xyz
"$wirebench" xyz 2>&1 | grep -q 'did you mean' && fail 'xyz means nothing'
# One sample has no scatter, and numbers come without exponents.
# shellcheck disable=SC2086
"$wirebench" calibrate L85 $quick >said || fail 'calibrate'
grep -q '^one specimen: no uncertainty$' said || fail "one specimen: $(cat said)"
grep -qE '^(E|sigma_Y|K|n) .*e[-+]' said && fail "exponents: $(cat said)"
"$wirebench" calibrate --help | grep -q 'Mandatory or optional' && fail 'argp speaks of long options'

# Whole cycles: the wire is Ludwik's with isotropic hardening, and that is what is found.
expect 0 'law: Ludwik, isotropic; fits loading and unloading' \
    "$wirebench" calibrate cycle --threads 2 -o cycle.yaml
within "$(number cycle.yaml youngs_modulus_MPa)" 4515 4540
within "$(number cycle.yaml yield_stress_MPa)" 4.47 4.57
within "$(number cycle.yaml strength_coefficient_MPa)" 1300 1350
within "$(number cycle.yaml hardening_exponent)" 0.89 0.91
within "$(number cycle.yaml rms)" 0 5e-4
within "$(number cycle.yaml largest_curvature_1_m)" 30 32
grep -q '^method: cycle$' cycle.yaml || fail 'the properties do not say their method'
grep -q '^law:' cycle.yaml && fail 'a law beside the four numbers that say it'
expect 0 'unloading' "$wirebench" validate cycle.yaml L85
"$wirebench" calibrate cycle >said || fail 'calibrate cycle'
for line in '^EI at zero curvature  *85[0-9]\.[0-9] N mm2' '^unloading stiffness over 1 /m  *8[45][0-9]\.[0-9] N mm2' \
    '^secant EI to 2 /m ' '^the data of all specimens begin at' '^M at .* /m .* N mm' '^residual curvature ratio' '^loop energy' \
    '^one specimen: the scatter between specimens is unknown' '^Ludwik, kinematic .* not in the ranges' \
    '^  K  *13[0-9][0-9] MPa' '^  scatter between specimens  *unknown' \
    '^  gain of the load cell, not stated: per 1 %  *(1\.0' '^  free length, not stated: per 1 %  *([123]\.' \
    '^  combined ' '^  factor for 95 % ' '^settings: force_noise_mN 0.03, '; do
    grep -q "$line" said || fail "no line '$line': $(cat said)"
done
grep -qE '^(EI|M|unloading|secant|residual|loop) .*[0-9]e[-+]' said && fail "exponents: $(cat said)"
[ "$(grep -n '^M at' said | head -n 1 | cut -d: -f1)" -eq 2 ] || fail 'moments do not come first'
"$wirebench" calibrate cycle --json >cycle.json || fail 'calibrate --json of cycles'
for key in unloading_stiffness_N_mm2 secant_stiffness_N_mm2 flexural_rigidity_N_mm2 residual_curvature_ratio moment_curvature hardening_rule specimens \
    budget settings; do
    grep -q "^  \"$key\": [{[]" cycle.json || fail "no $key in the JSON object"
done
within "$(number cycle.json data_step_mm)" 1 1
within "$(number cycle.json length_mm)" 85 85

# The last lines: what was found, whether to trust it, the figure, the next command.
"$wirebench" calibrate cycle -o found.yaml >said || fail 'calibrate cycle -o'
for line in '^found .*type3 (simulation, 1 specimen): M at .* N mm.*; unloading stiffness over 1 /m .* N mm2.*; residual curvature ratio 0' \
    '^trust .*for this specimen: Ludwik, isotropic, fits .* one specimen cannot show' '^figure *found\.svg$' '^next .*two more specimens'; do
    tail -4 said | grep -q "$line" || fail "no line '$line' at the end: $(tail -5 said)"
done
[ "$(grep -c '<path' found.svg)" -gt 10 ] || fail 'the figure is empty'
rm found.yaml
expect 1 'found.svg' "$wirebench" calibrate cycle -o found.yaml
[ -e found.yaml ] && fail 'properties were written beside a figure that is in the way'
expect 0 'found ' "$wirebench" calibrate cycle -o found.yaml --no-figure
expect 0 'found.svg' "$wirebench" calibrate cycle -o found.yaml --force
script -qec "stty cols 60; '$wirebench' calibrate cycle" /dev/null | tr -d '\r' >said
tail -12 said | sed -n '/^found/,$p' | awk 'length > 60 { exit 1 }' || fail "a line is longer than the terminal: $(tail -12 said)"
[ "$(sed -n '/^found/,$p' said | grep -c '^        [^ ]')" -ge 3 ] || fail "no wrapped lines: $(tail -12 said)"

# The tests of the calibration itself do not test it.
expect 0 'the calibration used these tests' "$wirebench" validate found.yaml cycle -o predicted
[ -s predicted/type3-L85.svg ] || fail 'no figure of the prediction'
tail -4 <("$wirebench" validate found.yaml L100 -o predicted2) >said
for line in '^found .*type3 at L = 100 mm (simulation, 1 specimen): RMS error of the loading' '^trust ' '^figure *predicted2/type3-L100.svg' '^next '; do
    grep -q "$line" said || fail "no line '$line': $(cat said)"
done
"$wirebench" validate found.yaml L100 >said
grep -q '^trust .*undecided: the scatter between specimens is unknown' said || fail "trust: $(tail -4 said)"
grep -q '^next .*at least three specimens' said || fail "next: $(tail -4 said)"
"$wirebench" validate found.yaml cycle L100 >said
grep -q '^trust .*1 of these 2 tests were used by the calibration' said || fail "trust: $(tail -4 said)"
"$wirebench" calibrate L85 >said
grep -q '^trust .*for loading only' said || fail "trust: $(tail -4 said)"
grep -q '^next .*record tests with unloading' said || fail "next: $(tail -4 said)"
"$wirebench" calibrate cycle --at-most 1 >said 2>err
grep -q '^trust .*no: the uncertainty of .* exceeds 1 %' said || fail "trust: $(tail -4 said)"
"$wirebench" calibrate cycle -o /dev/null --force >said || fail 'calibrate -o /dev/null'
grep -q '^figure' said && fail 'a figure beside a device'
"$wirebench" validate found.yaml L100 -o predicted3 --no-figure >said || fail 'validate --no-figure'
[ -e predicted3/type3-L100.svg ] && fail 'a figure despite --no-figure'

# Loading alone: Ludwik's law, no residual curvature ratio.
expect 0 'hardening rule is untested' "$wirebench" calibrate L85
"$wirebench" calibrate L85 -o loading.yaml >said || fail 'calibrate L85'
grep -q '^residual curvature ratio' said && fail 'a residual curvature ratio without unloading'
grep -q 'tested: false' loading.yaml || fail 'a rule that was not tested'
grep -q 'residual_curvature_ratio' loading.yaml && fail 'a residual curvature ratio without unloading in the properties'
expect 0 '2 specimens' "$wirebench" calibrate L85 L100
expect 1 'hold the same readings' "$wirebench" calibrate cycle cycle

# A travel that is too short for K and n.
"$wirebench" solve cantilever --wire type3 --deflection-mm 15 --strand-mm 760 --weight --points 60 \
    --length-mm 85 -o short || fail 'solve short'
expect 0 'not identifiable with these data; deflect to 30 mm or more' "$wirebench" calibrate short

# What a rig or specimen file states comes into the interval; a number that is not known well enough is an error.
sed '/"test"/,$s/"length_mm": 85,/"length_mm": 85, "u_length_mm": 0.85, "u_gain_percent": 0.5,/' cycle/dataset.json >table &&
    cp -r cycle stated && cp table stated/dataset.json
"$wirebench" calibrate stated >said || fail 'calibrate stated'
grep -qE '^  free length, 1 %  *[123]\.' said || fail "no length in the budget: $(cat said)"
grep -qE '^  gain of the load cell, 0.5 %  *0\.5' said || fail "no gain in the budget: $(cat said)"
expect 3 'the scatter between specimens is unknown' "$wirebench" calibrate stated --at-most 20
expect 0 'law: Ludwik' "$wirebench" calibrate stated --at-most 20 --pooled-deviation 0.01 --pooled-degrees 12
expect 3 'expected at most 2 % (--at-most)' \
    "$wirebench" calibrate stated --at-most 2 --pooled-deviation 0.01 --pooled-degrees 12
sed 's/"u_length_mm": 0.85/"u_length_mm": -1/' table >stated/dataset.json
expect 1 'test.u_length_mm: expected a positive number' "$wirebench" calibrate stated

# A wire that no law follows: the range alone, exit code 3, and the properties are written.
awk -F, -v OFS=, '$3 == "unload" { $5 = $5 * (1 + 0.2 * sin($4 / 2)) } { print }' \
    cycle/force_deflection.csv >table && cp -r cycle odd && cp table odd/force_deflection.csv
expect 3 'no law fits loading and unloading' "$wirebench" calibrate odd -o odd.yaml
grep -q 'supported: false' odd.yaml || fail 'odd.yaml does not say that no law follows'
grep -qE '^flexural_rigidity_N_mm2: \{candidates_low' odd.yaml || fail 'more than a range is given'
expect 3 '--fit-iterations' "$wirebench" calibrate cycle --fit-iterations 1

# Settings belong to one method.
expect 2 '--elastic-zone applies only to --method paper' "$wirebench" calibrate cycle --elastic-zone 0.05
expect 2 '--bow-corrected applies only to --method paper' "$wirebench" calibrate cycle --bow-corrected
expect 2 '--force-share applies only to --method cycle' \
    "$wirebench" calibrate cycle --method paper --force-share 0.01
expect 2 'must be given together' "$wirebench" calibrate cycle --pooled-deviation 0.03
expect 0 'pooled over several wires, 0.03 with 12 degrees' \
    "$wirebench" calibrate cycle --pooled-deviation 0.03 --pooled-degrees 12
expect 2 'expected cycle or paper' "$wirebench" calibrate cycle --method print

# Tests with a follower force keep the paper's method.
cat >rod.yaml <<END
name: rod
title: a follower force
wire: type3
length_mm: 85
law: elastoplastic
clamp: plane
gravity: [0, 0, 0]
mesh: {elements_along: 30, section_density: 1}
history:
  - {name: pushed, follower_N: [0, 0.3, 0], rows: 40}
END
"$wirebench" solve wire1d ./rod.yaml -o follower >/dev/null || fail 'solve wire1d'
expect 0 "tests with a follower force: --method paper is used" \
    "$wirebench" calibrate follower --elements 20 --no-restart

# A wire of parallel parts is solved by the four numbers beside them, and that is said.
cat >parts.yaml <<END
name: parts
conductor_diameter_mm: 1
outer_diameter_mm: 1.4
density_g_cm3: 4.97
properties:
  youngs_modulus_MPa: 4000
  poissons_ratio: 0.39
  yield_stress_MPa: 4.5
  strength_coefficient_MPa: 1300
  hardening_exponent: 0.9
  law:
    form: parallel
    hardening: kinematic
    parts: [{modulus_MPa: 2900, yield_strain: 0.001}, {modulus_MPa: 1600}]
END
sed -i 's/^wire: .*/wire: .\/parts.yaml/; s/follower_N: .*, rows: 40/deflection_mm: 5, rows: 5/' rod.yaml
expect 0 'Ludwik equivalent of its law of parallel parts, the four numbers; loading is the same within' \
    "$wirebench" solve wire1d ./rod.yaml

# Three-point bending: properties of a test predict both ways of another.
for sample in 1 2; do
    "$wirebench" solve bending3p ./parts.yaml --span-mm 20 --deflection-mm 3 --points 80 --cycles 1 \
        --roller-radius-mm 2 --nose-radius-mm 2 --roller-friction 0.2 -o bent-$sample >/dev/null ||
        fail 'solve bending3p'
done
"$wirebench" calibrate bent-1 -o bent.yaml >said 2>&1 || fail 'calibrate bent-1'
for line in 'with unloading' '^found   parts (simulation, three-point bending, 1 of 1 tests fitted): M at ' \
    '^trust   for this specimen; misfit ' '^next    wirebench validate bent.yaml DATASET..., with tests of another span$'; do
    grep -q "$line" said || fail "no line '$line': $(cat said)"
done
"$wirebench" calibrate bent-1 --json >bent.json || fail 'calibrate --json of three-point bending'
python3 - bent.json <<'PYTHON' || fail 'the JSON object of three-point bending has other keys'
import json, sys
root = json.load(open(sys.argv[1]))
for key in "value", "low", "high", "candidates_low", "candidates_high":
    assert root["flexural_rigidity_N_mm2"][key] > 0, key
for item in root["moment_curvature"]:
    assert item["curvature_1_m"] > 0 and item["candidates_low"] <= item["moment_N_mm"], item
assert "unloading_stiffness_N_mm2" not in root and "loop_energy_mJ_per_m" not in root
PYTHON
expect 0 'unloading      RMS' "$wirebench" validate bent.yaml bent-2 -o bent-scores
grep -q 'parts,20,unloading,' bent-scores/scores.csv || fail 'no score of the unloading'
[ -s bent-scores/parts-L20-three-point-unloading.csv ] || fail 'no table of the unloading'
"$wirebench" solve bending3p ./parts.yaml --span-mm 24 --deflection-mm 3 --points 80 --cycles 1 \
    --roller-radius-mm 2 --nose-radius-mm 2 --roller-friction 0.2 -o bent-24 >/dev/null || fail 'solve bending3p'
"$wirebench" validate bent.yaml bent-1 bent-24 >said 2>&1 || fail 'validate two spans'
for line in '^found   parts in three-point bending, span 20 mm (simulation, 1 test): RMS error' \
    '^trust   span = 20 mm: undecided.*; 1 of these 2 tests' '^next '; do
    grep -q "$line" said || fail "validate: no line '$line': $(cat said)"
done
expect 0 '"kind": "three-point"' "$wirebench" validate bent.yaml bent-2 --json

# The compliance of a machine: from a stiff bar, and not from a soft one.
cat >bar.yaml <<END
name: bar
outer_diameter_mm: 6
conductor_diameter_mm: 6
density_g_cm3: 7.8
properties:
  youngs_modulus_MPa: 200000
  poissons_ratio: 0.3
  yield_stress_MPa: 100000
  strength_coefficient_MPa: 1000
  hardening_exponent: 0.5
END
bench='--span-mm 40 --points 40 --roller-radius-mm 2 --nose-radius-mm 2 --compliance-mm-n 0.002'
"$wirebench" solve bending3p ./bar.yaml $bench --deflection-mm 0.1 -o bar >/dev/null || fail 'solve bar'
expect 0 'compliance_mm_N: 0.002' \
    "$wirebench" calibrate --compliance bar --rigidity-n-mm2 12723450
expect 0 'trust   if the bar did not yield' "$wirebench" calibrate --compliance bar --rigidity-n-mm2 12723450
expect 3 'trust   no: cannot be determined from these tests' \
    "$wirebench" calibrate --compliance bar --rigidity-n-mm2 600000 --rigidity-error 1 --from-force 0.5
expect 3 'the bar is too compliant' \
    "$wirebench" calibrate --compliance bar --rigidity-n-mm2 600000 --rigidity-error 1 \
    --from-force 0.5
expect 1 'rigidity is missing' "$wirebench" calibrate --compliance bar

# These two are invalid on purpose.
rm unit.yaml unknown.yaml
${WIREBENCH_CHECK_FILES:-true} "$folder" || fail 'a file does not follow its schema'
[ $failures -eq 0 ] && echo 'all as expected'
exit $((failures > 0))
