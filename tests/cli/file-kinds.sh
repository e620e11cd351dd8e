#!/bin/bash
# `wirebench info` of every kind of file, and what commands say of a file of the wrong kind.
# Usage: file-kinds.sh WIREBENCH SOURCE_ROOT
set -u
wirebench=$(realpath "$1")
root=$2
export WIREBENCH_DATA=$root
folder=$(mktemp -d /tmp/wb-kinds-XXXXXX)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

kind() { # KIND FILE...: info names that kind and a next command or hint
    local wanted=$1 file said
    shift
    for file in "$@"; do
        said=$("$wirebench" info "$file" --json) || fail "info $file ended with $?"
        grep -q "^  \"kind\": \"$wanted\"" <<<"$said" || fail "$file is not '$wanted': $said"
    done
}

rejects() { # WORDS ARGUMENTS...: exit code 1, one message with these words
    local words=$1 said code
    shift
    said=$("$wirebench" "$@" 2>&1)
    code=$?
    [ $code -eq 1 ] || fail "$* ended with $code"
    grep -qF -- "$words" <<<"$said" || fail "$*: '$words' not said: $said"
    [ "$(wc -l <<<"$said")" -eq 1 ] || fail "$* said more than one line: $said"
}

fixtures=$root/fixtures
kind rig "$fixtures"/rigs/*.yaml
kind specimen "$fixtures"/specimens/*.yaml
kind wire "$fixtures"/wires/*.yaml
kind material "$fixtures"/materials/*.yaml "$fixtures"/formats/*/material*.yaml
kind model "$fixtures"/models/*.yaml
kind bundle "$fixtures"/bundles/7-type3.yaml "$fixtures"/bundles/template.yaml "$fixtures"/formats/*/bundle.yaml
kind harness "$fixtures"/harnesses/*.yaml
kind machine "$fixtures"/machines/*.yaml
kind campaign "$fixtures"/campaigns/*.yaml "$fixtures"/formats/*/campaign-*.yaml
kind properties "$fixtures"/formats/*/properties-*.yaml "$root/docs/cards/type1.yaml"
kind dataset "$fixtures"/formats/*/{cantilever,tensile,three-point} "$root/simulations/7-type3/"
kind dataset_file "$root"/simulations/7-type3/*
kind datasets "$root/simulations"
kind recordings "$root/recordings"
kind index "$root/recordings/index.yaml" "$root/simulations/index.yaml"
printf '{"tool": {"name": "wirebench report"}, "limit_exceeded": false, "files": []}\n' >report.json
kind report_json report.json
printf '{"report": "1", "inputs": [], "files": []}\n' >manifest.json
kind manifest manifest.json
mkdir series && printf -- '- file: a.wbr\n  sample: 1\n' >series/index.yaml
kind index series/index.yaml
printf 'utc,known_mass_g,read_mass_g\n' >rig.checks.csv
kind check_log rig.checks.csv
mkdir checked && printf 'wire,length_mm\n' | tee checked/scores.csv >checked/type1.csv
kind validation checked checked/scores.csv checked/type1.csv
kind recording "$root/recordings/type1-L85-1.wbr.zst"
kind card "$root"/docs/cards/type1.{abaqus.inp,calculix.inp,csv,json,mujoco.xml}
kind figure "$root"/docs/images/*.png

printf 'kind: harness\ntitle: T\nharness: small\n' >h.yaml
kind campaign h.yaml
printf 'series: s\nspecimen: like.yaml\nspecimens: 3\n' >series.yaml
kind series series.yaml
printf 'wire: w\nsample: 1\nconstituent: conductor\narea_mm2: 1\n' >piece.yaml
kind machine_specimen piece.yaml
awk 'BEGIN { print "Load (N)\tExtension (mm)"; for (i = 0; i < 20; i++) print i "\t" i / 10 }' >curve.txt
kind table curve.txt
iconv -f UTF-8 -t UTF-16 curve.txt >utf-16.txt
kind table utf-16.txt
printf 'PathFileType\t4\t(X/Y/Z)\ttake.trc\n' >take.trc
kind take take.trc
printf 'wirebench checkpoint 1\nx\n' >state
kind checkpoint state
"$wirebench" solve cantilever --wire type1 --length-mm 85 --deflection-mm 5 --points 5 -o 'a set' >said ||
    fail 'solve'
kind figure 'a set.svg'
"$wirebench" export 'a set' -o set.h5 >/dev/null && kind hdf5 set.h5
kind rig fixtures/rigs/paper.yaml # a shipped one, from any folder

# As text: the kind, values where they are short, and a command that can be pasted.
"$wirebench" info "$root/docs/cards/type1.yaml" >said || fail 'info of properties'
for line in ': a properties file$' '^wire type1 (virtual rig)' '^next  *wirebench validate '; do
    grep -q "$line" said || fail "properties: no '$line': $(cat said)"
done
"$wirebench" info 'a set' >said || fail 'info of a dataset'
grep -qF "next    wirebench calibrate 'a set' -o PROPERTIES.yaml" said || fail "dataset: $(cat said)"

"$wirebench" info "$fixtures"/formats/0.1.0/tensile >said || fail 'info of a tensile test'
grep -q '^next    wirebench calibrate --tensile ' said && grep -q 'gauge length$' said ||
    fail "tensile test: $(cat said)"
"$wirebench" info "$root"/simulations/follower-8awg-1d >said || fail 'info of a follower test'
grep -q '^next    wirebench validate ' said || fail "follower test: $(cat said)"

# What is unknown, missing or broken.
echo text >notes.txt
printf 'root:x:0:0\ndaemon:x:1:1\nbin:x:2:2\nsys:x:3:3\nsync:x:4:65534\n' >users
rejects "'users'" info users
rejects "'notes.txt'" info notes.txt
rejects "'./none.yaml'" info ./none.yaml
printf 'name: [\n' >broken.yaml
rejects 'broken.yaml:' info broken.yaml
printf 'colour: red\n' >other.yaml
rejects "'other.yaml'" info other.yaml

# The wrong kind: its name, what is expected, and the command that takes it.
properties=$root/docs/cards/type1.yaml rig=$fixtures/rigs/paper.yaml
recording=$root/recordings/type1-L85-1.wbr.zst specimen=$fixtures/specimens/type1-L85-1.yaml
rejects 'is a properties file, expected a dataset; for this file: wirebench validate' calibrate "$properties"
rejects 'is a recording, expected a dataset; for this file: wirebench align' calibrate --tensile "$recording"
rejects "'notes.txt' is of unknown kind, expected a dataset" calibrate notes.txt
rejects "'none' does not exist, expected a dataset" validate "$properties" none
rejects 'is a properties file, expected a recording' align "$properties" -o x
rejects 'is a rig file, expected a recording' clock "$rig"
rejects 'is a rig file, expected a recording' quicklook "$rig" -o x
rejects 'is a rig file, expected a recording' replay "$rig"
rejects 'is a rig file, expected a recording' verify "$rig"
rejects 'is a rig file, expected a recording' recover "$rig" -o x.wbr
rejects 'is a properties file, expected a recording or a dataset' export "$properties" -o x
rejects 'is a rig file, expected a properties file or a wire file' export "$rig" --to table
rejects "is a dataset, expected a properties file; for this file: wirebench calibrate 'a set'" \
    validate 'a set' "$properties"
rejects 'is a wire file, expected a properties file' compare "$properties" "$fixtures/wires/type1.yaml" --within 0.1
rejects 'is a specimen file, expected a rig file' doctor "$specimen"
rejects 'is a rig file, expected a specimen file' doctor "$rig" "$rig"
rejects 'is a specimen file, expected a rig file' record "$specimen" --specimen "$specimen" -o x.wbr
rejects 'is a specimen file, expected a series file' record "$rig" --series "$specimen"
rejects 'is a wire file, expected a rig file' stage "$fixtures/wires/type1.yaml" home
rejects 'is a rig file, expected a specimen file' rig "$rig" --specimen "$rig" --run bench
rejects 'is a rig file, expected a machine file' import force curve.txt --specimen piece.yaml --machine "$rig" -o x
rejects 'is a take of motion capture, expected a table of numbers' import force take.trc \
    --specimen piece.yaml --machine "$fixtures/machines/tensile.yaml" -o x
rejects 'is a table of numbers, expected a take' import mocap curve.txt --specimen "$specimen" --rig "$rig" -o x.wbr
rejects 'is a model file, expected a properties file or a wire file' solve cantilever --wire "$fixtures/models/follower-8awg.yaml" \
    --length-mm 85 --deflection-mm 5
rejects 'is a wire file, expected a bundle file' solve bundle "$fixtures/wires/type1.yaml"
rejects 'is a bundle file, expected a model file' solve wire1d "$fixtures/bundles/7-type3.yaml"
rejects 'is a wire file, expected a campaign file' report "$fixtures/wires/type1.yaml" -o x
rejects 'is a wire file, expected a material file' calibrate --constituents --conductor "$fixtures/wires/type1.yaml" \
    --conductor-diameter-mm 1
for file in x x.wbr; do
    [ ! -e $file ] || fail "$file was written"
done
[ $failures -eq 0 ]
