#!/bin/bash
# Live views of `wirebench record` on terminals and ports of the operating system, in real time: a
# view that dies or hangs, a terminal that hangs up, is slow or changes its size, the keys. The
# terminal is left as it was. `script` gives each recorder a terminal. What a view shows is tested in
# test_live_bench.c.
# Usage: views.sh WIREBENCH SOURCE_ROOT SLOW_TERMINAL
set -u
. "$(dirname "$0")/../cli/wait.sh"

wirebench=$(realpath "$1")
root=$2
slow_terminal=$3
terminal_bytes_per_s=
wait_interval_s=0.1
specimen=$root/fixtures/specimens/type1-L85-1.yaml
folder=$(mktemp -d /tmp/wb-views-XXXXXX)
failures=0
rigs=()
trap 'rm -rf "$folder"' EXIT
sed 's/stream_lost_s: 1/stream_lost_s: 20/' "$root/fixtures/rigs/paper.yaml" >"$folder/bench.yaml"

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

end_rig() {
    kill -INT "$1" 2>/dev/null
    wait "$1" 2>/dev/null
}

start_rig() { # NAME: a virtual rig of its own in $folder/NAME; its process in $rig
    "$wirebench" rig "$folder/bench.yaml" --specimen "$specimen" --run "$folder/$1" --seed 7 \
        2>"$folder/$1.log" &
    rig=$!
    rigs+=("$rig")
    wait_until "$rig" grep -qs '^ready' "$folder/$1.log" && return
    fail "$1: the rig is not ready: $(cat "$folder/$1.log")"
    exit 1
}

# NAME LOCALE OPTIONS...: records in a terminal of 110 x 40, whose keys are what is written to
# descriptor 8. `script` in $script, the recorder in $recorder, its view in $view. A hangup means what
# it does in a terminal, also where these tests run under nohup.
begin() {
    local name=$1 locale=$2
    shift 2
    cat >"$folder/$name.sh" <<END
stty rows 40 columns 110
stty -g >"$folder/$name.before"
sh -c 'echo \$\$ >"$folder/$name.pid"; exec env --default-signal=HUP "\$@"' sh \
    "$wirebench" record \
    "$folder/$name/rig.yaml" --specimen "$specimen" -o "$folder/$name.wbr" $* >"$folder/$name.out"
echo \$? >"$folder/$name.code"
stty -g >"$folder/$name.after"
END
    mkfifo "$folder/$name.keys"
    exec 8<>"$folder/$name.keys"
    local terminal=(script -qec "sh $folder/$name.sh" /dev/null)
    [ -z "$terminal_bytes_per_s" ] ||
        terminal=("$slow_terminal" "$terminal_bytes_per_s" sh "$folder/$name.sh")
    TERM=xterm LC_ALL=$locale "${terminal[@]}" \
        <"$folder/$name.keys" >"$folder/$name.screen" 2>&1 &
    script=$!
    wait_until $script [ -s "$folder/$name.pid" ] || fail "$name: no recorder"
    recorder=$(cat "$folder/$name.pid")
    wait_until "$script" has_view || fail "$name: no view: $(cat "$folder/$name.screen")"
    view=$(cut -d ' ' -f 1 "/proc/$recorder/task/$recorder/children")
}

has_view() {
    [ -n "$(cat "/proc/$recorder/task/$recorder/children" 2>/dev/null)" ]
}

wait_for_motion() { # NAME: the stage is on its way down
    wait_until "$script" has_event "$1" first_motion || fail "$1: the test did not get going"
}

has_event() { # NAME WORDS: in the recording as far as it is written
    grep -qa -- "$2" "$folder/$1.wbr" "$folder/$1.wbr-wal" 2>/dev/null
}

# NAME CODE: the recorder ended so, and left the terminal as it found it.
finish() {
    local code
    wait $script
    code=$(cat "$folder/$1.code" 2>/dev/null)
    [ "$code" = "$2" ] || fail "$1: exit code '$code', expected $2: $(tail -c 600 "$folder/$1.screen")"
    cmp -s "$folder/$1.before" "$folder/$1.after" || fail "$1: the terminal is not as it was"
    LC_ALL=C grep -qaF $'\033[?1049l' "$folder/$1.screen" || fail "$1: the usual screen is not back"
    exec 8>&-
}

said() { # NAME WORDS
    grep -qaF -- "$2" "$folder/$1.screen" "$folder/$1.out" || fail "$1: '$2' was not said"
}

# NAME WORDS: on the usual screen, where it stays: the view may have been too late to draw at all. In
# bytes, because a character of a screen that was given up may be there in part.
said_at_the_end() {
    tr -d '\n' <"$folder/$1.screen" | LC_ALL=C sed 's/.*\[?1049h.*\[?1049l//' >"$folder/$1.end"
    grep -qa '\[?1049h' "$folder/$1.end" && fail "$1: the usual screen is not back"
    grep -qaF -- "$2" "$folder/$1.end" || fail "$1: '$2' not at the end: $(tail -c 600 "$folder/$1.screen")"
}

intact() { # NAME: every byte is there
    "$wirebench" verify "$folder/$1.wbr" >"$folder/$1.verify" 2>&1 ||
        fail "$1: $(cat "$folder/$1.verify")"
}

whole() { # NAME: and the test is complete
    intact "$1"
    "$wirebench" align "$folder/$1.wbr" -o "$folder/$1.data" >"$folder/$1.align" 2>&1 ||
        fail "$1: $(cat "$folder/$1.align")"
    "$wirebench" quicklook --json "$folder/$1.wbr" -o "$folder/$1.look" >"$folder/$1.json" 2>&1
    grep -q '"largest_force_N": [0-9.]' "$folder/$1.json" || fail "$1: no curve: $(cat "$folder/$1.json")"
}

# NAME LOCALE OPTIONS...: a test that is held by its view's key, after a mark by another.
begin_held() {
    local name=$1
    start_rig "$name"
    begin "$@"
    wait_for_motion "$name"
    printf m >&8
    wait_until "$script" has_event "$name" 'key m' || fail "$name: no mark in the recording"
    printf h >&8
    wait_until "$script" grep -qa 'held at' "$folder/$name.screen" || fail "$name: not held"
}

has_hold() { # NAME HOW: the recording tells of one hold, and how it ended
    "$wirebench" export "$folder/$1.wbr" -o "$folder/$1.csv" >/dev/null 2>&1
    [ "$(grep -rhs hold_start "$folder/$1.csv" | wc -l)" = 1 ] || fail "$1: not one hold"
    grep -rhs hold_end "$folder/$1.csv" | grep -q "$2" || fail "$1: no hold that was $2"
}

# The whole test over real ports.
held() {
    begin_held held C.UTF-8 --live --travel-mm 10
    printf r >&8
    finish held 0
    said held 'virtual rig, 1 cycle'
    said held 'test in progress'
    said held 'VIRTUAL RIG'
    LC_ALL=C grep -qa $'\xe2[\xa0-\xa3]' "$folder/held.screen" || fail 'held: no Braille dots'
    said_at_the_end held 'wirebench: marked'
    said_at_the_end held 'wirebench: resumed'
    said_at_the_end held 'the test was held 1 time'
    whole held
    has_hold held resumed
    grep -q 'held at .* on the way' "$folder/held.align" || fail "held: $(cat "$folder/held.align")"
    ! kill -0 "$view" 2>/dev/null || fail 'held: the view is still there'
}

held_and_stopped() {
    begin_held held_and_stopped C --live
    printf q >&8
    finish held_and_stopped 3
    said held_and_stopped 'stopped by the operator'
    said_at_the_end held_and_stopped 'wirebench: marked'
    ! LC_ALL=C grep -qa $'[\x80-\xff]' "$folder/held_and_stopped.screen" ||
        fail 'held_and_stopped: not plain ASCII'
    has_hold held_and_stopped stopped
}

# The view dies: the line that is shown instead takes the keys.
held_view_killed() {
    begin_held held_view_killed C.UTF-8 --live --travel-mm 5
    kill -s KILL "$view"
    wait_until "$script" grep -qa 'the live view has ended; the recording continues' \
        "$folder/held_view_killed.screen" || fail 'held_view_killed: no line'
    printf r >&8
    finish held_view_killed 0
    whole held_view_killed
    has_hold held_view_killed resumed
}

# The view hangs, and no key arrives any more: nothing moves, and the test ends by itself.
held_view_hangs() {
    begin_held held_view_hangs C.UTF-8 --live --hold-most-s 2
    kill -s STOP "$view"
    printf r >&8
    finish held_view_hangs 3
    said held_view_hangs '--hold-most-s'
    has_hold held_view_hangs stopped
    intact held_view_hangs
    ! kill -0 "$view" 2>/dev/null || fail 'held_view_hangs: the view is still there'
}

# The connection is lost: the terminal is gone, and the test ends in order; with nohup it goes on.
lost() {
    start_rig lost
    begin lost C --live
    wait_for_motion lost
    kill -s HUP "$recorder"
    wait "$script"
    [ "$(cat "$folder/lost.code")" = 3 ] || fail "lost: exit code $(cat "$folder/lost.code")"
    intact lost
}

lost_with_nohup() {
    local name=lost_with_nohup
    start_rig $name
    nohup "$wirebench" record "$folder/$name/rig.yaml" --specimen "$specimen" --live \
        -o "$folder/$name.wbr" --travel-mm 5 </dev/null >"$folder/$name.out" 2>&1 &
    script=$!
    wait_for_motion $name
    kill -s HUP $script
    wait $script || fail "$name: exit code $?: $(cat "$folder/$name.out")"
    grep -q -- '--live needs a terminal' "$folder/$name.out" || fail "$name: $(cat "$folder/$name.out")"
    whole $name
}

# As over a slow connection, from a window whose size changes all the time, down to a single cell.
slow_and_resized() {
    local terminal_bytes_per_s=4000
    begin_held slow C.UTF-8 --live --travel-mm 5
    wait_until "$script" grep -qa 'enlarge the window to see the curve' "$folder/slow.screen" ||
        fail 'slow: not in a small window'
    wait_until "$script" grep -qa 'tension (mN) over deflection (mm)' "$folder/slow.screen" ||
        fail 'slow: not in a large window'
    printf r >&8
    finish slow 0
    said_at_the_end slow 'wirebench: marked'
    whole slow
}

has_shown() { # NAME BYTES
    [ "$(wc -c <"$folder/$1.screen")" -gt "$2" ]
}

# A terminal that takes nothing any more, and comes back after the test: its usual screen is there,
# with what was said. Ctrl-S does not halt the view before.
hung() {
    local shown terminal_bytes_per_s=100000
    begin_held hung C.UTF-8 --live
    shown=$(wc -c <"$folder/hung.screen")
    printf '\023' >&8
    wait_until "$script" has_shown hung $((shown + 20000)) || fail 'hung: Ctrl-S halts the view'
    kill -s USR1 "$script"
    wait_until "$script" grep -qa 'the terminal is full' "$folder/hung.screen" ||
        fail 'hung: the terminal is not full'
    kill -INT "$recorder"
    wait_until "$script" [ -s "$folder/hung.code" ] || fail 'hung: the recorder waits'
    kill -s USR1 "$script"
    finish hung 3
    said_at_the_end hung 'wirebench: marked'
    said_at_the_end hung 'stopped by the operator'
    intact hung
}

# A page that is watched, by somebody who never reads, and killed.
page_killed() {
    local port code
    start_rig page
    "$wirebench" record "$folder/page/rig.yaml" --specimen "$specimen" -o "$folder/page.wbr" \
        --travel-mm 5 --serve 0 </dev/null >"$folder/page.out" 2>"$folder/page.screen" &
    script=$!
    recorder=$script
    wait_until $script grep -qs 'http://127.0.0.1:' "$folder/page.screen" || fail 'page: no address'
    port=$(sed -n 's|.*http://127.0.0.1:\([0-9]*\)/.*|\1|p' "$folder/page.screen")
    exec 7<>"/dev/tcp/127.0.0.1/$port"
    printf 'GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n' >&7
    grep -qm1 'event: plan' <&7 || fail 'page: no events'
    wait_for_motion page
    kill -s KILL "$(cut -d ' ' -f 1 "/proc/$recorder/task/$recorder/children")"
    wait $script
    code=$?
    exec 7>&-
    [ $code = 0 ] || fail "page: exit code $code: $(cat "$folder/page.screen")"
    whole page
}

# The curve at the end, beside no view at all.
figure() {
    local record=("$wirebench" record "$root/fixtures/rigs/paper.yaml" --virtual --specimen
        "$specimen" -o "$folder/figure.wbr" --travel-mm 20)
    : >"$folder/there.svg"
    "${record[@]}" --figure "$folder/there.svg" >"$folder/figure.out" 2>&1
    [ $? = 1 ] && grep -q "there.svg' exists" "$folder/figure.out" ||
        fail "figure: $(cat "$folder/figure.out")"
    "$wirebench" record a.yaml --specimen b.yaml -o c.wbr --figure d.jpg >/dev/null 2>&1
    [ $? = 2 ] || fail 'figure: d.jpg is not a usage error'
    "${record[@]}" --figure "$folder/curve.svg" >"$folder/figure.out" 2>&1 ||
        fail "figure: $(cat "$folder/figure.out")"
    grep -q '<desc>figure.wbr, measured on a virtual rig</desc>' "$folder/curve.svg" ||
        fail 'figure: it does not say that the rig is virtual'
    grep -q 'id="force-deflection' "$folder/curve.svg" || fail 'figure: it is not the curve'
}

# What goes wrong before the test begins is printed on the usual screen, behind the view's.
refused() {
    local code
    sed 's|address: serial:.*|address: pty:/dev/pts/no-such|' "$folder/bench.yaml" >"$folder/refused.yaml"
    TERM=xterm script -qec "stty rows 40 columns 110; '$wirebench' record \
        '$folder/refused.yaml' --specimen '$specimen' -o '$folder/refused.wbr' --live" /dev/null \
        </dev/null >"$folder/refused.screen" 2>&1
    code=$?
    [ $code = 1 ] || fail "refused: exit code $code: $(cat "$folder/refused.screen")"
    said_at_the_end refused '/dev/pts/no-such'
    [ ! -e "$folder/refused.wbr" ] || fail 'refused: a recording was left behind'
}

leave_case() {
    for rig in "${rigs[@]}"; do
        end_rig "$rig"
    done
    rigs=()
}

leave_lane() { # also where a rig could not be started
    leave_case
}

run_in_lanes 5 held slow_and_resized held_view_killed page_killed lost_with_nohup hung \
    held_and_stopped held_view_hangs lost figure refused
