#!/bin/bash
# What doctor says of a bench: ready where it is well, and the fault by its name where one can be
# known at rest. Faults that come with the motion (clock-restart, unit-change, replug-cell, the
# unplug ones, stuck-stage, strand-break) cannot: tests/cli/faults.sh has those.
# Usage: doctor.sh WIREBENCH SOURCE_ROOT
set -u
. "$(dirname "$0")/wait.sh"

wirebench=$(realpath "$1")
root=$2
specimen=$root/fixtures/specimens/type1-L85-1.yaml
folder=$(mktemp -d /tmp/wb-doctor-XXXXXX)
failures=0
trap 'rm -rf "$folder"' EXIT

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# begin NAME RIG-OPTIONS...: starts a virtual rig; its process is in $rig.
begin() {
    local name=$1
    shift
    "$wirebench" rig "$root/fixtures/rigs/paper.yaml" --specimen "$specimen" \
        --run "$folder/$name" "$@" 2>"$folder/$name.log" &
    rig=$!
    wait_until "$rig" grep -qs '^ready' "$folder/$name.log" ||
        fail "$name: the rig is not ready: $(cat "$folder/$name.log")"
}

finish() {
    kill -INT "$rig" 2>/dev/null
    wait "$rig" 2>/dev/null
}

# look NAME CODE RIG.yaml [SPECIMEN.yaml] [OPTIONS...]: doctor's exit code; its words in NAME.said.
look() {
    local name=$1 expected=$2 code
    shift 2
    "$wirebench" doctor --seconds 3 --folder "$folder" "$@" >"$folder/$name.said" 2>&1
    code=$?
    [ "$expected" = any ] || [ $code = "$expected" ] ||
        fail "$name: exit code $code, expected $expected: $(cat "$folder/$name.said")"
}

said() { # NAME WORDS
    grep -qE -- "$2" "$folder/$1.said" || fail "$1: not said: '$2': $(cat "$folder/$1.said")"
}

# A busy machine loses frames and is late by itself: where that may be, any exit code is taken.
one_fault() { # NAME FAULTS CODE WORDS [RIG-OPTIONS...]
    local name=$1 faults=$2 code=$3 words=$4
    shift 4
    begin "$name" --faults "$faults" "$@"
    look "$name" "$code" "$folder/$name/rig.yaml" "$specimen"
    finish
    said "$name" "$words"
}

well() {
    begin well
    look well any "$folder/well/rig.yaml" "$specimen"
    grep -E 'NOT READY' "$folder/well.said" | grep -vE '^(load cell|frames|disk) |things? to mend' &&
        fail "well: $(cat "$folder/well.said")"
    # Ready, unless the machine itself lost readings or frames, or its disk was slow.
    grep -qE '^(load cell|frames|disk) .*NOT READY' "$folder/well.said" ||
        said well '^the virtual rig is ready$'
    said well '^markers +ready +all 7'
    said well '^\| +1 +2 +3 +4 +5 +6 +7$'
    "$wirebench" doctor --json --seconds 0.5 --folder "$folder" "$folder/well/rig.yaml" \
        >"$folder/well.json" 2>/dev/null
    grep -q '"name": "clock"' "$folder/well.json" || fail "no JSON: $(cat "$folder/well.json")"
    grep -q '^ *"verdict": "not known"' "$folder/well.json" ||
        fail "markers are judged without a specimen: $(cat "$folder/well.json")"
    # Nothing was moved: the stage stands where the rig begins.
    look again any "$folder/well/rig.yaml" "$specimen"
    [ "$(grep -E '^stage +ready' "$folder/again.said")" = \
        "$(grep -E '^stage +ready' "$folder/well.said")" ] || fail "the stage was moved"
    finish
}

wrong_files() {
    local own=$folder/files
    begin files
    sed 's/^  unit: .*/  unit: kg/' "$own/rig.yaml" >"$own/unit.yaml"
    look unit 4 "$own/unit.yaml" "$specimen"
    said unit '^unit +NOT READY .*load_cell.unit: kg'
    # A marker that the wire does not have, in the middle of the widest gap.
    sed 's/42.5, 56.7/42.5, 49.6, 56.7/' "$specimen" >"$own/marker.yaml"
    look marker 4 "$own/rig.yaml" "$own/marker.yaml"
    said marker '^markers +NOT READY +7 of 8 markers seen'
    said marker '^\|  +\?$'
    sed 's/^length_mm: 85/length_mm: 88/; s/^markers_mm: .*/markers_mm: [0, 14.7, 29.3, 44, 58.7, 73.3, 88]/' \
        "$specimen" >"$own/length.yaml"
    look length 4 "$own/rig.yaml" "$own/length.yaml"
    said length '^scale +NOT READY .*85\.[0-9] mm long.*88\.0'
    look travel 4 "$own/rig.yaml" "$specimen" --travel-mm 59
    said travel '^travel +NOT READY .*--travel-mm'
    look disk 4 "$own/rig.yaml" "$specimen" --folder "$own/none"
    said disk '^disk +NOT READY .*--folder'
    finish
}

wrong_ports() {
    local own=$folder/ports cell stage
    begin ports
    # As in the file, with their quotes.
    cell=$(sed -n 's/^  address: \("pty:.*"\)$/\1/p' "$own/rig.yaml" | head -1)
    stage=$(sed -n 's/^  address: \("pty:.*"\)$/\1/p' "$own/rig.yaml" | tail -1)
    sed "s|$cell|none|; s|$stage|$cell|; s|none|$stage|" "$own/rig.yaml" >"$own/swapped.yaml"
    look swapped 4 "$own/swapped.yaml" "$specimen"
    said swapped '^load cell +NOT READY .*swapped'
    said swapped '^stage +NOT READY .*swapped'
    sed "s|$cell|serial:/dev/ttyNone,9600,8n1|" "$own/rig.yaml" >"$own/missing.yaml"
    look missing 4 "$own/missing.yaml" "$specimen"
    said missing '^load cell +NOT READY .*does not exist'
    said missing '^stage +ready'
    "$wirebench" doctor --seconds 60 --folder "$folder" "$own/rig.yaml" >/dev/null 2>&1 &
    local other=$! device=${stage#*pty:}
    wait_until "$other" sh -c "ls -l /proc/$other/fd | grep -q '${device%?}\$'"
    look busy 4 "$own/rig.yaml" "$specimen"
    said busy "^stage +NOT READY .*in use by another program \\(wirebench, process $other\\)"
    kill -INT $other
    wait $other
    [ $? = 3 ] || fail "Ctrl-C is not exit code 3"
    finish
}

# Answers to unicast come, frames of the group do not.
wrong_group() {
    local own=$folder/group
    begin group --multicast
    look grouped any "$own/rig.yaml" "$specimen"
    said grouped '^frames .* frames/s'
    sed 's/group=239.255.42.99/group=239.255.42.98/' "$own/rig.yaml" >"$own/other.yaml"
    look other 4 "$own/other.yaml" "$specimen"
    said other '^cameras +NOT READY .*answers but sent no frame.*interface=|^cameras +NOT READY .*answers but sent no frame.*firewall'
    said other '^cameras +note .*239.255.42.99'
    finish
}

# A first rig file from the addresses of a virtual rig; filled in, it is a rig file.
scan() {
    local own=$folder/scan mocap code
    begin scan
    mocap=$(sed -n 's/^  address: "\(udp:.*\)"$/\1/p' "$own/rig.yaml")
    "$wirebench" doctor --scan "pty:$own/load-cell" "pty:$own/stage" "$mocap" -o "$own/first.yaml" \
        >"$folder/scan.said" 2>&1
    code=$?
    [ $code = 0 ] || fail "scan: exit code $code: $(cat "$folder/scan.said" "$own/first.yaml")"
    grep -q "^  address: \"pty:$own/load-cell,[0-9]*,8n1\"\$" "$own/first.yaml" &&
        grep -q "^  address: \"pty:$own/stage,115200,8n1\"\$" "$own/first.yaml" &&
        grep -q "^  address: \"$mocap\"\$" "$own/first.yaml" ||
        fail "scan: addresses are wrong: $(cat "$own/first.yaml")"
    look unfilled 1 "$own/first.yaml"
    said unfilled 'first.yaml:[0-9]+: .*FILL IN'
    sed -i 's/up: FILL IN/up: y/; s/axis: FILL IN/axis: X/; s/down: FILL IN/down: +1/
        s/_date: FILL IN/_date: 2026-01-15/; s/FILL IN/60/' "$own/first.yaml"
    look filled any "$own/first.yaml"
    said filled '^cameras +ready'
    said filled '^stage +ready'
    said filled '^zero +ready'
    cp "$own/first.yaml" "$own/copy.yaml"
    "$wirebench" doctor --scan "pty:$own/stage" -o "$own/first.yaml" >"$folder/scan.said" 2>&1
    [ $? = 1 ] && cmp -s "$own/first.yaml" "$own/copy.yaml" || fail "scan: a rig file was overwritten"
    "$wirebench" doctor --scan "pty:$own/stage" -o "$own/part.yaml" >"$folder/scan.said" 2>&1
    [ $? = 3 ] || fail "scan: what is missing is not exit code 3"
    grep -q '^  address: FILL IN' "$own/part.yaml" || fail "scan: $(cat "$own/part.yaml")"
    finish
}

no_file() {
    "$wirebench" doctor "$folder/none.yaml" >/dev/null 2>&1
    [ $? = 1 ] || fail "a rig file that is not there is not exit code 1"
    "$wirebench" doctor >/dev/null 2>&1
    [ $? = 2 ] || fail "no rig file is not exit code 2"
}

cases=(scan well wrong_files wrong_ports wrong_group no_file
    'one_fault loss loss=20 4 ^frames.+NOT.READY.+%.of.the.frames.never.came'
    'one_fault garbage garbage=20 any ^load.cell.+note.+not.understood'
    'one_fault garbled garbage=20 any ^cameras.+note.+refused'
    'one_fault duplicates duplicates=20 any ^frames.+note.+arrive.twice'
    'one_fault reorder reorder=20 any ^frames.+note.+after.the.next.one'
    'one_fault delay delay=150 any ^delay.+note.+later'
    'one_fault drift zero-drift=60 any ^drift.+note.+drifts.by'
    'one_fault clock clock-drift=5000 any ^clock.+note.+(ppm|known.to)'
    'one_fault up wrong-up 4 ^up.axis.+NOT.READY.+set.mocap.up:.z --seed 3')
run_in_lanes 3 "${cases[@]}"
