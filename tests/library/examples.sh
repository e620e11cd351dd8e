#!/bin/sh
# The examples in C print the same as the tool for the same input. Usage:
#     examples.sh WIREBENCH EXAMPLES_FOLDER RECORDING PREPARED_FOLDER
set -eu
tool=$1 examples=$2 recording=$3 prepared=$4
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() {
    echo "$*"
    exit 1
}
close() { # WHAT A B: equal to 8 digits
    awk -v a="$2" -v b="$3" 'BEGIN { d = a - b; if (d < 0) d = -d; s = b < 0 ? -b : b
        exit !(a != "" && b != "" && d <= 1e-8 * s + 1e-12) }' || fail "$1: '$2' and '$3'"
}

"$examples/read_recording" "$recording" >"$folder/read"
grep -q '^virtual rig, .* whole$' "$folder/read" || fail "$(cat "$folder/read")"
"$tool" export "$recording" -o "$folder/csv" >/dev/null
awk -F, '!/^[#t]/ { n++; if ($4 != "") { if (least == "" || $4 + 0 < least) least = $4 + 0
        if (most == "" || $4 + 0 > most) most = $4 + 0 } }
    END { printf "load: %d readings, %.9g to %.9g N\n", n, least, most }' \
    "$folder/csv/load.csv" >"$folder/expected"
grep '^load:' "$folder/read" | cmp -s - "$folder/expected" ||
    fail "read_recording: $(cat "$folder/read") instead of $(cat "$folder/expected")"

"$examples/calibrate_dataset" "$prepared/dataset" >"$folder/calibrated"
rigidity=$(sed -n '/"flexural_rigidity_N_mm2"/,/}/s/.*"value": *\([0-9.e+-]*\).*/\1/p' \
    "$prepared/cycle.json")
[ -n "$rigidity" ] || fail "no rigidity in $(head -c 500 "$prepared/cycle.json")"
close rigidity "$(sed -n 's/^EI \([^ ]*\) N m2.*/\1/p' "$folder/calibrated")" \
    "$(awk -v r="$rigidity" 'BEGIN { printf "%.17g", r * 1e-6 }')"
ratio=$(sed -n '/"residual_curvature_ratio"/,/}/s/.*"value": *\([0-9.e+-]*\).*/\1/p' \
    "$prepared/cycle.json")
close residual_curvature_ratio "$(sed -n 's/^residual curvature ratio \([^ ]*\) .*/\1/p' "$folder/calibrated")" "$ratio"

# The same when aligned in memory; missing parts of the test are reported.
"$examples/calibrate_dataset" "$recording" >"$folder/calibrated-recording" 2>"$folder/err"
cmp "$folder/calibrated" "$folder/calibrated-recording" || fail "a recording differs from its dataset"
grep -q '^calibrate_dataset: .*1 gap in the rows' "$folder/err" || fail "$(cat "$folder/err")"

"$examples/solve_cantilever" type1 0.085 0.05 >"$folder/solved"
"$tool" solve cantilever --wire type1 --length-mm 85 --deflection-mm 50 --points 10 --cycles 1 |
    awk -F, 'NR > 1 { print $5 }' >"$folder/forces"
awk -F, 'NR > 1 { print $2 }' "$folder/solved" >"$folder/library-forces"
[ "$(wc -l <"$folder/forces")" = 21 ] || fail "not 21 rows of the tool"
paste "$folder/library-forces" "$folder/forces" | awk '{ d = $1 - $2; if (d < 0) d = -d
    if (d > 1e-8) { print "row " NR ": " $0; bad = 1 } n++ } END { exit bad || n != 21 }' ||
    fail "solve_cantilever differs from the tool"

# The tool ends where the nose has left the wire during unloading, beyond which the force is 0.
"$examples/solve_three_point" type1 0.04 0.008 >"$folder/solved"
"$tool" solve bending3p type1 --span-mm 40 --deflection-mm 8 --points 10 --cycles 1 \
    --roller-radius-mm 3 --nose-radius-mm 3 >"$folder/curve"
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "force_N") column = i; next }
    { print $column }' "$folder/curve" >"$folder/forces"
rows=$(wc -l <"$folder/forces")
[ "$rows" -gt 12 ] || fail "only $rows rows of the tool"
awk -F, 'NR > 1 { print $2 }' "$folder/solved" >"$folder/library-forces"
[ "$(wc -l <"$folder/library-forces")" = 21 ] || fail "not 21 rows of solve_three_point"
awk -v rows="$rows" 'NR == FNR { tool[NR] = $1; next }
    { d = $1 - (FNR <= rows ? tool[FNR] : 0); if (d < 0) d = -d
      if (d > 1e-8) { print "row " FNR ": " $1 " and " tool[FNR]; bad = 1 } }
    END { exit bad }' "$folder/forces" "$folder/library-forces" ||
    fail "solve_three_point differs from the tool"

# A harness: the forces of each step, and those of the step before the last again after an undo.
"$examples/assemble_harness" small >"$folder/assembled"
"$tool" solve harness small -o "$folder/harness" >/dev/null 2>&1
awk -F, 'NR > 1 { printf "%s,%s,%.9g\n", $1, $2, $3; if ($1 == 6) last = last sprintf("%s,%s,%.9g\n", $1, $2, $3) }
    END { printf "%s", last }' "$folder/harness/forces.csv" >"$folder/expected"
awk -F, 'NR > 1 { print $1 "," $3 "," $4 }' "$folder/assembled" | cmp -s - "$folder/expected" ||
    fail "assemble_harness: $(cat "$folder/assembled") instead of $(cat "$folder/expected")"
[ "$(wc -l <"$folder/expected")" -gt 15 ] || fail "not all steps of the harness"

! "$examples/solve_cantilever" none 0.085 0.05 2>"$folder/err" || fail "a wire that is not there"
grep -q "^solve_cantilever: .*'none'" "$folder/err" || fail "$(cat "$folder/err")"
