#!/bin/bash
# `wirebench record` and `stage` against the virtual rig, as a user meets them: a whole test, and
# everything that goes wrong, each with its message, its exit code and a recording that can be read.
# Usage: record.sh WIREBENCH SOURCE_ROOT [CLOCK_SHIM]
set -u
. "$(dirname "$0")/wait.sh"

wirebench=$(realpath "$1")
root=$2
clock_shim=${3:-}
specimen=$root/fixtures/specimens/type1-L85-1.yaml
folder=$(mktemp -d /tmp/wb-record-XXXXXX)
rigs=()
failures=0

# PROMISE TRIALS OUTCOME: as tests/trials.h does.
count_trials() {
    printf '%s\t%s\t%s\trecord.sh\n' "$1" "$2" "$3" | tee -a "${WIREBENCH_TRIALS:-/dev/null}"
}

end_rig() {
    kill -INT "$1" 2>/dev/null
    wait "$1" 2>/dev/null
}

leave_lane() {
    for rig in "${rigs[@]}"; do
        end_rig "$rig"
    done
}

clean_up() {
    leave_lane
    rm -rf "$folder"
}
trap clean_up EXIT

# 20 s of a rig that runs 20 times faster: a busy machine is not to be taken for a lost stream.
sed 's/stream_lost_s: 1/stream_lost_s: 20/' "$root/fixtures/rigs/paper.yaml" >"$folder/bench.yaml"
# Its way down takes 13 s: time to stop it on its way.
sed 's/speed_mm_s: 1/speed_mm_s: 0.2/' "$folder/bench.yaml" >"$folder/slow.yaml"

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# start_rig NAME [RIG.yaml OPTIONS...]: a virtual rig of its own in $folder/NAME; its process in $rig.
start_rig() {
    "$wirebench" rig "${2:-$folder/bench.yaml}" --specimen "$specimen" \
        --run "$folder/$1" --time-scale 20 "${@:3}" 2>"$folder/$1.log" &
    rig=$!
    rigs+=("$rig")
    wait_until "$rig" grep -qs '^ready' "$folder/$1.log" && return
    fail "$1: the rig is not ready: $(cat "$folder/$1.log")"
    exit 1
}

# record NAME OPTIONS...: records from the rig of that name; its exit code in $code.
record() {
    local name=$1
    shift
    "$wirebench" record "$folder/$name/rig.yaml" --specimen "$specimen" -o "$folder/$name.wbr" \
        "$@" >"$folder/$name.out" 2>"$folder/$name.err" </dev/null
    code=$?
}

ended() { # NAME CODE: the last record's exit code is this one
    [ "$code" = "$2" ] || { [ "$2$code" = 03 ] && lost_samples "$folder/$1.err"; }
}

expect() { # NAME CODE WORDS: the last record's exit code, and what it said
    ended "$1" "$2" || fail "$1: exit code $code, expected $2: $(cat "$folder/$1.err")"
    grep -q -- "$3" "$folder/$1.err" "$folder/$1.out" ||
        fail "$1: '$3' not said: $(cat "$folder/$1.err")"
}

readable() { # NAME KIND: the recording opens and holds an event of that kind
    "$wirebench" export "$folder/$1.wbr" -o "$folder/$1.csv" >"$folder/$1.export" 2>&1 ||
        fail "$1: not exported: $(cat "$folder/$1.export")"
    grep -rqs -- "$2" "$folder/$1.csv" || fail "$1: no event '$2' in the recording"
    for extra in "$folder/$1.wbr-wal" "$folder/$1.wbr-journal"; do
        [ ! -e "$extra" ] || fail "$1: $extra was left behind"
    done
}

wait_for_start() { # NAME PROCESS: until its recording of that name runs
    wait_until "$2" [ -s "$folder/$1.wbr" ] || fail "$1: did not start"
}

# NAME PROCESS: until the stage is well on its way, at a fifth of what a whole test records; a busy
# machine needs seconds for that.
wait_for_motion() {
    wait_until "$2" has_grown "$1" || fail "$1: the test did not get going"
}

has_grown() { # NAME
    [ "$(cat "$folder/$1.wbr" "$folder/$1.wbr-wal" 2>/dev/null | wc -c)" -gt 1500000 ]
}

begin() { # NAME: a recording from the rig of that name, once it runs; its process in $recorder
    "$wirebench" record "$folder/$1/rig.yaml" --specimen "$specimen" -o "$folder/$1.wbr" \
        >"$folder/$1.out" 2>"$folder/$1.err" </dev/null &
    recorder=$!
    wait_for_start "$1" $recorder
}

whole_test() {
    start_rig whole
    record whole --travel-mm 10 --cycles 2 --operator 'A. Tester' --notes 'a note'
    expect whole 0 'virtual rig, 2 cycles'
    readable whole cycle_end
    grep -rqs first_force "$folder/whole.csv" || fail "whole: the first force was not judged"
    "$wirebench" info "$folder/whole.wbr" | grep -q 'settings  *\$1=255 \$10=1' ||
        fail 'whole: info does not show how the stage was set'
    record whole --travel-mm 10
    expect whole 1 'never overwritten'
    end_rig "$rig"
}

ctrl_c() {
    start_rig ctrlc "$folder/slow.yaml"
    begin ctrlc
    wait_for_motion ctrlc $recorder
    kill -INT $recorder
    wait $recorder
    code=$?
    expect ctrlc 3 "stage $folder/ctrlc/rig.yaml release"
    readable ctrlc 'interrupted'
    zero=$(grep -o -e '--zero-mn=[-0-9.]*' "$folder/ctrlc.err" | head -1)
    # The stage stands on hold: a test is refused, a release frees it, and then all is well again.
    mv "$folder/ctrlc.wbr" "$folder/ctrlc-first.wbr"
    record ctrlc --travel-mm 5
    expect ctrlc 1 "stage $folder/ctrlc/rig.yaml release'"
    rm -f "$folder/ctrlc.wbr"
    # Without the cell's zero nobody is told that the specimen is free.
    "$wirebench" stage "$folder/ctrlc/rig.yaml" release >"$folder/release.out" 2>&1
    [ $? = 3 ] && grep -q 'look at the strand' "$folder/release.out" ||
        fail "release without a zero: $(cat "$folder/release.out")"
    "$wirebench" stage "$folder/ctrlc/rig.yaml" release "$zero" >"$folder/release.out" 2>&1 ||
        fail "release: $(cat "$folder/release.out")"
    grep -q 'the specimen is free' "$folder/release.out" ||
        fail "release: $(cat "$folder/release.out")"
    # Downwards: two releases may have used up what the machine can go further up.
    "$wirebench" stage "$folder/ctrlc/rig.yaml" jog 0.5 >"$folder/jog.out" 2>&1 ||
        fail "jog: $(cat "$folder/jog.out")"
    record ctrlc --travel-mm 5
    expect ctrlc 0 'virtual rig, 1 cycle'
    end_rig "$rig"
}

# Ctrl-C while an instrument is waited for: nothing was recorded, and the exit code says so.
ctrl_c_too_early() {
    start_rig early
    sed -i 's|udp:127.0.0.1:[0-9]*|udp:127.0.0.1:9|' "$folder/early/rig.yaml"
    begin early
    sleep 0.5
    kill -INT $recorder
    wait $recorder
    code=$?
    expect early 1 'nothing was recorded'
    [ ! -e "$folder/early.wbr" ] || fail "early: a recording was left behind"
    end_rig "$rig"
}

# A cell that is wired the other way round, and one whose scale is off by ten: the test ends in its
# first millimetres. A scale of ten times too much is refused as noise.
first_force() {
    local change expected name
    for change in 'sign: -1' 'scale: 0.1'; do
        name=force-${change%%:*}
        start_rig "$name"
        sed -i "/sign:/d; /scale:/{/time_scale/!d}; s/^  filter_delay_ms:/  $change\n&/" "$folder/$name/rig.yaml"
        case $change in
        sign*) expected='turn load_cell.sign of the rig file round' ;;
        *) expected='mN per mm of deflection\|reads no force' ;;
        esac
        record "$name"
        expect "$name" 3 "$expected"
        grep -q 'the stage stands at [0-9]*\.[0-9]* mm' "$folder/$name.err" ||
            fail "$name: $(cat "$folder/$name.err")"
        end_rig "$rig"
    done
}

# The wall clock jumps by a day, forward and back, whenever it is read.
wall_clock_jumps() {
    [ -n "$clock_shim" ] || return
    start_rig clock
    # The runtime of a sanitizer wants to be the first of all libraries.
    local runtime
    runtime=$(ldd "$wirebench" | awk '/lib[at]san/ {print $3}')
    WB_CLOCK_SHIM=$folder/jumps LD_PRELOAD="$runtime $clock_shim" "$wirebench" record \
        "$folder/clock/rig.yaml" --specimen "$specimen" -o "$folder/clock.wbr" --travel-mm 10 \
        --cycles 2 >"$folder/clock.out" 2>"$folder/clock.err" </dev/null
    code=$?
    expect clock 0 'virtual rig, 2 cycles, [1-9][0-9]\? s'
    local jumps
    jumps=$(cat "$folder/jumps")
    [ "$jumps" -gt 0 ] || fail 'clock: it never jumped'
    "$wirebench" verify "$folder/clock.wbr" >"$folder/clock.verify" 2>&1 ||
        fail "clock: $(cat "$folder/clock.verify")"
    "$wirebench" align "$folder/clock.wbr" -o "$folder/clock.data" >"$folder/clock.align" 2>&1
    grep -q 'largest deflection' "$folder/clock.align" ||
        grep -q 'stood still' "$folder/clock.err" || fail "clock: $(cat "$folder/clock.align")"
    count_trials 'The wall clock jumps while a test is recorded' "$jumps" \
        'jumps of up to 28 hours: the recording is whole, no stamp moves'
    end_rig "$rig"
}

force_limit() {
    sed 's/force_mN: 275/force_mN: 45/' "$folder/bench.yaml" >"$folder/limit.yaml"
    start_rig limit "$folder/limit.yaml"
    record limit
    expect limit 3 'beyond the force limit of 45.0 mN'
    readable limit 'force limit'
    end_rig "$rig"
}

rig_killed() {
    start_rig killed "$folder/slow.yaml"
    begin killed
    wait_for_motion killed $recorder
    kill -KILL "$rig"
    wait "$rig" 2>/dev/null
    wait $recorder
    code=$?
    expect killed 3 'switch off its power'
    readable killed 'stream_lost'
}

jogs() { # NAME: the stage of that rig jogs, which is refused while it moves
    "$wirebench" stage "$folder/$1/rig.yaml" jog 0.1 >"$folder/$1.out" 2>&1
}

# Nothing can be done any more by a recorder that is killed: the stage comes to rest by itself, on its
# way from -62 mm to -9 mm.
recorder_killed() {
    start_rig alone "$folder/slow.yaml"
    begin alone
    wait_for_motion alone $recorder
    kill -KILL $recorder
    wait $recorder 2>/dev/null
    wait_until "$rig" jogs alone || fail "alone: $(cat "$folder/alone.out")"
    grep -q 'the stage stands at -[1-6][0-9]\.' "$folder/alone.out" ||
        fail "alone: $(cat "$folder/alone.out")"
    "$wirebench" stage "$folder/alone/rig.yaml" release >"$folder/alone.out" 2>&1
    [ $? = 3 ] && grep -q 'no longer changes' "$folder/alone.out" ||
        fail "alone: $(cat "$folder/alone.out")"
    end_rig "$rig"
}

# The same of a Tic, which knows by its command timeout that nobody is there: 1 s, of the host.
tic_recorder_killed() {
    sed 's/protocol: grbl/protocol: tic/; s/axis: X/steps_per_mm: 400/' \
        "$folder/slow.yaml" >"$folder/tic-alone.yaml"
    start_rig tic "$folder/tic-alone.yaml"
    begin tic
    wait_for_motion tic $recorder
    kill -KILL $recorder
    wait $recorder 2>/dev/null
    sleep 2.5
    jogs tic || fail "tic: $(cat "$folder/tic.out")"
    grep -q 'the stage stands at [0-9]' "$folder/tic.out" || fail "tic: $(cat "$folder/tic.out")"
    "$wirebench" stage "$folder/tic/rig.yaml" release >"$folder/tic.out" 2>&1
    [ $? = 3 ] && grep -q 'no longer changes' "$folder/tic.out" ||
        fail "tic: $(cat "$folder/tic.out")"
    "$wirebench" stage "$folder/tic/rig.yaml" home >"$folder/tic.out" 2>&1 ||
        fail "tic: $(cat "$folder/tic.out")"
    end_rig "$rig"
}

tic_whole_test() {
    sed 's/protocol: grbl/protocol: tic/; s/axis: X/steps_per_mm: 400/' "$folder/bench.yaml" \
        >"$folder/tic-whole.yaml"
    start_rig tic-whole "$folder/tic-whole.yaml"
    record tic-whole
    ended tic-whole 0 || fail "tic-whole: exit code $code: $(cat "$folder/tic-whole.err")"
    readable tic-whole 'command timeout 1000 ms'
    end_rig "$rig"
}

# The newest NatNet there is, and a take of the server's own.
newest_natnet() {
    sed 's/^  protocol: natnet/&\n  record_take: true/' "$folder/bench.yaml" >"$folder/take.yaml"
    start_rig take "$folder/take.yaml" --natnet-version 4.4
    record take
    ended take 0 || fail "take: exit code $code: $(cat "$folder/take.err")"
    readable take 'NatNet 4.4'
    for words in 'agrees to stream NatNet 4.1' 'the server records a take of its own'; do
        grep -rqs "$words" "$folder/take.csv" || fail "take: no event '$words'"
    done
    end_rig "$rig"
}

rig_stalls() {
    start_rig stalled "$folder/slow.yaml"
    "$wirebench" record "$folder/stalled/rig.yaml" --specimen "$specimen" \
        -o "$folder/stalled.wbr" >"$folder/stalled.out" 2>"$folder/stalled.err" </dev/null &
    local recorder=$!
    wait_for_motion stalled $recorder
    kill -STOP "$rig"
    wait $recorder
    code=$?
    kill -CONT "$rig"
    expect stalled 3 'has sent no valid sample for'
    readable stalled 'soft reset'
    end_rig "$rig"
}

# The rig falls silent while nobody takes what record says: the stage is stopped all the same.
dead_reader() {
    start_rig dead "$folder/slow.yaml"
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

hung_reader() {
    start_rig hung "$folder/slow.yaml"
    mkfifo "$folder/hung.fifo"
    exec 9<>"$folder/hung.fifo"
    dd if=/dev/zero of="$folder/hung.fifo" bs=4096 count=64 oflag=nonblock 2>/dev/null
    "$wirebench" record "$folder/hung/rig.yaml" --specimen "$specimen" -o "$folder/hung.wbr" \
        >"$folder/hung.out" 2>"$folder/hung.fifo" </dev/null &
    local recorder=$!
    wait_for_motion hung $recorder
    kill -STOP "$rig"
    wait_until $recorder [ ! -e "$folder/hung.wbr-wal" ] # the recording is closed
    readable hung 'soft reset'
    cat <&9 >"$folder/hung.err" &
    local reader=$!
    wait $recorder
    code=$?
    kill -CONT "$rig"
    kill $reader
    wait $reader 2>/dev/null
    exec 9>&-
    [ $code = 3 ] || fail "hung: exit code $code: $(cat "$folder/hung.err")"
    end_rig "$rig"
}

# Ctrl-Z must not halt what watches a moving stage; Ctrl-\ is a Ctrl-C.
keys_of_the_terminal() {
    start_rig keys "$folder/slow.yaml"
    begin keys
    wait_for_motion keys $recorder
    kill -TSTP $recorder
    kill -TTOU $recorder
    kill -TTIN $recorder
    sleep 0.4
    grep -q '^State:.*stopped' "/proc/$recorder/status" && fail "keys: Ctrl-Z halts the recorder"
    kill -CONT $recorder
    kill -QUIT $recorder
    wait $recorder
    code=$?
    expect keys 3 'stopped by the operator'
    readable keys 'interrupted'
    end_rig "$rig"
}

full_disk() {
    start_rig full
    # 3 MiB in blocks of 1024 bytes: the recording grows past it within the test. No SIGXFSZ.
    (
        trap '' XFSZ
        ulimit -f 3072
        exec "$wirebench" record "$folder/full/rig.yaml" --specimen "$specimen" \
            -o "$folder/full.wbr" >"$folder/full.out" 2>"$folder/full.err" </dev/null
    ) &
    local recorder=$!
    # The test goes on in memory, and at its end the tool waits for room, until Ctrl-C.
    wait_until $recorder grep -q 'Ctrl-C gives it up' "$folder/full.err"
    kill -INT $recorder
    wait $recorder
    code=$?
    expect full 3 'the disk takes nothing'
    # It could not be closed properly, so info may say 3, but it reads what was written.
    "$wirebench" info "$folder/full.wbr" >"$folder/full.info" 2>&1
    code=$?
    [ $code = 0 ] || [ $code = 3 ] || fail "full: not readable: $(cat "$folder/full.info")"
    grep -q cycle_start "$folder/full.info" || fail "full: $(cat "$folder/full.info")"
    end_rig "$rig"
}

# The ports, one by one, of a rig that is otherwise well.
bad_ports() {
    start_rig ports
    local good=$folder/ports/rig.yaml
    mkdir "$folder/missing" "$folder/silent" "$folder/unknown" "$folder/unit"

    sed 's|address: "pty:.*"|address: "pty:/dev/pts/no-such"|' "$good" >"$folder/missing/rig.yaml"
    record missing
    expect missing 1 "/dev/pts/no-such"
    [ ! -e "$folder/missing.wbr" ] || fail "missing: a recording was left behind"
    [ "$(wc -l <"$folder/missing.err")" = 1 ] || fail "missing: $(cat "$folder/missing.err")"

    sed 's|udp:127.0.0.1:[0-9]*|udp:127.0.0.1:9|' "$good" >"$folder/silent/rig.yaml"
    record silent
    expect silent 1 'no NatNet answer from udp:127.0.0.1:9'
    [ ! -e "$folder/silent.wbr" ] || fail "silent: a recording was left behind"

    sed 's|^  capacity_g: 20|  capacity_kg: 0.02|' "$good" >"$folder/unknown/rig.yaml"
    record unknown
    expect unknown 1 'capacity_kg'

    sed 's|^  unit: g|  unit: furlong|' "$good" >"$folder/unit/rig.yaml"
    record unit
    expect unit 1 'furlong'

    # A specimen's file that no editor would show whole.
    printf 'wire: type1\0\n' >"$folder/binary.yaml"
    "$wirebench" record "$good" --specimen "$folder/binary.yaml" -o "$folder/binary.wbr" \
        >"$folder/binary.err" 2>&1
    [ $? = 1 ] && grep -q "binary.yaml' is not a text file" "$folder/binary.err" ||
        fail "binary: $(cat "$folder/binary.err")"

    # Busy: a first record holds the ports.
    "$wirebench" record "$good" --specimen "$specimen" -o "$folder/first.wbr" \
        >"$folder/first.out" 2>"$folder/first.err" </dev/null &
    local recorder=$!
    wait_for_start first $recorder
    record ports
    expect ports 1 'use'
    [ ! -e "$folder/ports.wbr" ] || fail "busy: a recording was left behind"
    kill -INT $recorder
    wait $recorder
    end_rig "$rig"
}

# A check of the load cell (nothing hangs: it does not pass) is kept beside the rig file, and the
# next recording tells of it.
cell_check() {
    start_rig checked
    local name=$folder/checked/rig
    echo | "$wirebench" stage "$name.yaml" check 10 --seconds 0.3 >"$folder/check.out" 2>&1
    code=$?
    [ $code = 1 ] || fail "check: exit code $code: $(cat "$folder/check.out")"
    [ "$(wc -l <"$name.checks.csv")" = 2 ] || fail "check: $(cat "$name.checks.csv")"
    record checked --travel-mm 2
    expect checked 0 'did not pass'
    "$wirebench" info "$folder/checked.wbr" >"$folder/checked.info" 2>&1
    grep -q 'cell check .* 10 g read .*NOT PASSED' "$folder/checked.info" ||
        fail "checked: no check in: $(head -20 "$folder/checked.info")"
    "$wirebench" info --json "$folder/checked.wbr" | grep -q '"known_mass_g": 10' ||
        fail "checked: no check in the JSON"
    end_rig "$rig"
}

# Answers check's questions as an operator does: each mass hangs before Enter is pressed.
hang_in_turn() { # LOG FOLDER MASS...
    local log=$1 hung=$2/hung_mass_g asked=0
    shift 2
    for mass; do
        asked=$((asked + 1))
        wait_until $$ has_asked "$log" $asked || return
        echo "$mass" >"$hung.new"
        mv "$hung.new" "$hung"
        echo
    done
}

has_asked() { # LOG TIMES
    [ "$(grep -o 'press Enter' "$1" 2>/dev/null | wc -l)" -ge "$2" ]
}

# check_series NAME HUNG OPTIONS...: masses that hang after the first zero, in one word.
check_series() {
    local name=$1 hung=$2
    shift 2
    : >"$folder/$name.ask"
    # shellcheck disable=SC2086 # one word a mass
    hang_in_turn "$folder/$name.ask" "$folder/$name" $hung |
        "$wirebench" stage "$folder/$name/rig.yaml" check --seconds 0.3 "$@" \
            >"$folder/$name.json" 2>"$folder/$name.ask"
    code=$?
    rm -f "$folder/$name/hung_mass_g"
}

cell_series() {
    sed 's/^  sign: +1/  check_masses_g: [0, 5, 10, 20, 10, 5, 0]\n  check_due_days: 30\n&/' \
        "$folder/bench.yaml" >"$folder/series.yaml"
    start_rig series "$folder/series.yaml"
    record series --travel-mm 2
    expect series 1 'stage .*/series/rig.yaml check'
    check_series series '5 10 20 10 5 0' --json -o "$folder/series.pdf"
    [ $code = 0 ] || fail "series: exit code $code: $(cat "$folder/series.ask")"
    [ "$(grep -c '"known": true' "$folder/series.json")" = 4 ] &&
        [ "$(grep -c '"known_mass_g"' "$folder/series.json")" = 7 ] &&
        [ "$(grep -c '"down": true' "$folder/series.json")" = 3 ] &&
        grep -q '"read_mass_g": \(19.99\|20.00\)' "$folder/series.json" ||
        fail "series: $(cat "$folder/series.json")"
    head -c 5 "$folder/series.pdf" | grep -q '%PDF-' || fail 'series: no certificate'
    if command -v pdftotext >/dev/null; then
        pdftotext -layout "$folder/series.pdf" - | tr -s ' \n' ' ' >"$folder/series.txt"
        for words in 'Certificate' 'virtual rig' 'LC20G-0001' 'relates only to the item tested' \
            'hysteresis' 'not shown by these masses' 'Passed'; do
            grep -q -- "$words" "$folder/series.txt" || fail "certificate: no '$words'"
        done
    fi
    [ "$(wc -l <"$folder/series/rig.checks.csv")" = 2 ] || fail 'series: not one line in the log'
    record series --travel-mm 2
    ended series 0 || fail "series: no test after its check: $(cat "$folder/series.err")"
    # A cell that reads 4 % too little at its upper end.
    check_series series '5 10 19.2 10 5 0' --masses 0,5,10,20,10,5,0
    [ $code = 1 ] || fail "series: exit code $code for a bad cell"
    grep -q 'linearity .*EXCEEDED' "$folder/series.json" || fail "$(cat "$folder/series.json")"
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

cases=(whole_test ctrl_c ctrl_c_too_early first_force wall_clock_jumps force_limit rig_killed
    recorder_killed rig_stalls dead_reader hung_reader keys_of_the_terminal full_disk bad_ports
    cell_check cell_series series_are_refused wrong_usage tic_recorder_killed tic_whole_test newest_natnet)
run_in_lanes 5 "${cases[@]}"
