#!/bin/bash
# The report of the shipped campaign: complete, and the same bytes again.
# Usage: shipped-report.sh WIREBENCH SOURCE_ROOT
. "$(dirname "$0")/shipped.sh"
campaign=$root/fixtures/campaigns/single-wires.yaml

make_report "$campaign"
[ $code -eq 0 ] || fail "exit code $code: $(cat "$folder/a.err")"
make_it_again "$campaign"
expect_figures 47
forbid "experiment|$folder|$root"
grep -q 'Virtual rig' "$folder/a/report.html" || fail 'the virtual rig is not named'
if command -v pdftotext >/dev/null; then
    text=$(pdftotext -layout "$folder/a/report.pdf" -)
    for part in 'Virtual rig.' 'Bending properties, from loading and unloading' \
        'parallel parts, kinematic' 'Calibrated properties' 'Type 3' 'SHA-256' 'measured (virtual rig)'; do
        grep -qF "$part" <<<"$text" || fail "the PDF does not say '$part'"
    done
fi

# A limit that is exceeded is a finding: all is written, and the exit code tells.
sed -e 's/calibration_rms_max: .*/calibration_rms_max: 1e-5/' -e 's/whole_cycle: true/whole_cycle: false/' \
    "$campaign" >"$folder/strict.yaml"
"$wirebench" report "$folder/strict.yaml" -o "$folder/strict" >"$folder/strict.out" 2>&1
[ $? -eq 4 ] || fail 'an exceeded limit does not end with 4'
grep -q 'limit 1e-05 exceeded' "$folder/strict.out" || fail 'the exceeded limit is not named'
grep -q 'class="warning"><b>Failed\.</b> Type 1, calibration' "$folder/strict/report.html" || fail 'the report hides the exceeded limit'

finish 'report of the shipped campaign'
