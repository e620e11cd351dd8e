# Sourced by tests that wait for a process of theirs. A busy machine may take its time; only a
# process that is gone, or two minutes, end the wait.

wait_until() { # PROCESS COMMAND...: true once the command succeeds
    local process=$1 alive=yes end=$((SECONDS + 120))
    shift
    until "$@"; do
        # Once more after its end: it may have done its work just before.
        [ $alive = yes ] || return 1
        kill -0 "$process" 2>/dev/null && [ $SECONDS -lt $end ] || alive=no
        sleep "${wait_interval_s:-0.02}"
    done
}

# run_in_lanes LANES CASE...: the cases side by side in so many lanes, each lane one after the other;
# more virtual rigs at many times their speed would starve each other. A case is a function with its
# arguments, and failed where it counted up `failures`. A case ends with leave_case and a lane with
# leave_lane, if there are such functions.
run_in_lanes() {
    local lanes=$1 lane i before process pids=()
    shift
    local cases=("$@")
    for ((lane = 0; lane < lanes; lane++)); do
        (
            trap - EXIT
            ! declare -F leave_lane >/dev/null || trap leave_lane EXIT
            for ((i = lane; i < ${#cases[@]}; i += lanes)); do
                before=$failures
                # shellcheck disable=SC2086 # a case is words
                ${cases[$i]}
                ! declare -F leave_case >/dev/null || leave_case
                [ $failures = $before ] && echo "ok: ${cases[$i]}" || echo "not ok: ${cases[$i]}"
            done
            [ $failures = 0 ]
        ) &
        pids+=($!)
    done
    for process in "${pids[@]}"; do
        wait "$process" || failures=$((failures + 1))
    done
    [ $failures = 0 ]
}
