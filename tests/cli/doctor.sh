#!/bin/bash
# `wirebench doctor` on ports of the operating system, in real time: its exit codes, its JSON, busy and
# missing ports, multicast groups, the scan. What it says of each fault is tested in
# tests/virtual/test_doctor_bench.c.
# Usage: doctor.sh WIREBENCH SOURCE_ROOT
set -u
. "$(dirname "$0")/wait.sh"

wirebench=$(realpath "$1")
root=$2
specimen=$root/fixtures/specimens/type1-L85-1.yaml
# In memory where possible: the disk's speed is judged, too.
folder=$(mktemp -d "$([ -w /dev/shm ] && echo /dev/shm || echo /tmp)/wb-doctor-XXXXXX")
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
    [ $code = "$expected" ] ||
        fail "$name: exit code $code, expected $expected: $(cat "$folder/$name.said")"
}

said() { # NAME WORDS
    grep -qE -- "$2" "$folder/$1.said" || fail "$1: not said: '$2': $(cat "$folder/$1.said")"
}

well() {
    begin well
    look well 0 "$folder/well/rig.yaml" "$specimen"
    said well '^the virtual rig is ready$'
    said well '^markers +ready +all 7'
    said well '^\| +1 +2 +3 +4 +5 +6 +7$'
    "$wirebench" doctor --json --seconds 3 --folder "$folder" "$folder/well/rig.yaml" \
        >"$folder/well.json" 2>/dev/null || fail "well: JSON: exit code $?"
    grep -q '"name": "clock"' "$folder/well.json" || fail "no JSON: $(cat "$folder/well.json")"
    grep -q '^ *"verdict": "not known"' "$folder/well.json" ||
        fail "markers are judged without a specimen: $(cat "$folder/well.json")"
    look travel 4 "$folder/well/rig.yaml" "$specimen" --travel-mm 59
    said travel '^travel +NOT READY .*--travel-mm'
    said travel '^the virtual rig is NOT READY: 1 problem to fix$'
    finish
}

wrong_ports() {
    local own=$folder/ports cell stage
    begin ports
    # As in the file, with their quotes.
    cell=$(sed -n 's/^  address: \("pty:.*"\)$/\1/p' "$own/rig.yaml" | head -1)
    stage=$(sed -n 's/^  address: \("pty:.*"\)$/\1/p' "$own/rig.yaml" | tail -1)
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
    look grouped 0 "$own/rig.yaml" "$specimen"
    said grouped '^frames .* frames/s'
    sed 's/group=239.255.42.99/group=239.255.42.98/' "$own/rig.yaml" >"$own/other.yaml"
    look other 4 "$own/other.yaml" "$specimen"
    said other '^cameras +NOT READY .*replies but sent no frame.*interface=|^cameras +NOT READY .*replies but sent no frame.*firewall'
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
    look filled 0 "$own/first.yaml"
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

run_in_lanes 4 scan well wrong_ports wrong_group no_file
