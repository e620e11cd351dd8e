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
    "$wirebench" solve cantilever --wire type3 --deflection-mm 53 --strand-mm 760 --weight \
        --points 106 "$@" || fail "solve $*"
}
quick="--yield-point 0.04 --elements 12 --step-mm 1 --no-restart"

solve --length-mm 85 -o L85
solve --length-mm 100 -o L100
solve --length-mm 85 --law elastic -o elastic

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
expect 1 'unknown.yaml:1: colour' "$wirebench" validate unknown.yaml L100
expect 1 'missing.yaml' "$wirebench" validate missing.yaml L100

# What is given where a dataset or the properties are expected, and a command misspelt.
mkdir several && cp -r L85 several/b && cp -r L100 several/a && touch test.wbr
expect 1 "run \`wirebench align\` first" "$wirebench" calibrate test.wbr
expect 1 "holds several datasets: several/a, several/b;" "$wirebench" calibrate several
expect 1 'the properties file comes first' "$wirebench" validate L100 type3.yaml
expect 2 "no command 'calibrat': did you mean \`wirebench calibrate\`?" "$wirebench" calibrat
expect 2 "no command 'xyz'" "$wirebench" xyz
"$wirebench" xyz 2>&1 | grep -q 'did you mean' && fail 'xyz means nothing'
# One sample has no scatter, and numbers come without exponents.
# shellcheck disable=SC2086
"$wirebench" calibrate L85 $quick >said || fail 'calibrate'
grep -q '^one sample: no uncertainty$' said || fail "one sample: $(cat said)"
grep -qE '^(E|sigma_Y|K|n) .*e[-+]' said && fail "exponents: $(cat said)"
"$wirebench" calibrate --help | grep -q 'Mandatory or optional' && fail 'argp speaks of long options'

[ $failures -eq 0 ] && echo 'all as expected'
exit $((failures > 0))
