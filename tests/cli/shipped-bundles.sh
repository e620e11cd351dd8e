#!/bin/bash
# The report of the shipped bundles: complete, its energies within the campaign's limits, and the same
# bytes from other folders, with another number of threads and in another language. How far the
# curves are from the published ones is a result: that limit may be exceeded.
# Usage: shipped-bundles.sh WIREBENCH SOURCE_ROOT
set -u

wirebench=$(realpath "$1")
campaign=$2/fixtures/campaigns/bundles.yaml
folder=$(mktemp -d /tmp/wb-shipped-XXXXXX)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

"$wirebench" report "$campaign" -o "$folder/a" >"$folder/a.out" 2>"$folder/a.err"
code=$?
cat "$folder/a.out"
if grep -q ': 0 of [0-9]* datasets used' "$folder/a.out" && [ ! -e "$2/simulations/7-type3" ]; then
    echo 'skipped: no bundles are shipped; simulations/make-simulations makes them'
    exit 77
fi
[ $code -eq 0 ] || [ $code -eq 4 ] || fail "exit code $code: $(cat "$folder/a.err")"
grep -qE ': ([0-9]+) of \1 datasets used' "$folder/a.out" || fail 'a dataset is missing or outdated'
grep 'limit .* exceeded' "$folder/a.out" | grep -v rms_max && fail 'energy or cost is beyond its limit'

cd /tmp || exit 1
TZ=Asia/Kathmandu LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 "$wirebench" report \
    "$campaign" -o "$folder/deeper/b" --threads 1 >/dev/null 2>&1
[ $? -eq $code ] || fail 'another run ended otherwise'
diff -r "$folder/a" "$folder/deeper/b" >/dev/null || fail 'another run gave other bytes'

# Of four groups: sections, forces, errors, energies; two studies, nine bent bundles, 3D beside 1D.
[ "$(find "$folder/a/figures" -name '*.svg' | wc -l)" -eq 28 ] || fail 'figures are missing'
grep -qiE "$folder|$2/" "$folder/a/report.html" "$folder/a/report.json" &&
    fail 'a path that must not be there'

[ $failures -eq 0 ] && echo 'report of the shipped bundles: all good'
exit $((failures > 0))
