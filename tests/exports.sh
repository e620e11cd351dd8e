#!/bin/sh
# Every exported function must be used by another file of the product. A function that only tests
# call is declared in a header *_private.h, which marks it as not part of the interface; any other
# unused function must be static or removed. Usage: exports.sh SOURCE_ROOT ARCHIVE_OR_FOLDER...
# where archives and folders contain the object files of the product.
set -eu
cd "$1"
shift
objects=$(for place in "$@"; do [ -d "$place" ] && ls "$place"/*.c.o || echo "$place"; done)
# shellcheck disable=SC2086 # the objects are words
alone=$(nm -A --extern-only $objects | awk '
    NF >= 3 && $NF ~ /^wb_/ {
        object = $1
        sub(/:[0-9a-f]*$/, "", object)
        if ($(NF - 1) == "U")
            used[$NF] = 1
        else
            home[$NF] = object
    }
    END {
        for (symbol in home)
            if (!(symbol in used))
                print symbol
    }' | LC_ALL=C sort)
[ -n "$alone" ] || exit 0
private=$(find base daq fe fixtures analysis live library include cli -name '*_private.h')
bad=0
for symbol in $alone; do
    # shellcheck disable=SC2086 # the files are words
    if ! grep -rqw --include='*.[ch]' "$symbol" tests; then
        echo "$symbol is exported but not used by another file or by a test: make it static or remove it"
        bad=1
    elif [ -z "$private" ] || ! grep -qw "$symbol" $private; then
        echo "$symbol is used only by tests: declare it in a header *_private.h"
        bad=1
    fi
done
exit $bad
