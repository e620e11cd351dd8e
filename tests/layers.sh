#!/bin/sh
# The layering, read off the includes: base sees nothing of ours; daq and fe see base; the virtual
# rig sees daq and fe; analysis sees base, daq and fe; the cli sees all; nobody sees the cli.
# Foreign libraries stay behind the files that design says. Usage: layers.sh SOURCE_ROOT
set -eu
cd "$1"
bad=0
check() { # FOLDER FORBIDDEN-REGEX
    found=$(grep -rnE "^#include \"($2)" --include='*.[ch]' "$1" || true)
    if [ -n "$found" ]; then
        echo "$1 may not include these:"
        echo "$found" | sed 's/^/    /'
        bad=1
    fi
}
only() { # HEADER ALLOWED-FILES-REGEX
    found=$(grep -rlE "^#include <$1>" --include='*.[ch]' base daq fe fixtures analysis cli |
        grep -vE "^($2)\$" || true)
    if [ -n "$found" ]; then
        echo "<$1> is included outside its file:"
        echo "$found" | sed 's/^/    /'
        bad=1
    fi
}
check base '(daq|fe|fixtures|analysis|cli|tests)/'
check daq '(fe|fixtures|analysis|cli|tests)/'
check fe '(daq|fixtures|analysis|cli|tests)/'
check fixtures '(analysis|cli|tests)/'
check analysis '(fixtures|cli|tests)/'
check cli 'tests/'
only 'libserialport\.h' 'daq/stream_serial\.c'
only 'sqlite3\.h' 'daq/recording[a-z_]*\.[ch]'
only 'zstd\.h' 'daq/recording[a-z_]*\.[ch]'
only 'zlib\.h' 'daq/recording[a-z_]*\.[ch]'
only 'yaml\.h' 'base/config\.c'
only 'jansson\.h' 'base/json\.c'
only 'glib\.h' 'base/hash\.c'
only 'lapacke\.h' 'fe/[a-z]*/[a-z0-9_]*\.c'
only 'mpi\.h' 'fe/team/team_mpi\.c'
only 'cairo.*' 'analysis/(plot|report)/[a-z_/]*\.[ch]'
only 'pango/.*' 'analysis/(plot|report)/[a-z_/]*\.[ch]'
only 'argp\.h' 'cli/[a-z_]*\.[ch]'
# The rooms of fe, lowest first: a file sees its own room and those before it.
rooms='team linear material swept solid model rod trial bundle output'
for folder in fe/*/; do
    case " $rooms " in
    *" $(basename "$folder") "*) ;;
    *)
        echo "$folder has no place in the order of rooms (tests/layers.sh)"
        bad=1
        ;;
    esac
done
# shellcheck disable=SC2086 # the rooms are words
set -- $rooms
while [ $# -gt 1 ]; do
    room=$1
    shift
    check "fe/$room" "fe/($(echo "$*" | tr ' ' '|'))/"
done
# One file, one noun: a subject that needs 900 lines keeps them, none needs more than 1200.
long=$(find base daq fe fixtures analysis cli -name '*.[ch]' -exec wc -l {} + |
    awk '$2 != "total" && $1 > 1200')
if [ -n "$long" ]; then
    echo "longer than 1200 lines:"
    echo "$long"
    bad=1
fi
exit $bad
