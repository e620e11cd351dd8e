# Sourced by tests of reports, with WIREBENCH as the first argument.
set -u

wirebench=$(realpath "$1")
folder=$(mktemp -d /tmp/wb-report-XXXXXX)
trap 'rm -rf "$folder"' EXIT
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

run() { # EXPECTED ARGUMENTS...: output in $folder/out and $folder/err
    local expected=$1 code
    shift
    "$wirebench" report "$@" >"$folder/out" 2>"$folder/err"
    code=$?
    [ $code -eq "$expected" ] || {
        fail "report $*: exit code $code, expected $expected"
        cat "$folder/err"
    }
}

ends_with() { # CODE WORDS ARGUMENTS...: output in ./said
    local code=$1 words=$2
    shift 2
    "$wirebench" "$@" >said 2>&1
    local found=$?
    [ $found -eq "$code" ] || fail "$*: exit code $found, expected $code: $(cat said)"
    grep -qF -- "$words" said || fail "$*: '$words' is not said: $(cat said)"
}

finish() { # WHAT; all files in $folder are checked against their schemas
    ${WIREBENCH_CHECK_FILES:-true} -n 0 "$folder" || fail 'a file does not follow its schema'
    [ $failures -eq 0 ] && echo "$1: all good"
    exit $((failures > 0))
}
