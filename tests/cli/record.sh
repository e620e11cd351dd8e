#!/bin/bash
# `wirebench record` over real ports against a rig that is a process of its own: one whole test, and
# what only the operating system does: processes that are killed or stopped, readers of stderr that
# are dead or hang, a terminal. All else is in test_record_virtual.c.
# Usage: record.sh WIREBENCH SOURCE_ROOT
set -u
. "$(dirname "$0")/wait.sh"

wirebench=$(realpath "$1")
root=$2
specimen=$root/fixtures/specimens/type1-L85-1.yaml
folder=$(mktemp -d /tmp/wb-record-XXXXXX)
rigs=()
failures=0

end_rig() {
    kill -INT "$1" 2>/dev/null
    wait "$1" 2>/dev/null
}

leave_lane() {
    for rig in "${rigs[@]}"; do
        end_rig "$rig"
    done
}

trap 'leave_lane; rm -rf "$folder"' EXIT

# The recorder waits 5 s for a stream: a busy machine is not to be taken for a lost one.
sed 's/stream_lost_s: 1/stream_lost_s: 5/' "$root/fixtures/rigs/paper.yaml" >"$folder/bench.yaml"
sed 's/protocol: grbl/protocol: tic/; s/axis: X/steps_per_mm: 400/' "$folder/bench.yaml" >"$folder/tic.yaml"

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# start_rig NAME [RIG.yaml]: a virtual rig of its own in $folder/NAME; its process in $rig.
start_rig() {
    "$wirebench" rig "${2:-$folder/bench.yaml}" --specimen "$specimen" --run "$folder/$1" \
        2>"$folder/$1.log" &
    rig=$!
    rigs+=("$rig")
    wait_until "$rig" grep -qs '^ready' "$folder/$1.log" && return
    fail "$1: the rig is not ready: $(cat "$folder/$1.log")"
    exit 1
}

# begin NAME OPTIONS...: a recording from the rig of that name; its process in $recorder
begin() {
    "$wirebench" record "$folder/$1/rig.yaml" --specimen "$specimen" -o "$folder/$1.wbr" "${@:2}" \
        >"$folder/$1.out" 2>"$folder/$1.err" </dev/null &
    recorder=$!
}

wait_for_motion() { # NAME PROCESS
    wait_until "$2" grep -qsa cycle_start "$folder/$1.wbr" "$folder/$1.wbr-wal" ||
        fail "$1: the test did not get going: $(cat "$folder/$1.err")"
}

finish() { # NAME CODE WORDS: the recorder ends so, and said so
    wait "$recorder"
    code=$?
    [ $code = "$2" ] || fail "$1: exit code $code, expected $2: $(cat "$folder/$1.err")"
    grep -q -- "$3" "$folder/$1.err" "$folder/$1.out" || fail "$1: '$3' not said: $(cat "$folder/$1.err")"
}

readable() { # NAME KIND: the recording opens and holds an event of that kind
    "$wirebench" export "$folder/$1.wbr" -o "$folder/$1.csv" >"$folder/$1.export" 2>&1 ||
        fail "$1: not exported: $(cat "$folder/$1.export")"
    grep -rqs -- "$2" "$folder/$1.csv" || fail "$1: no event '$2' in the recording"
    for extra in "$folder/$1.wbr-wal" "$folder/$1.wbr-journal"; do
        [ ! -e "$extra" ] || fail "$1: $extra was left behind"
    done
}

whole_test() {
    start_rig whole
    begin whole --travel-mm 5
    # Its ports are busy for others meanwhile.
    wait_until $recorder [ -s "$folder/whole.wbr" ] || fail 'whole: did not start'
    "$wirebench" record "$folder/whole/rig.yaml" --specimen "$specimen" -o "$folder/busy.wbr" \
        >"$folder/busy.err" 2>&1 </dev/null
    code=$?
    [ $code = 1 ] && grep -q 'use' "$folder/busy.err" || fail "busy: $code, $(cat "$folder/busy.err")"
    [ ! -e "$folder/busy.wbr" ] || fail 'busy: a recording was left behind'
    finish whole 0 'virtual rig, 1 cycle'
    readable whole cycle_end
    grep -rqs first_force "$folder/whole.csv" || fail 'whole: the first force was not judged'
    end_rig "$rig"
}

# Ctrl-C is a signal of the terminal.
interrupted() {
    start_rig ctrlc
    begin ctrlc
    # Advice on the release comes once the stage is away from its start.
    wait_until $recorder grep -qsa first_motion "$folder/ctrlc.wbr" "$folder/ctrlc.wbr-wal" ||
        fail "ctrlc: the stage did not move: $(cat "$folder/ctrlc.err")"
    kill -INT $recorder
    finish ctrlc 3 "stage $folder/ctrlc/rig.yaml release"
    readable ctrlc interrupted
    end_rig "$rig"
}

rig_killed() {
    start_rig killed
    begin killed
    wait_for_motion killed $recorder
    kill -KILL "$rig"
    wait "$rig" 2>/dev/null
    finish killed 3 'switch off its power'
    readable killed stream_lost
}

jogs() { # NAME: the stage of that rig jogs, which is refused while it moves
    "$wirebench" stage "$folder/$1/rig.yaml" jog 0.1 >"$folder/$1.out" 2>&1
}

# Nothing can be done any more by a recorder that is killed: the stage comes to rest by itself, on its
# way from -62 mm to -9 mm. A Tic, which begins at 0, by its command timeout.
recorder_killed() { # NAME RIG.yaml POSITION
    start_rig "$1" "$folder/$2"
    begin "$1"
    wait_for_motion "$1" $recorder
    kill -KILL $recorder
    wait $recorder 2>/dev/null
    wait_until "$rig" jogs "$1" || fail "$1: $(cat "$folder/$1.out")"
    grep -q "the stage stands at $3\." "$folder/$1.out" || fail "$1: $(cat "$folder/$1.out")"
    "$wirebench" stage "$folder/$1/rig.yaml" release >"$folder/$1.out" 2>&1
    code=$?
    [ $code = 3 ] && grep -q 'no longer changes' "$folder/$1.out" || fail "$1: $(cat "$folder/$1.out")"
    "$wirebench" recover "$folder/$1.wbr" -o "$folder/$1-recovered.wbr" >"$folder/$1.out" 2>&1
    code=$?
    [ $code = 3 ] && grep -q 'missing: .*the end' "$folder/$1.out" || fail "$1: recover: $(cat "$folder/$1.out")"
    mv "$folder/$1-recovered.wbr" "$folder/$1.wbr"
    rm -f "$folder/$1.wbr-wal" "$folder/$1.wbr-shm"
    readable "$1" cycle_start
    end_rig "$rig"
}

rig_stalls() {
    start_rig stalled
    begin stalled
    wait_for_motion stalled $recorder
    kill -STOP "$rig"
    finish stalled 3 'sent no valid sample for'
    kill -CONT "$rig"
    readable stalled 'soft reset'
    end_rig "$rig"
}

# The rig falls silent while nobody takes what record says: the stage is stopped all the same.
dead_reader() {
    start_rig dead
    (
        "$wirebench" record "$folder/dead/rig.yaml" --specimen "$specimen" -o "$folder/dead.wbr" \
            2>&1 >/dev/null </dev/null
        echo $? >"$folder/dead.code"
    ) | true &
    local recorder=$!
    wait_for_motion dead $$
    kill -STOP "$rig"
    wait $recorder
    wait_until $$ [ -s "$folder/dead.code" ]
    kill -CONT "$rig"
    [ "$(cat "$folder/dead.code")" = 3 ] || fail "dead: exit code $(cat "$folder/dead.code")"
    readable dead 'soft reset'
    end_rig "$rig"
}

# The pipe is full, and nobody reads until the recording is closed.
hung_reader() {
    start_rig hung
    mkfifo "$folder/hung.fifo"
    exec 9<>"$folder/hung.fifo"
    dd if=/dev/zero of="$folder/hung.fifo" bs=4096 count=64 oflag=nonblock 2>/dev/null
    "$wirebench" record "$folder/hung/rig.yaml" --specimen "$specimen" -o "$folder/hung.wbr" \
        >"$folder/hung.out" 2>"$folder/hung.fifo" 9>&- </dev/null &
    recorder=$!
    wait_until $recorder grep -qsa cycle_start "$folder/hung.wbr" "$folder/hung.wbr-wal" ||
        fail 'hung: the test did not get going'
    kill -STOP "$rig"
    wait_until $recorder [ ! -e "$folder/hung.wbr-wal" ] || fail 'hung: the recording is not closed'
    readable hung 'soft reset'
    kill -CONT "$rig"
    exec 8<"$folder/hung.fifo" 9>&- # its end is that of the recorder
    cat <&8 >"$folder/hung.err"
    exec 8<&-
    wait $recorder
    code=$?
    [ $code = 3 ] || fail "hung: exit code $code: $(tr -d '\0' <"$folder/hung.err")"
    end_rig "$rig"
}

series_are_refused() {
    local masses
    for masses in 5,10 0,10 0,10,x 0,5,400 ''; do
        "$wirebench" stage "$folder/bench.yaml" check --masses "$masses" >"$folder/refused" 2>&1
        [ $? = 2 ] || fail "masses '$masses' are not refused: $(cat "$folder/refused")"
    done
    "$wirebench" stage "$folder/bench.yaml" check 10 -o "$folder/x.pdf" >/dev/null 2>&1
    [ $? = 2 ] || fail 'a certificate of one mass is not a usage error'
}

wrong_usage() {
    "$wirebench" record >/dev/null 2>&1
    [ $? = 2 ] || fail "record without a rig is not a usage error"
    "$wirebench" record rig.yaml --cycles 0 --specimen a -o b >/dev/null 2>&1
    [ $? = 2 ] || fail "0 cycles are not a usage error"
    "$wirebench" record a.yaml --specimen "$specimen" -o "$folder/x.wbr.zst" >/dev/null 2>&1
    [ $? = 2 ] || fail "a recording that would not be what its name says is not a usage error"
    "$wirebench" stage rig.yaml fly >/dev/null 2>&1
    [ $? = 2 ] || fail "an unknown action is not a usage error"
}

cases=(whole_test interrupted rig_killed 'recorder_killed alone bench.yaml -[1-6][0-9]'
    'recorder_killed tic tic.yaml [0-9]*' rig_stalls dead_reader hung_reader series_are_refused wrong_usage)
run_in_lanes 4 "${cases[@]}"
