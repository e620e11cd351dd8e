#!/bin/bash
# What the tools say of a bench with faults: each is switched on by name in the virtual rig.
# Usage: faults.sh WIREBENCH SOURCE_ROOT
set -u
. "$(dirname "$0")/wait.sh"

wirebench=$(realpath "$1")
root=$2
specimen=$root/fixtures/specimens/type1-L85-1.yaml
folder=$(mktemp -d /tmp/wb-faults-XXXXXX)
failures=0
trap 'rm -rf "$folder"' EXIT

# 60 s of a rig that runs 10 times faster: a busy machine is not to be taken for a lost stream.
sed 's/stream_lost_s: 1/stream_lost_s: 60/' "$root/fixtures/rigs/paper.yaml" >"$folder/bench.yaml"

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# run NAME CODE FAULTS OPTIONS...: a test on a rig with these faults; record's exit code. Calls
# $meanwhile, if any, while the rig still stands.
run() {
    local name=$1 expected=$2 faults=$3 rig code
    shift 3
    "$wirebench" rig "$folder/bench.yaml" --specimen "$specimen" --run "$folder/$name" \
        --time-scale 10 --faults "$faults" 2>"$folder/$name.log" &
    rig=$!
    if wait_until "$rig" grep -qs '^ready' "$folder/$name.log"; then
        "$wirebench" record "$folder/$name/rig.yaml" --specimen "$specimen" \
            -o "$folder/$name.wbr" --travel-mm 8 "$@" >"$folder/$name.record" 2>&1 </dev/null
        code=$?
        [ $code = "$expected" ] ||
            { [ $expected$code = 03 ] && ! steady "$name" && lost_samples "$folder/$name.record"; } ||
            fail "$name: record's exit code $code, expected $expected: $(cat "$folder/$name.record")"
    else
        fail "$name: not ready: $(cat "$folder/$name.log")"
    fi
    ${meanwhile:-true}
    cp "$folder/$name/rig.yaml" "$folder/$name.yaml"
    kill -INT "$rig" 2>/dev/null
    wait "$rig" 2>/dev/null
    "$wirebench" verify "$folder/$name.wbr" >"$folder/$name.verify" 2>&1
    "$wirebench" align "$folder/$name.wbr" -o "$folder/$name.data" >"$folder/$name.align" 2>&1
}

said() { # NAME COMMAND WORDS: the command said so of that test
    grep -q -- "$3" "$folder/$1.$2" || fail "$1: $2 does not say '$3': $(cat "$folder/$1.$2")"
}

# Whether the machine let the recorder work: what it misses while it stands still is not the
# fault's.
steady() { # NAME
    ! grep -q 'stood still' "$folder/$1.record"
}

loss() {
    run loss 3 loss=20,duplicates=5,reorder=5
    said loss record '% of what the mocap sent never came'
    said loss verify '% of its frames never came'
    said loss align '% of the frames never came'
    ! steady loss || said loss align 'largest deflection'
}

# What arrives late, twice or in another order costs nothing that was measured.
late() {
    run late 0 duplicates=20,delay=100,clock-drift=500
    steady late || return
    said late align 'largest deflection'
    grep -q 'never came' "$folder/late.record" "$folder/late.align" &&
        fail "late: frames are said to be lost: $(cat "$folder/late.align")"
}

# Frames of another order are all there, also those still on their way at the end.
disorder() {
    run disorder 0 duplicates=10,reorder=20
    steady disorder || return
    said disorder align 'largest deflection'
    grep -q 'never came' "$folder/disorder".{record,align,verify} &&
        fail "disorder: frames are said to be lost: $(cat "$folder/disorder.align")"
}

garbage() {
    run garbage 0 garbage=10
    said garbage record 'datagram of 200 bytes .* refused .*mocap.address'
    said garbage record 'not understood.*load_cell.address'
    said garbage verify 'not understood'
    ! steady garbage || said garbage align 'largest deflection'
}

wrong_up() {
    run up 3 wrong-up
    said up record 'set mocap.up'
    said up align 'mocap.up'
    [ ! -e "$folder/up.data/force_deflection.csv" ] || fail "up: a dataset was made of it"
    # The recording is not lost: a corrected rig file holds in place of its own.
    sed -i 's/^  up: y/  up: z/' "$folder/up.yaml"
    "$wirebench" align "$folder/up.wbr" --rig "$folder/up.yaml" -o "$folder/up.data" \
        >"$folder/up.align" 2>&1
    ! steady up || said up align 'largest deflection'
}

clock_restart() {
    run clock 0 clock-restart=4
    ! steady clock || said clock align 'clock broke 1 time'
    ! steady clock || said clock record "server's clock went back"
}

# A clamp that jams leaves a bent wire and a level reading: whoever frees it is not told that it is free.
release_of_a_jammed_clamp() {
    local zero option
    zero=$(grep -o -e '--zero-mn=[-0-9.]*' "$folder/stuck.record" | head -1)
    [ -n "$zero" ] || fail "stuck: record does not say the cell's zero: $(cat "$folder/stuck.record")"
    for option in $zero ''; do
        "$wirebench" stage "$folder/stuck/rig.yaml" release $option >"$folder/stuck.release" 2>&1
        [ $? = 3 ] || fail "stuck: release $option: $(cat "$folder/stuck.release")"
        said stuck release 'before you touch the specimen'
        ! grep -q 'specimen is free$' "$folder/stuck.release" || fail 'stuck: free'
    done
}

stuck_stage() {
    meanwhile=release_of_a_jammed_clamp run stuck 3 stuck-stage=15 --travel-mm 40
    said stuck record 'the cameras see the clamp at 1[45]\.[0-9] mm: does it jam'
    ! steady stuck || said stuck align 'lost steps'
}

unit_change() {
    run unit 3 unit-change=4
    said unit record 'unit changed from g to oz'
    said unit record 'set the unit back'
}

unplugged() { # cell|stage WORDS
    run "$1" 3 "unplug-$1=4"
    said "$1" record "$2"
    said "$1" verify 'a stream fell silent'
}

replugged() {
    run back 0 replug-cell=4
    said back record "the load cell's port came back after"
    said back align "the load cell's port came back after"
    said back verify 'a stream fell silent 1 time'
}

broken() {
    run broken 3 strand-break=6 --travel-mm 30
    said broken record 'the force fell from .* while the wire was bent further'
    said broken align 'the test was cut short: limit: the force fell'
}

# A cable of the network says nothing when it comes out: 6 s of the host are waited for.
unplugged_mocap() {
    run mocap 3 unplug-mocap=4 --travel-mm 50
    said mocap record 'has sent no valid sample for'
}

# The manual's table has every fault, by the names of the message that refuses another.
documented() {
    "$wirebench" rig "$folder/bench.yaml" --specimen "$specimen" --run "$folder/none" \
        --faults none 2>"$folder/names"
    [ $? = 1 ] || fail "a fault of no name was not refused"
    local names
    names=$(sed 's/.*expected some of //; s/,//g' "$folder/names")
    [ "$(wc -w <<<"$names")" -gt 10 ] || fail "no names: $(cat "$folder/names")"
    for name in $names; do
        grep -q "^| \`$name\` |" "$root/docs/manual.md" || fail "docs/manual.md lacks $name"
    done
}

cases=(unplugged_mocap loss late disorder garbage wrong_up clock_restart stuck_stage unit_change replugged broken
    'unplugged cell load.cell.s.port.*went.away' 'unplugged stage switch.off.its.power' documented)
run_in_lanes 3 "${cases[@]}"
