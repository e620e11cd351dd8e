# shellcheck shell=bash
# Sourced by .ci/run and tests/nightly.sh in the root of the checkout: timed steps, and the builds
# that both scripts use.

if [ -z "${WIREBENCH_REAL_DATA:-}" ] && [ -d ../shared/data ]; then
    WIREBENCH_REAL_DATA=$(cd ../shared/data && pwd)
fi
export WIREBENCH_REAL_DATA="${WIREBENCH_REAL_DATA:-}"
[ -n "$WIREBENCH_REAL_DATA" ] || unset WIREBENCH_REAL_DATA

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

install_packages() { # PACKAGE...
    local missing=() package
    for package; do
        dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed ||
            missing+=("$package")
    done
    [ ${#missing[@]} -eq 0 ] || {
        apt-get update >/dev/null &&
            DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
                "${missing[@]}" >/dev/null
    }
}

# Sets `cpu_s` to the CPU time of all child processes so far. A command substitution would measure
# its own subshell, which has no children.
measure_cpu() {
    times >"$scratch/times"
    cpu_s=$(awk -F '[ms ]+' 'NR == 2 { printf "%d", 60 * ($1 + $3) + $2 + $4 }' "$scratch/times")
}

steps=() failed=()
# Runs the command and records result and time. The script continues after a failure, so that one
# run shows all failures.
step() { # NAME COMMAND...
    local name=$1 start=$SECONDS result=ok before
    shift
    measure_cpu
    before=$cpu_s
    echo "=== $name"
    "$@" || {
        result=FAILED
        failed+=("$name")
    }
    measure_cpu
    steps+=("$name|$result|$((SECONDS - start))|$((cpu_s - before))")
    echo "=== $name: $result, $((SECONDS - start)) s, $((cpu_s - before)) s of CPU time"
}

print_steps() {
    local row name result seconds cpu
    printf '%-42s %-8s %8s %8s\n' step result seconds 'CPU s'
    for row in "${steps[@]}"; do
        IFS='|' read -r name result seconds cpu <<<"$row"
        printf '%-42s %-8s %8s %8s\n' "$name" "$result" "$seconds" "$cpu"
    done
}

configure() { # FOLDER ARGUMENTS...
    local folder=$1
    shift
    if [ -f "$folder/build.ninja" ]; then
        meson configure "$folder" "$@"
    else
        meson setup "$folder" "$@" >/dev/null
    fi
}

# gcc spends three quarters of the compile time of an instrumented kernel on variable tracking,
# which only debuggers need.
configure_sanitizers() { # FOLDER SANITIZERS [ARGUMENT...]
    local folder=$1 sanitizers=$2
    shift 2
    configure "$folder" --buildtype=plain -Doptimization=1 -Ddebug=true -Dc_args=-fno-var-tracking \
        -Db_sanitize="$sanitizers" -Db_ndebug=false -Dtests=enabled "$@"
}

# Names of the tests of a build folder that `meson test ARGUMENTS` runs.
list_tests() { # FOLDER ARGUMENTS...
    local folder=$1
    shift
    meson test -C "$folder" --list "$@" 2>/dev/null | sed -n 's|^wirebench:[^/]*/ *||p' | sort -u
}

# Prints tests/long.txt without comments.
long_tests() {
    sed '/^#/d' tests/long.txt | LC_ALL=C sort
}

# Prints the failed steps and one line with the counts of all test runs.
print_counts() { # LOG...
    local log passed=0 wrong=0 skipped=0 name
    for log; do
        [ -f "$log" ] || continue
        passed=$((passed + $(grep -c '"result": "OK"' "$log")))
        wrong=$((wrong + $(grep -cE '"result": "(FAIL|TIMEOUT|ERROR|INTERRUPT)"' "$log")))
        skipped=$((skipped + $(grep -c '"result": "SKIP"' "$log")))
    done
    for name in "${failed[@]+"${failed[@]}"}"; do
        echo "FAILED: $name"
    done
    echo "$passed passed, $((wrong + ${#failed[@]})) failed, $skipped skipped"
    [ ${#failed[@]} -eq 0 ]
}
