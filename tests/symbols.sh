#!/bin/sh
# Every symbol that one of our archives exports must begin with wb_ and the name of the file that
# defines it, or of the module of this file: recording_read.c exports wb_recording_... or
# wb_recording_read_..., report/figures_measured.c exports wb_figures_.... The table `others` lists
# further prefixes of single files. Usage: symbols.sh ARCHIVE...
set -eu
bad=0
for archive in "$@"; do
    [ -f "$archive" ] || { echo "no archive $archive"; exit 1; }
    # Lines "OBJECT.c.o SYMBOL". An archive without symbols means that the output of nm was not
    # parsed correctly.
    names=$(nm -A --extern-only --defined-only "$archive" 2>/dev/null |
        sed -n -E 's/^[^ ]*[:\/]([^:\/ ]+\.c\.o):[^ ]* [A-Za-z] (.*)$/\1 \2/p')
    [ -n "$names" ] || { echo "$archive exports nothing"; exit 1; }
    foreign=$(echo "$names" | awk '
        BEGIN {
            # Further prefixes of a file: its symbols are the prefix or begin with it.
            others["cycle_parameters"] = "candidate"
            others["driver"] = "outbox role"
            others["grbl_decode"] = "grbl"
            others["interlock"] = "stop"
            others["interrupt"] = "interrupted"
            others["loadcell_line"] = "line"
            others["markers"] = "marker point_cloud"
            others["output"] = "figure"
            others["timing"] = "time"
        }
        function begins(symbol, noun) {
            return symbol == "wb_" noun || index(symbol, "wb_" noun "_") == 1
        }
        function belongs(stem, symbol,    n, i, part, words, nouns) {
            n = split(stem, words, "_")
            part = ""
            for (i = 1; i <= n; i++) {
                part = part (i > 1 ? "_" : "") words[i]
                if (begins(symbol, part))
                    return 1
            }
            n = split(others[stem], nouns, " ")
            for (i = 1; i <= n; i++)
                if (begins(symbol, nouns[i]))
                    return 1
            return 0
        }
        {
            stem = $1
            sub(/\.c\.o$/, "", stem)
            # Meson prefixes the object name with the rooms of its folder.
            found = belongs(stem, $2)
            for (rooms = 1; rooms <= 2 && !found; rooms++) {
                if (!sub(/^(keys|dataset|align|import|calibration|cards|validation|plot|predict|compare|law|paper|cycle|three_point|constituents|properties|stream|protocol|take|recording|acquire|test|doctor)_/, "", stem))
                    break
                found = belongs(stem, $2)
            }
            if (!found)
                print $1 " " $2
        }' | sort -u)
    if [ -n "$foreign" ]; then
        echo "$archive exports names that do not begin with wb_ and the name of their file or module:"
        echo "$foreign" | sed 's/^/    /'
        bad=1
    fi
done
exit $bad
