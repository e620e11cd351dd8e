#!/bin/bash
# The report of the shipped campaign: complete, and the same bytes from other folders, with another
# number of threads and in another time zone and language.
# Usage: shipped-report.sh WIREBENCH SOURCE_ROOT
set -u

wirebench=$(realpath "$1")
campaign=$2/fixtures/campaigns/single-wires.yaml
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

cd /tmp || exit 1
TZ=Asia/Kathmandu LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 "$wirebench" report \
    "$campaign" -o "$folder/deeper/b" --threads 1 >/dev/null 2>&1
[ $? -eq $code ] || fail 'another run ended otherwise'
diff -r "$folder/a" "$folder/deeper/b" >/dev/null || fail 'another run gave other bytes'

[ "$(find "$folder/a/figures" -name '*.svg' | wc -l)" -eq 25 ] || fail 'figures are missing'
grep -q 'Virtual rig' "$folder/a/report.html" || fail 'the virtual rig is not named'
grep -qiE "experiment|$folder|$2" "$folder/a/report.html" "$folder/a/report.json" &&
    fail 'a word or path that must not be there'
if command -v pdftotext >/dev/null; then
    text=$(pdftotext -layout "$folder/a/report.pdf" -)
    for part in 'Virtual rig.' 'Calibrated properties' 'Type 3' 'SHA-256' 'measured (virtual rig)'; do
        grep -qF "$part" <<<"$text" || fail "the PDF does not say '$part'"
    done
fi

# A limit that is exceeded is a finding: all is written, and the exit code tells.
sed 's/calibration_rms_max: .*/calibration_rms_max: 1e-5/' "$campaign" >"$folder/strict.yaml"
"$wirebench" report "$folder/strict.yaml" -o "$folder/strict" >"$folder/strict.out" 2>&1
[ $? -eq 4 ] || fail 'an exceeded limit does not end with 4'
grep -q 'limit 1e-05 exceeded' "$folder/strict.out" || fail 'the exceeded limit is not named'
grep -q 'Limit exceeded' "$folder/strict/report.html" || fail 'the report hides the exceeded limit'

[ $failures -eq 0 ] && echo 'report of the shipped campaign: all good'
exit $((failures > 0))
