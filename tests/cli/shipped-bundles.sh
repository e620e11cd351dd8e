#!/bin/bash
# The report of the shipped bundles: complete, its energies within the campaign's limits, and the same
# bytes again. How far the curves are from the published ones is a result: that limit may be exceeded.
# Usage: shipped-bundles.sh WIREBENCH SOURCE_ROOT
. "$(dirname "$0")/shipped.sh"
campaign=$root/fixtures/campaigns/bundles.yaml

make_report "$campaign"
if grep -q ': 0 of [0-9]* datasets used' "$folder/a.out" && [ ! -e "$root/simulations/7-type3" ]; then
    echo 'skipped: no bundles are shipped; simulations/make-simulations makes them'
    exit 77
fi
[ $code -eq 0 ] || [ $code -eq 4 ] || fail "exit code $code: $(cat "$folder/a.err")"
grep -qE ': ([0-9]+) of \1 datasets used' "$folder/a.out" || fail 'a dataset is missing or outdated'
grep 'limit .* exceeded' "$folder/a.out" | grep -v rms_max && fail 'energy or cost is beyond its limit'
make_it_again "$campaign"
# The first page; of five groups: sections, forces, errors, energies, the section model; studies,
# eleven bent bundles, 3D beside 1D.
expect_figures 43
forbid "$folder|$root/"

# What a user calibrates is what the report has of the first bundle.
"$wirebench" calibrate "$root/simulations/7-type3" --method paper --yield-point 0.04 --step-mm 0.5 \
    -o "$folder/beam.yaml" >/dev/null 2>&1 || fail 'calibrate'
for key in youngs_modulus_MPa yield_stress_MPa strength_coefficient_MPa hardening_exponent; do
    own=$(sed -n "s/^$key: //p" "$folder/beam.yaml")
    reported=$(awk -v key="\"$key\":" '/"fitted": {/ { f = 1 } f && $1 == key { print $2 + 0; exit }' \
        OFMT=%.12g "$folder/a/report.json")
    awk -v a="$own" -v b="$reported" 'BEGIN { exit !(a > 0 && a / b - 1 < 1e-9 && b / a - 1 < 1e-9) }' ||
        fail "calibrate finds $key $own, the report $reported"
done

finish 'report of the shipped bundles'
