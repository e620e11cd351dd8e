#!/bin/sh
# Every symbol that an archive of ours exports begins with wb_, and base, daq, fe, the virtual rig
# and analysis export under their own files' names. Usage: symbols.sh ARCHIVE...
set -eu
bad=0
for archive in "$@"; do
    [ -f "$archive" ] || { echo "no archive $archive"; exit 1; }
    foreign=$(nm --extern-only --defined-only "$archive" 2>/dev/null |
        awk 'NF == 3 && $3 !~ /^wb_/ { print $3 }' | sort -u)
    if [ -n "$foreign" ]; then
        echo "$archive exports names without the prefix wb_:"
        echo "$foreign" | sed 's/^/    /'
        bad=1
    fi
done
exit $bad
