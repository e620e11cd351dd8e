#!/bin/bash
# Live views of `wirebench record` against the virtual rig: what happens to a view never happens to
# the recording, and the terminal is left as it was. `script` gives each recorder a terminal.
# Usage: views.sh WIREBENCH SOURCE_ROOT
set -u
. "$(dirname "$0")/../cli/wait.sh"

wirebench=$(realpath "$1")
root=$2
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
        --time-scale 20 2>"$folder/$1.log" &
    rig=$!
    rigs+=("$rig")
    wait_until "$rig" grep -qs '^ready' "$folder/$1.log" && return
    fail "$1: the rig is not ready: $(cat "$folder/$1.log")"
    exit 1
}

# NAME LOCALE OPTIONS...: records in a terminal of 110 x 40, whose keys are what is written to
# descriptor 8. `script` in $script, the recorder in $recorder, its view in $view.
begin() {
    local name=$1 locale=$2
    shift 2
    cat >"$folder/$name.sh" <<END
stty rows 40 columns 110
stty -g >"$folder/$name.before"
sh -c 'echo \$\$ >"$folder/$name.pid"; exec "\$@"' sh "$wirebench" record \
    "$folder/$name/rig.yaml" --specimen "$specimen" -o "$folder/$name.wbr" $* >"$folder/$name.out"
echo \$? >"$folder/$name.code"
stty -g >"$folder/$name.after"
END
    mkfifo "$folder/$name.keys"
    exec 8<>"$folder/$name.keys"
    TERM=xterm LC_ALL=$locale script -qec "sh $folder/$name.sh" /dev/null \
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

wait_for_motion() { # NAME: a fifth of what a whole test records
    wait_until "$script" has_grown "$1" || fail "$1: the test did not get going"
}

has_grown() {
    [ "$(cat "$folder/$1.wbr" "$folder/$1.wbr-wal" 2>/dev/null | wc -c)" -gt 900000 ]
}

# NAME CODE: the recorder ended so, and left the terminal as it found it.
finish() {
    local code
    wait $script
    code=$(cat "$folder/$1.code" 2>/dev/null)
    [ "$code" = "$2" ] || fail "$1: exit code '$code', expected $2: $(tail -c 600 "$folder/$1.screen")"
    cmp -s "$folder/$1.before" "$folder/$1.after" || fail "$1: the terminal is not as it was"
    grep -qF $'\033[?1049l' "$folder/$1.screen" || fail "$1: the usual screen is not back"
    exec 8>&-
}

said() { # NAME WORDS
    grep -qaF -- "$2" "$folder/$1.screen" "$folder/$1.out" || fail "$1: '$2' was not said"
}

# NAME WORDS: on the usual screen, where it stays: the view may have been too late to draw at all.
said_at_the_end() {
    tr -d '\n' <"$folder/$1.screen" | sed 's/.*\[?1049h.*\[?1049l//' >"$folder/$1.end"
    grep -qa '\[?1049h' "$folder/$1.end" && fail "$1: the usual screen is not back"
    grep -qaF -- "$2" "$folder/$1.end" || fail "$1: '$2' not at the end: $(cat "$folder/$1.screen")"
}

whole() { # NAME: every byte is there, and the test is complete
    "$wirebench" verify "$folder/$1.wbr" >"$folder/$1.verify" 2>&1 ||
        fail "$1: $(cat "$folder/$1.verify")"
    "$wirebench" align "$folder/$1.wbr" -o "$folder/$1.data" >"$folder/$1.align" 2>&1
    # At this speed a busy machine loses frames; the largest force is the wire's all the same.
    "$wirebench" quicklook --json "$folder/$1.wbr" -o "$folder/$1.look" >"$folder/$1.json" 2>&1
    sed -n 's/.*"largest_force_N": \([0-9.]*\).*/\1/p' "$folder/$1.json" >"$folder/$1.force"
    [ -s "$folder/$1.force" ] || fail "$1: no curve: $(cat "$folder/$1.json")"
}

same_force() { # NAME NAME: within 3 %, as noise and the time scale allow
    paste "$folder/$1.force" "$folder/$2.force" |
        awk '{ d = $1 / $2 - 1; exit !(d < 0.03 && d > -0.03) }' ||
        fail "$1 and $2: forces $(cat "$folder/$1.force") and $(cat "$folder/$2.force")"
}

one_test() { # NAME SIGNAL: a recording whose view gets that signal; none for ''
    start_rig "$1"
    begin "$1" C.UTF-8 --live --travel-mm 20
    wait_for_motion "$1"
    [ -z "$2" ] || kill -s "$2" "$view"
    finish "$1" 0
    said "$1" 'virtual rig, 1 cycle'
    whole "$1"
    ! kill -0 "$view" 2>/dev/null || fail "$1: the view is still there"
}

undisturbed() {
    one_test undisturbed ''
    said undisturbed 'test in progress'
    said undisturbed 'VIRTUAL RIG'
    LC_ALL=C grep -qa $'\xe2[\xa0-\xa3]' "$folder/undisturbed.screen" || fail 'no Braille dots'
}

killed() {
    one_test killed KILL
    said killed 'the live view has ended; the recording goes on'
}

stopped() {
    one_test stopped STOP
}

keys() {
    start_rig keys
    begin keys C --live
    wait_for_motion keys
    printf m >&8
    wait_until $script grep -qa marked "$folder/keys.screen" || fail 'keys: not marked'
    printf q >&8
    finish keys 3
    said keys 'stopped by the operator'
    said_at_the_end keys 'wirebench: marked'
    ! LC_ALL=C grep -qa $'[\x80-\xff]' "$folder/keys.screen" || fail 'keys: not plain ASCII'
    "$wirebench" export "$folder/keys.wbr" -o "$folder/keys.csv" >/dev/null 2>&1
    grep -rqs 'key m' "$folder/keys.csv" || fail 'keys: no mark in the recording'
}

# A page that is watched, by somebody who never reads, and killed.
page_killed() {
    start_rig page
    "$wirebench" record "$folder/page/rig.yaml" --specimen "$specimen" -o "$folder/page.wbr" \
        --travel-mm 20 --serve 0 </dev/null >"$folder/page.out" 2>"$folder/page.screen" &
    script=$!
    recorder=$script
    wait_until $script grep -qs 'http://127.0.0.1:' "$folder/page.screen" || fail 'page: no address'
    local port
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
    start_rig figure
    : >"$folder/there.svg"
    "$wirebench" record "$folder/figure/rig.yaml" --specimen "$specimen" -o "$folder/figure.wbr" \
        --figure "$folder/there.svg" </dev/null >"$folder/figure.out" 2>&1
    [ $? = 1 ] && grep -q "there.svg' exists" "$folder/figure.out" ||
        fail "figure: $(cat "$folder/figure.out")"
    "$wirebench" record a.yaml --specimen b.yaml -o c.wbr --figure d.jpg >/dev/null 2>&1
    [ $? = 2 ] || fail 'figure: d.jpg is not a usage error'
    "$wirebench" record "$folder/figure/rig.yaml" --specimen "$specimen" -o "$folder/figure.wbr" \
        --travel-mm 20 --figure "$folder/curve.svg" </dev/null >"$folder/figure.out" 2>&1 ||
        fail "figure: $(cat "$folder/figure.out")"
    grep -q '<desc>figure.wbr, measured on a virtual rig</desc>' "$folder/curve.svg" ||
        fail 'figure: it does not say that the rig is virtual'
    grep -q 'id="force-deflection' "$folder/curve.svg" || fail 'figure: it is not the curve'
}

# What goes wrong before the test begins is told on the usual screen, behind the view's.
refused() {
    start_rig refused
    sed -i 's|address: "pty:.*"|address: "pty:/dev/pts/no-such"|' "$folder/refused/rig.yaml"
    TERM=xterm script -qec "stty rows 40 columns 110; '$wirebench' record \
        '$folder/refused/rig.yaml' --specimen '$specimen' -o '$folder/refused.wbr' --live" /dev/null \
        </dev/null >"$folder/refused.screen" 2>&1
    code=$?
    [ $code = 1 ] || fail "refused: exit code $code: $(cat "$folder/refused.screen")"
    said_at_the_end refused '/dev/pts/no-such'
    [ ! -e "$folder/refused.wbr" ] || fail 'refused: a recording was left behind'
}

no_terminal() {
    start_rig none
    "$wirebench" record "$folder/none/rig.yaml" --specimen "$specimen" -o "$folder/none.wbr" \
        --travel-mm 5 --live </dev/null >"$folder/none.screen" 2>&1 ||
        fail "none: $(cat "$folder/none.screen")"
    : >"$folder/none.out"
    said none '--live needs a terminal'
}

cases=(undisturbed killed stopped keys page_killed figure refused no_terminal)
pids=()
for case in "${cases[@]}"; do
    (
        trap 'for rig in "${rigs[@]}"; do end_rig "$rig"; done' EXIT
        "$case"
        exit $failures
    ) &
    pids+=($!)
done
for i in "${!cases[@]}"; do
    if wait "${pids[$i]}"; then
        echo "ok: ${cases[$i]}"
    else
        echo "not ok: ${cases[$i]}"
        failures=$((failures + 1))
    fi
done
[ $failures -gt 0 ] || same_force killed undisturbed
[ $failures -gt 0 ] || same_force stopped undisturbed
[ $failures -gt 0 ] || same_force page undisturbed
exit $((failures > 0))
