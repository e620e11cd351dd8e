#!/bin/bash
# `wirebench rig` as a user meets it: ready, its rig file, its end, and what it refuses.
# Usage: rig.sh WIREBENCH SOURCE_ROOT
set -u
. "$(dirname "$0")/wait.sh"

wirebench=$(realpath "$1")
root=$2
rig=$root/fixtures/rigs/paper.yaml
specimen=$root/fixtures/specimens/type1-L85-1.yaml
folder=$(mktemp -d /tmp/wb-rig-XXXXXX)
running=()
failures=0

clean_up() {
    for process in "${running[@]}"; do
        kill -INT "$process" 2>/dev/null
        wait "$process" 2>/dev/null
    done
    rm -rf "$folder"
}
trap clean_up EXIT

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

start() { # NAME OPTIONS...: a rig in $folder/NAME, its process in $process
    local name=$1
    shift
    # An earlier rig of that name was ready, too.
    rm -f "$folder/$name.log"
    "$wirebench" rig "$rig" --specimen "$specimen" --run "$folder/$name/deep" "$@" \
        2>"$folder/$name.log" &
    process=$!
    running+=("$process")
    wait_until "$process" grep -qs '^ready' "$folder/$name.log" && return
    fail "$name: not ready: $(cat "$folder/$name.log")"
    exit 1
}

refused() { # CODE WORDS OPTIONS...: one message with these words, this exit code, no rig file
    local code=$1 words=$2
    shift 2
    timeout 120 "$wirebench" rig "$@" >"$folder/out" 2>"$folder/err"
    local got=$?
    [ $got = "$code" ] || fail "rig $*: exit code $got, expected $code"
    grep -q -- "$words" "$folder/err" || fail "rig $*: '$words' not said: $(cat "$folder/err")"
    [ "$code" = 2 ] || [ "$(grep -c error: "$folder/err")" = 1 ] ||
        fail "rig $*: not one message: $(cat "$folder/err")"
    [ ! -e "$folder/refused/rig.yaml" ] || fail "rig $*: left a rig file"
}

# Two at once, each with ports of its own, and truths that differ.
start one --seed 1
one=$process
start two --seed 2 --natnet-version 4.1 --time-scale 5 --lost-steps 0.8@20 --wire-law mixed
for name in one two; do
    file=$folder/$name/deep/rig.yaml
    grep -q '^name: "virtual rig' "$file" || fail "$name: the name does not say virtual rig"
    grep -q '^virtual: true' "$file" || fail "$name: not marked as virtual"
    grep -q '^    source: virtual rig' "$file" || fail "$name: no truth"
done
grep -q '^time_scale: 5$' "$folder/two/deep/rig.yaml" || fail "two: no time scale"
grep -q 'lost_steps_mm: 0.8$' "$folder/two/deep/rig.yaml" || fail "two: no lost steps"
grep -q 'wire_law: mixed$' "$folder/two/deep/rig.yaml" || fail "two: no law of the wire"
[ "$(cat "$folder"/*/deep/rig.yaml | grep -oE '"(pty|udp):[^"]+"' | sort -u | wc -l)" = 6 ] ||
    fail "ports are shared"
[ "$(cat "$folder"/*/deep/rig.yaml | grep 'bow_mm' | sort -u | wc -l)" = 2 ] ||
    fail "both seeds gave the same wire"

# Its ports have names that stay, and its UDP port is the one that was asked for.
for port in load-cell stage; do
    grep -q "\"pty:$(readlink "$folder/one/deep/$port")\"" "$folder/one/deep/rig.yaml" ||
        fail "one: $port leads to $(readlink "$folder/one/deep/$port")"
done
taken=$(grep -o '127.0.0.1:[0-9]*' "$folder/one/deep/rig.yaml" | cut -d: -f2)
refused 1 "UDP port $taken of 127.0.0.1 cannot be used.*--natnet-port" "$rig" \
    --specimen "$specimen" --run "$folder/refused" --natnet-port "$taken"

# A second one in the same folder is refused with the first one's number, and takes nothing away.
timeout 120 "$wirebench" rig "$rig" --specimen "$specimen" --run "$folder/one/deep" 2>"$folder/err"
[ $? = 1 ] || fail "a second rig in one folder was not refused"
grep -q "process $one)" "$folder/err" || fail "second rig: $(cat "$folder/err")"
[ -e "$folder/one/deep/rig.yaml" ] || fail "the second rig took the first one's file away"

# A lock that a killed rig left behind locks nothing, and another's rig.yaml stays.
start three
kill -KILL "$process"
wait "$process" 2>/dev/null
start three
echo 'name: mine' >"$folder/mine"
mv "$folder/mine" "$folder/three/deep/rig.yaml"
kill -INT "$process"
wait "$process"
grep -q '^name: mine' "$folder/three/deep/rig.yaml" || fail "removed a file that was not its own"
[ ! -e "$folder/three/deep/rig.lock" ] || fail "left its lock"
rm -r "$folder/three"

# It ends with Ctrl-C, and its file with it.
kill -INT "$one"
wait "$one"
code=$?
[ $code = 0 ] || fail "ended with $code"
[ ! -e "$folder/one/deep/rig.yaml" ] || fail "the file outlived its rig"
[ ! -L "$folder/one/deep/stage" ] || fail "a link outlived its rig"
start four --natnet-port "$taken" --multicast --faults loss=5,wrong-up
grep -q "udp:127.0.0.1:$taken,group=239.255.42.99:$taken,interface=127.0.0.1" \
    "$folder/four/deep/rig.yaml" || fail "four: not the port and group that were asked for"
grep -q '^    faults: "loss=5,wrong-up"' "$folder/four/deep/rig.yaml" || fail "four: no faults"
[ "$(grep -c error: "$folder/one.log")" = 0 ] || fail "complained: $(cat "$folder/one.log")"

refused 2 'name a rig file' --specimen "$specimen" --run "$folder/refused"
refused 2 '--specimen SPECIMEN.yaml' "$rig" --run "$folder/refused"
refused 2 '--run DIR' "$rig" --specimen "$specimen"
refused 2 'one rig file at a time' "$rig" "$rig" --specimen "$specimen" --run "$folder/refused"
refused 2 "--wire-law: expected kinematic, isotropic, mixed" "$rig" \
    --specimen "$specimen" --run "$folder/refused" --wire-law rubber
refused 2 'seed' "$rig" --specimen "$specimen" --run "$folder/refused" --seed x
refused 2 'expected M.N, not' "$rig" --specimen "$specimen" --run "$folder/refused" \
    --natnet-version 3
refused 2 'MM@MM' "$rig" --specimen "$specimen" --run "$folder/refused" --lost-steps 3
refused 2 'time-scale' "$rig" --specimen "$specimen" --run "$folder/refused" --time-scale 0
refused 1 'rubber.*expected some of loss' "$rig" --specimen "$specimen" \
    --run "$folder/refused" --faults rubber
refused 1 '2.5 to 4.4' "$rig" --specimen "$specimen" --run "$folder/refused" --natnet-version 4.5
refused 1 'nowhere.yaml' "$folder/nowhere.yaml" --specimen "$specimen" --run "$folder/refused"
refused 1 'nowhere.yaml' "$rig" --specimen "$folder/nowhere.yaml" --run "$folder/refused"
sed 's/^wire: .*/wire: 8awg/' "$specimen" >"$folder/thick.yaml"
refused 1 "wire '8awg'.*wires.yaml" "$rig" --specimen "$folder/thick.yaml" --run "$folder/refused"
echo text >"$folder/file"
refused 1 'file' "$rig" --specimen "$specimen" --run "$folder/file/below"
sed '/^strand:/,/counterweight_g/d' "$rig" >"$folder/no-strand.yaml"
refused 1 'needs a strand' "$folder/no-strand.yaml" --specimen "$specimen" \
    --run "$folder/refused"

[ $failures = 0 ]
