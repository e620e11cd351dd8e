#!/bin/bash
# `report --check` notices a byte that changed in any file that a signed report was made from: of
# recordings, testing machines, wires, bundles, predictions and harnesses, all small ones.
# Usage: sign-inputs.sh WIREBENCH SOURCE_ROOT KIND...
# (wires, machines, bundles, predictions, harnesses, recordings)
. "$2/tests/cli/reports.sh"
command -v gpg >/dev/null || {
    echo 'gpg is not installed'
    exit 77
}
source=$2
export GNUPGHOME=$folder/keys WIREBENCH_DATA=$folder/shipped WIREBENCH_TEST_DATA=$folder/bench
mkdir -m 700 "$GNUPGHOME"
mkdir "$WIREBENCH_DATA" "$folder/bench" "$folder/own"
cp -r "$source/fixtures" "$WIREBENCH_DATA"
trap 'gpgconf --kill all; rm -rf "$folder"' EXIT
gpg --batch --quiet --passphrase '' --quick-gen-key 'Tester <tester@example.org>' ed25519 sign never \
    2>"$folder/gpg" || { cat "$folder/gpg"; exit 1; }
cd "$folder/own" || exit 1

kinds=${*:3}

# Signs the report of a campaign, which lists these inputs and no others; changes one byte of each, but
# of a recording, which nothing could be read of then: all of them are named.
signed() { # CAMPAIGN INPUT...
    local campaign=$1 name n=0
    shift
    printf 'laboratory: {report: WB-1, issued: 2026-11-23}\n' >>"$campaign.yaml"
    run 3 "$campaign.yaml" -o "$campaign-r" --sign tester@example.org
    python3 - "$campaign-r/manifest.json" "$@" <<'PYTHON' || fail "$campaign: other inputs than these"
import difflib, json, sys
listed = sorted(i["name"] for i in json.load(open(sys.argv[1]))["inputs"])
print("\n".join(difflib.unified_diff(sorted(sys.argv[2:]), listed, "expected", "listed", "", "", 0, "")))
sys.exit(listed != sorted(sys.argv[2:]))
PYTHON
    run 0 --check "$campaign-r" "$campaign.yaml"
    grep -qF "inputs: $# as signed" "$folder/out" || fail "$campaign: not $# inputs"
    python3 - "$folder/own" "$WIREBENCH_DATA" "$folder" "$@" <<'PYTHON'
import os, re, sys
for name in sys.argv[4:]:
    if name.endswith(".zst"):
        continue
    folders = sys.argv[1], sys.argv[2], sys.argv[3], sys.argv[3] + "/datasets"
    path = next(p for p in (os.path.join(f, name) for f in folders) if os.path.exists(p))
    text = open(path).read()
    # One that says the same: what is refused would hide the files after it.
    changed = text[:-1] + " " if text.endswith("\n") else text + "\n"
    if path.endswith(".csv"):
        changed = re.sub(r"\d(?=\D*$)", lambda m: str((int(m[0]) + 1) % 10), text)
    assert changed != text, path
    open(path, "w").write(changed)
PYTHON
    run 1 --check "$campaign-r" "$campaign.yaml"
    for name; do
        [[ $name == *.zst ]] && continue
        n=$((n + 1))
        grep -qF "input '$name' is not what was signed" "$folder/err" || fail "$campaign: $name is not noticed"
    done
    grep -qF "error: $n of the inputs" "$folder/err" || fail "$campaign: $(cat "$folder/err")"
}

# --- the kinds ---

# Rods stand in for solids, which take long.
wires() {
    cat >wires.yaml <<'YAML'
kind: comparison
title: Solid and rod
simulations: sim
elastic: {model: follower-8awg-elastic}
elastoplastic: {model: follower-8awg}
fit: {elements: 10, fibres: 12}
YAML
    for model in follower-8awg-elastic follower-8awg; do
        "$wirebench" solve wire1d $model -o "sim/$model-1d" >/dev/null 2>&1 || fail "cannot solve $model"
    done
    wire=(fixtures/models/follower-8awg{,-elastic}.yaml fixtures/wires/8awg.yaml
        fixtures/materials/{annealed-copper,pvc}.yaml)
    signed wires "${wire[@]}" sim/follower-8awg{,-elastic}-1d/{dataset.json,fields.csv,force_deflection.csv,shape.csv}
}

machines() {
    test_of() { # FILE EI SPAN
        awk -v EI="$2" -v L="$3" 'BEGIN { print "Load (N)\tTravel (mm)"
            for (i = 0; i <= 600; i++) { d = i * 0.005 - 0.1
                printf "%.9g\t%.9g\n", (d > 0 ? 48 * EI * d / L ^ 3 : 0), i * 0.005 } }' >"$folder/bench/$1.txt"
    }
    group() { # NAME MACHINE
        printf '  - {name: %s, machine: %s, outer_diameter_mm: 0.5, zero_force_mN: 0.01, tests: [%s.txt]}\n' \
            "$1" "$2" "$1"
    }
    test_of wire 30 10
    test_of core 5 10
    test_of layer 185 20
    printf 'name: m\nkind: three-point\nspan_mm: 10\nroller_radius_mm: 1\n' >m.yaml
    sed 's/span_mm: 10/span_mm: 20/' m.yaml >m20.yaml
    printf 'name: metal\nsource: made up\nyoungs_modulus_MPa: 1000\npoissons_ratio: 0.3\ndensity_g_cm3: 1\n' >metal.yaml
    {
        printf 'kind: machine\ntitle: A made-up cable\ndata_environment: WIREBENCH_TEST_DATA\ngroups:\n'
        group wire m.yaml
        group core m.yaml
        group layer m20.yaml
        printf 'cable: {wires: [wire], core: core, layers: [layer], wire_count: 6, wire_circle_radius_mm: 1,\n'
        printf '  conductor: metal.yaml, conductor_area_mm2: 0.1}\n'
    } >machines.yaml
    signed machines m.yaml m20.yaml metal.yaml bench/{wire,core,layer}.txt
}

bundles() { # one wire stands in for a bundle
    cat >one.yaml <<'YAML'
name: one
title: One wire
wires: [{wire: type3, count: 1}]
packing: hexagon
length_mm: 85
interface: {cohesive_stiffness_N_mm3: 30, friction: 0.4}
meshes: [{name: coarse, core_quads: 2, rings: 1, elements_along: 20, formulation: 2x2x1}]
run: {mesh: coarse, deflection_mm: 20, rows: 40, mass_scaling: 25, selective_mass_scaling: 10}
loads: {strand_mm: 760, weight: true}
published: {outer_diameter_mm: 1.4, density_g_cm3: 4.97, beam: type3}
YAML
    cat >bundles.yaml <<'YAML'
kind: bundles
title: One wire
simulations: ../datasets
defaults: {dead_force: true, weight: false, duration_s: 0.5}
runs: [{name: one, bundle: ./one.yaml}]
groups: [{label: A wire, bundles: [{label: one wire, dynamic: one, rod: one-1d}]}]
fit: {elements: 10, fibres: 12}
YAML
    run 0 bundles.yaml -o made --solve
    signed bundles one.yaml fixtures/wires/type3.yaml one-1d/{dataset.json,force_deflection.csv,shape.csv} \
        one/{dataset.json,energies.csv,force_deflection.csv,shape.csv,surface.csv}
}

predictions() { # of a bundle whose test is one of a rod
    cat >predictions.yaml <<'YAML'
kind: prediction
title: Bands
runs: 20
bundles: [{bundle: template, tests: [{dataset: ./test, label: a rod}]}]
YAML
    "$wirebench" solve cantilever --wire type3 --length-mm 114 --deflection-mm 53 -o test || fail 'no test'
    signed predictions fixtures/bundles/template.yaml fixtures/wires/type3.yaml fixtures/materials/tape.yaml \
        test/{dataset.json,force_deflection.csv,shape.csv}
}

harnesses() { # with a wire of its own
    cp "$source/docs/cards/type1.yaml" lead.yaml
    sed 's/wire: type3/wire: lead.yaml/' "$source/fixtures/harnesses/small.yaml" >small.yaml
    printf 'kind: harness\ntitle: A harness\nharness: small.yaml\n' >harnesses.yaml
    signed harnesses small.yaml lead.yaml fixtures/wires/bundle-7.yaml
}

recordings() { # with a rig and a specimen that were corrected afterwards
    cp "$source/recordings/type1-L85-1.wbr.zst" one.wbr.zst
    cp "$source/fixtures/rigs/paper.yaml" rig.yaml
    cp "$source/fixtures/specimens/type1-L85-1.yaml" specimen.yaml
    printf -- '- {file: one.wbr.zst, wire: type1, length_mm: 85, sample: 1, sha256: %s,\n   %s}\n' \
        "$("$wirebench" info one.wbr.zst | sed -n 's/^ *sha256 *//p')" \
        'corrected_rig: rig.yaml, corrected_specimen: specimen.yaml' >index.yaml
    cat >recordings.yaml <<'YAML'
title: One recording
index: index.yaml
calibration_length_mm: 85
settings: {step_mm: 5}
wires: [{wire: type1}]
YAML
    signed recordings one.wbr.zst rig.yaml specimen.yaml fixtures/wires/type1.yaml

    # An index grows, and is no input; what is chosen by it is.
    echo '# more' >>index.yaml
    run 1 --check recordings-r recordings.yaml
    grep -qF 'index.yaml' "$folder/err" && fail 'the index is an input'
    printf x | dd of=one.wbr.zst bs=1 seek=100000 conv=notrunc 2>/dev/null
    run 1 --check recordings-r recordings.yaml
    grep -qF "input 'one.wbr.zst' was signed, and is not here or not read" "$folder/err" || fail 'a recording that changed'
}

[[ " $kinds " == *" wires "* ]] && wires
[[ " $kinds " == *" machines "* ]] && machines
[[ " $kinds " == *" bundles "* ]] && bundles
[[ " $kinds " == *" predictions "* ]] && predictions
[[ " $kinds " == *" harnesses "* ]] && harnesses
[[ " $kinds " == *" recordings "* ]] && recordings
finish "inputs of signed reports: $kinds"
