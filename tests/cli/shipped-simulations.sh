#!/bin/bash
# The report of the shipped simulations: complete, within the campaign's limits (tips, stress, cost),
# and the same bytes again.
# Usage: shipped-simulations.sh WIREBENCH SOURCE_ROOT
. "$(dirname "$0")/shipped.sh"
campaign=$root/fixtures/campaigns/section2.yaml

make_report "$campaign"
[ $code -eq 0 ] || fail "exit code $code: $(cat "$folder/a.err")"
grep -q '9 of 9 datasets used' "$folder/a.out" || fail 'a dataset is missing or stale'
make_it_again "$campaign"
expect_figures 9
forbid "experiment|$folder|$root"
[ "$(grep -o '<b>Passed\.</b>' "$folder/a/report.html" | wc -l)" -eq 4 ] || fail 'limits are missing'
grep -q 'substitute' "$folder/a/report.html" || fail 'substitutes are not named'

finish 'report of the shipped simulations'
