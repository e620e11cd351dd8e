#!/bin/sh
# What a file exports, another file of the product uses. What only tests need is declared in a
# header whose name ends in _private.h, so that nobody takes it for an interface; what nobody needs
# is static or gone. Usage: exports.sh SOURCE_ROOT ARCHIVE_OR_FOLDER...
# where archives and folders hold the objects of the product.
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
    if ! grep -rqw --include='*.[ch]' "$symbol" tests; then
        echo "$symbol is exported and used by no other file, nor by a test"
        bad=1
    # shellcheck disable=SC2086 # the files are words
    elif [ -z "$private" ] || ! grep -qw "$symbol" $private; then
        echo "$symbol is used by tests only: declare it in a _private.h"
        bad=1
    fi
done
exit $bad
