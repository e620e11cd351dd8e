#!/bin/sh
# Curves of testing machines through the tool: what is printed, what is kept, exit codes.
# Usage: import-force.sh WIREBENCH SOURCE_ROOT
set -eu
tool=$(realpath "$1")
fixtures=$2/fixtures
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fail() {
    echo "$*"
    exit 1
}
ends() { # CODE COMMAND...: the command ends with this code; what it says is in out
    code=0
    wanted=$1
    shift
    "$@" >out 2>&1 || code=$?
    [ "$code" = "$wanted" ] || fail "exit code $code, expected $wanted: $*: $(cat out)"
}
says() {
    grep -qF -- "$1" out || fail "does not say '$1': $(cat out)"
}

printf 'wire: w\nouter_diameter_mm: 0.8\nsample: 1\n' >wire.yaml
awk 'BEGIN { print "Zeit [s];Kraft [mN];Weg [mm]"
    for (i = 0; i < 50; i++) printf "%g;%g;%g\n", i, 10 * i, 0.02 * i
    print "50;;1.0"; print ";;" }' | tr . , >german.csv
bend="--specimen wire.yaml --machine $fixtures/machines/two-rollers.yaml"

ends 0 "$tool" import force german.csv $bend -o bent
says "50 rows taken of 53 lines; left out: 1 empty, 1 partial (1 without force"
says "found   w, sample 1 (three-point, measured): 50 rows, force up to 0.49 N"
says "trust   yes: the whole file was read; 1 incomplete row left out"
says "next    wirebench calibrate bent -o w.yaml"
zstd -dcq bent/original.zst | cmp - german.csv || fail "the original is not kept"
grep -q '"sha256": "'"$(sha256sum german.csv | cut -d' ' -f1)"'"' bent/dataset.json ||
    fail "its checksum is not written"
ends 1 "$tool" import force german.csv $bend -o bent
says "--force"
ends 0 "$tool" import force german.csv $bend -o bent --force --json
says '"partial_rows": 1'

# Cut within a row: usable, but incomplete.
head -n 30 german.csv >cut.csv
printf '29;4' >>cut.csv
ends 3 "$tool" import force cut.csv $bend -o cut
says "truncated"

# Refused with the place, nothing written.
sed '5s/.*/3;kaputt;0,06/' german.csv >odd.csv
ends 1 "$tool" import force odd.csv $bend -o odd
says "odd.csv:5: column 2 'Kraft [mN]': expected a number, not 'kaputt'"
[ ! -e odd ] || fail "a refused file left a folder"
ends 2 "$tool" import force german.csv -o odd
ends 2 "$tool" import force german.csv $bend -o odd --decimal dot
ends 2 "$tool" import nothing
printf 'PathFileType\t4\t(X/Y/Z)\ta.trc\n' >take.trc
ends 1 "$tool" import force take.trc $bend -o odd
says "wirebench import mocap"
printf '%s\n' 'wire: w' 'outer_diameter_mm: 0.8' 'mass_per_length_kg_m: 0.001' \
    'youngs_modulus_MPa: 1000' 'yield_stress_MPa: 10' 'strength_coefficient_MPa: 50' \
    'hardening_exponent: 0.5' 'poissons_ratio: 0.4' >w.yaml
ends 2 "$tool" validate w.yaml bent --elements 30
says "--elements applies only to tests of cantilevers"

# Other commands say what they expect.
ends 1 "$tool" validate "$fixtures/wires/type1.yaml" bent
ends 1 "$tool" calibrate --tensile bent
says "is a three-point test: a tensile test is expected here"

# A tensile test: E = 70 GPa on 1 mm2 and 50 mm up to 100 MPa, then sigma = 100 + 300 ep^0.5.
printf 'wire: w\nsample: 1\nconstituent: conductor\narea_mm2: 1\n' >pulled.yaml
awk 'BEGIN { print "Load (N)\tExtension (mm)"
    for (i = 0; i < 40; i++) printf "%.9g\t%.9g\n", 100 * i / 40, 50 * (100 * i / 40) / 70000
    for (i = 0; i <= 300; i++) { p = 0.1 * (i / 300) ^ 2; s = 100 + 300 * sqrt(p)
        e = exp(p + s / 70000) - 1; printf "%.9g\t%.9g\n", s / (1 + e), 50 * e } }' >pull.txt
ends 0 "$tool" import force pull.txt --specimen pulled.yaml \
    --machine "$fixtures/machines/tensile.yaml" -o pulled
says "no E"
ends 1 "$tool" calibrate pulled
says "a cantilever or three-point test is expected here"
ends 0 "$tool" calibrate --tensile pulled
says "found   conductor of w (measured, 1 specimen): "
says "; no E: the elongation is the crosshead's travel; one specimen cannot show how specimens differ"
says "next    run the same command with -o MATERIAL.yaml --youngs-modulus-mpa E --density-g-cm3 R"
says "crosshead travel: no E"
says "not identifiable"
ends 1 "$tool" calibrate --tensile pulled -o copper.yaml
says "--youngs-modulus-mpa"
ends 0 "$tool" calibrate --tensile pulled -o copper.yaml --youngs-modulus-mpa 117000 \
    --density-g-cm3 8.96 --poissons-ratio 0.34

# The same specimen with an extensometer on it, whose strain stands beside the travel of a machine that gives way by
# 0.002 mm/N: the slope is E, and the material file needs none from elsewhere.
sed 's/crosshead/extensometer/; $a compliance_mm_N: 0.002' "$fixtures/machines/tensile.yaml" >extensometer.yaml
awk -F'\t' 'NR == 1 { print $0 "\tStrain (%)"; next }
    { printf "%s\t%.9g\t%.9g\n", $1, $2 + 0.002 * $1, 2 * $2 }' pull.txt >strain.txt
ends 0 "$tool" import force strain.txt --specimen pulled.yaml --machine extensometer.yaml -o strained
! grep -qE "crosshead|compliance" out || fail "an extensometer sees no machine: $(cat out)"
grep -q '"header": "Strain (%)"' strained/dataset.json || fail "the strain is not taken"
ends 0 "$tool" calibrate --tensile strained
grep -qE '^E +7(\.0[0-9]*)?e\+04 MPa' out || fail "E is not 70 GPa: $(cat out)"
! grep -q "crosshead" out || fail "speaks of a crosshead: $(cat out)"
ends 0 "$tool" calibrate --tensile strained -o own.yaml --density-g-cm3 8.96 --poissons-ratio 0.34 --json
grep -qE '^youngs_modulus_MPa: (69|70)[0-9]{3}' own.yaml || fail "the material file has another E: $(cat own.yaml)"
grep -q 'elongation by extensometer; E of the tests' own.yaml || fail "its source is not said: $(cat own.yaml)"
ends 1 "$tool" calibrate --tensile pulled strained
says "sample 1: elongation by extensometer"

ends 0 "$tool" calibrate --constituents --conductor ./copper.yaml --conductor-diameter-mm 1 --json
says '"fill": 1'
ends 0 "$tool" calibrate --constituents --conductor ./copper.yaml --conductor-diameter-mm 1
says "found   computed from the materials: EI "
says "trust   as an estimate: no test of the wire was used"
ends 2 "$tool" calibrate --constituents --conductor ./copper.yaml
${WIREBENCH_CHECK_FILES:-true} . || fail 'a file does not follow its schema'
