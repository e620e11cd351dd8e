#!/bin/sh
# Every header compiles alone, and twice in one file (its guard holds), without a warning. Its guard
# is its path.
# Usage: headers.sh SOURCE_ROOT COMPILER...
set -eu
cd "$1"
shift
flags=$(pkg-config --cflags cairo pangocairo gsl)
bad=0
for header in $(find base daq fe fixtures analysis live library include cli tests -name '*.h' | LC_ALL=C sort); do
    # shellcheck disable=SC2086 # the flags are words
    printf '#include "%s"\n#include "%s"\nint main(void) { return 0; }\n' "$header" "$header" |
        "$@" -x c -std=c11 -D_GNU_SOURCE -Wall -Wextra -Wpedantic -Werror -I. $flags \
            -fsyntax-only - || {
        echo "$header does not compile alone"
        bad=1
    }
    case $header in
    include/*) continue ;;
    esac
    guard=WB_$(echo "$header" | tr 'a-z/.' 'A-Z__')
    grep -q "^#define $guard\$" "$header" || {
        echo "$header: expected the guard $guard"
        bad=1
    }
done
exit $bad
