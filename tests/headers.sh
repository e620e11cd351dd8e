#!/bin/sh
# Every header must compile alone, and included twice in one file, without a warning. The name of its
# include guard must be derived from its path.
# Usage: headers.sh SOURCE_ROOT COMPILER...
set -eu
cd "$1"
shift
flags=$(pkg-config --cflags cairo pangocairo gsl)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bad=0
find base daq fe fixtures analysis live library include cli tests -name '*.h' >"$folder/headers"
# One source file for each header, named after it.
awk -v folder="$folder" '{
    name = $0
    gsub("/", "-", name)
    source = folder "/" name ".c"
    printf "#include \"%s\"\n#include \"%s\"\n", $0, $0 >source
    print "int main(void) { return 0; }" >source
    close(source)
}' "$folder/headers"
# shellcheck disable=SC2086 # the flags are words
find "$folder" -name '*.c' -print0 | xargs -0 -n 50 "$@" -std=c11 -D_GNU_SOURCE -Wall -Wextra -Wpedantic \
    -Werror -I. $flags -fsyntax-only || {
    echo 'a header does not compile alone: the file name in the messages above is its path with - for /'
    bad=1
}
# shellcheck disable=SC2046 # the headers are words
awk '
    FNR == 1 {
        if (guard != "")
            missing()
        guard = FILENAME ~ /^include\// ? "" : "WB_" toupper(FILENAME)
        gsub("[^A-Z0-9]", "_", guard)
        path = FILENAME
    }
    $1 == "#define" && $2 == guard { guard = "" }
    function missing() {
        print path ": expected the guard " guard
        bad = 1
    }
    END {
        if (guard != "")
            missing()
        exit bad
    }' $(cat "$folder/headers") || bad=1
exit $bad
