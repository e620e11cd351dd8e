# Sourced by tests that wait for a process of theirs. A busy machine may take its time; only a
# process that is gone, or two minutes, end the wait.

wait_until() { # PROCESS COMMAND...: true once the command succeeds
    local process=$1 alive=yes end=$((SECONDS + 120))
    shift
    until "$@"; do
        # Once more after its end: it may have done its work just before.
        [ $alive = yes ] || return 1
        kill -0 "$process" 2>/dev/null && [ $SECONDS -lt $end ] || alive=no
        sleep 0.02
    done
}
