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
# 4: a limit is exceeded, which is a finding and no fault of the report.
[ $code -eq 0 ] || [ $code -eq 4 ] || fail "exit code $code: $(cat "$folder/a.err")"
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

[ $failures -eq 0 ] && echo 'report of the shipped campaign: all good'
exit $((failures > 0))
