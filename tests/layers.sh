#!/bin/sh
# Checks the layers of docs/developing.md. Includes: base includes only itself; daq and fe also base;
# the virtual rig also daq and fe; analysis base, daq and fe; live views and the library these and
# analysis; the cli all but the library; no layer includes the cli. In daq, fe, analysis, its
# calibration and its report a room includes only the rooms before it. Each foreign library is
# included only in the files listed below. Includes and calls between files must not be circular.
# Usage:
#     layers.sh SOURCE_ROOT [ARCHIVE_OR_FOLDER...]
# where archives and folders contain the object files of the product; without them calls are not
# checked.
set -eu
cd "$1"
shift
objects=$(for place in "$@"; do [ -d "$place" ] && ls "$place"/*.c.o || echo "$place"; done)
bad=0
complain() { # TITLE LINES
    [ -z "$2" ] && return
    echo "$1"
    echo "$2" | sed 's/^/    /'
    bad=1
}
check() { # FOLDER FORBIDDEN-REGEX
    complain "$1 may not include these:" \
        "$(grep -rnE "^#include \"($2)" --include='*.[ch]' "$1" || true)"
}
only() { # HEADER ALLOWED-FILES-REGEX
    complain "<$1> is included outside its files:" \
        "$(grep -rlE "^#include <$1>" --include='*.[ch]' base daq fe fixtures analysis live library include cli |
            grep -vE "^($2)\$" || true)"
}
check base '(daq|fe|fixtures|analysis|live|library|include|cli|tests)/'
check daq '(fe|fixtures|analysis|live|library|include|cli|tests)/'
check fe '(daq|fixtures|analysis|live|library|include|cli|tests)/'
check fixtures '(analysis|live|library|include|cli|tests)/'
check analysis '(fixtures|live|library|include|cli|tests)/'
check live '(fixtures|library|include|cli|tests)/'
check library '(fixtures|live|cli|tests)/'
check include '.*/'
check cli '(library|include|tests)/'
only 'libserialport\.h' 'daq/stream/stream_serial\.c'
only 'sqlite3\.h' 'daq/recording/recording[a-z_]*\.[ch]'
only 'zstd\.h' 'base/compress\.c|daq/recording/recording[a-z_]*\.[ch]'
only 'zlib\.h' 'daq/recording/recording[a-z_]*\.[ch]'
only 'yaml\.h' 'base/config\.c'
only 'jansson\.h' 'base/json\.c'
only 'glib\.h' 'base/(hash|text_table)\.c'
only 'lapacke\.h' 'fe/[a-z]*/[a-z0-9_]*\.c'
only 'hdf5\.h' 'analysis/dataset/hdf5_file\.c'
only 'mpi\.h' 'fe/team/[a-z_]*mpi\.c'
only 'cairo.*' 'analysis/(plot|report)/[a-z_/]*\.[ch]'
only 'fontconfig/.*' 'analysis/plot/typeset\.c'
only 'pango/.*' 'analysis/(plot|report)/[a-z_/]*\.[ch]'
only 'curses\.h' 'live/live_(screen|terminal)\.c'
only 'microhttpd\.h' 'live/live_page\.c'
only 'argp\.h' 'cli/[a-z_]*\.[ch]'

# Rooms, lowest first: a file may include its own room and the rooms before it.
rooms() { # FOLDER ROOM...
    folder=$1
    shift
    for path in "$folder"/*/; do
        case " $* " in
        *" $(basename "$path") "*) ;;
        *) complain "not listed in the order of rooms (tests/layers.sh):" "$path" ;;
        esac
    done
    while [ $# -gt 1 ]; do
        room=$1
        shift
        check "$folder/$room" "$folder/($(echo "$*" | tr ' ' '|'))/"
    done
}
rooms daq stream protocol take recording acquire test doctor
rooms fe team linear material swept solid model rod trial section bundle harness output
rooms analysis keys dataset align import calibration cards validation plot predict compare harness solve jobs report schema
rooms analysis/calibration law paper cycle three_point constituents properties
rooms analysis/report draw bench wires bundles machines predictions harnesses kinds
# The common files of reports include no kind of report, and no kind includes another kind; only
# kinds/ includes all of them.
complain 'analysis/report may not include a kind of report:' \
    "$(grep -nE '^#include "analysis/report/(draw|bench|wires|bundles|machines|predictions|harnesses|kinds)/' analysis/report/*.[ch])"
check analysis/report/wires 'analysis/report/bench/'
check analysis/report/bundles 'analysis/report/(bench|wires)/'
check analysis/report/machines 'analysis/report/(bench|wires|bundles)/'
check analysis/report/predictions 'analysis/report/(bench|wires|bundles|machines)/'
check analysis/report/harnesses 'analysis/report/(bench|wires|bundles|machines|predictions)/'
check analysis/jobs 'analysis/solve/'

# A file has one subject; a larger file must be split by subject.
complain 'longer than 1200 lines:' \
    "$(find base daq fe fixtures analysis live library include cli -name '*.[ch]' -exec wc -l {} + |
        awk '$2 != "total" && $1 > 1200')"

# Reads pairs "USER USED" from standard input; prints each circle in one line.
circles() {
    tsort 2>&1 >/dev/null | sed -n 's/^tsort: //p' | awk '
        /input contains a loop/ { if (line) print line; line = ""; next }
        { line = line (line ? " -> " : "") $0 }
        END { if (line) print line }'
}
complain 'headers include each other in a circle:' \
    "$(grep -rE '^#include "' --include='*.h' base daq fe fixtures analysis live library include cli |
        sed -n 's/^\([^:]*\):#include "\(.*\)".*/\1 \2/p' | circles)"

# Permitted calls that would close a circle, with the reason.
#     USER USED  # why
allowed=''
# shellcheck disable=SC2086 # the objects are words
[ -z "$objects" ] || complain 'files call each other in a circle (each names a symbol of the next):' \
    "$(nm -A --extern-only $objects | awk -v allowed="$allowed" '
        # "ARCHIVE:FOLDER/TARGET.p/FILE.c.o: ..." or without archive: the object is FOLDER/FILE.
        NF >= 3 {
            object = $1
            sub(/:[0-9a-f]*$/, "", object)
            sub(/^.*:/, "", object)
            sub(/[^\/]*\.p\//, "", object)
            sub(/\.c\.o$/, "", object)
            if ($(NF - 1) == "U")
                uses[object, $NF] = 1
            else
                home[$NF] = object
        }
        END {
            n = split(allowed, pairs, "\n")
            for (i = 1; i <= n; i++) {
                split(pairs[i], words, " ")
                spared[words[1], words[2]] = 1
            }
            for (use in uses) {
                split(use, part, SUBSEP)
                if (part[2] in home && home[part[2]] != part[1] &&
                    !((part[1], home[part[2]]) in spared))
                    print part[1], home[part[2]]
            }
        }' | LC_ALL=C sort -u | circles)"
exit $bad
