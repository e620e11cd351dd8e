#!/bin/bash
# The report of the shipped simulations: complete, within the campaign's limits (tips, stress, cost),
# and the same bytes from other folders, with another number of threads and in another language.
# Usage: shipped-simulations.sh WIREBENCH SOURCE_ROOT
set -u

wirebench=$(realpath "$1")
campaign=$2/fixtures/campaigns/section2.yaml
folder=$(mktemp -d /tmp/wb-shipped-XXXXXX)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

"$wirebench" report "$campaign" -o "$folder/a" >"$folder/a.out" 2>"$folder/a.err"
code=$?
[ $code -eq 0 ] || fail "exit code $code: $(cat "$folder/a.err")"
cat "$folder/a.out"
grep -q '9 of 9 datasets used' "$folder/a.out" || fail 'a dataset is missing or stale'

cd /tmp || exit 1
TZ=Asia/Kathmandu LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 "$wirebench" report \
    "$campaign" -o "$folder/deeper/b" --threads 1 >/dev/null 2>&1
[ $? -eq $code ] || fail 'another run ended otherwise'
diff -r "$folder/a" "$folder/deeper/b" >/dev/null || fail 'another run gave other bytes'

[ "$(find "$folder/a/figures" -name '*.svg' | wc -l)" -eq 9 ] || fail 'figures are missing'
[ "$(grep -o 'Limit kept' "$folder/a/report.html" | wc -l)" -eq 4 ] || fail 'limits are not told'
grep -q 'substitute' "$folder/a/report.html" || fail 'substitutes are not named'
grep -qiE "experiment|$folder|$2" "$folder/a/report.html" "$folder/a/report.json" &&
    fail 'a word or path that must not be there'

[ $failures -eq 0 ] && echo 'report of the shipped simulations: all good'
exit $((failures > 0))
