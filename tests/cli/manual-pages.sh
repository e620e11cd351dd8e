#!/bin/sh
# Every command has a manual page that names each of its options, wirebench(1) lists every command,
# and groff has nothing to say about any page. Usage: manual-pages.sh WIREBENCH FOLDER_OF_PAGES
set -eu
tool=$(realpath "$1")
cd "$2"
failed=0
complain() {
    echo "$*"
    failed=1
}

plain() { # PAGE: as it is read, in lines without end, without hyphenation
    groff -t -man -Tascii -P-cbou -rHY=0 -rLL=2000n "$1" 2>/dev/null
}

commands=$("$tool" --help | awk '/^  [a-z]/ { print $1 }')
[ "$(echo "$commands" | wc -w)" -ge 17 ] || { echo "too few commands in --help"; exit 1; }
for command in $commands; do
    page=wirebench-$command.1
    [ -s "$page" ] || { complain "$command has no manual page"; continue; }
    plain wirebench.1 | grep -q "^ *wirebench-$command(1)$" ||
        complain "wirebench(1) does not list $command"
    plain "$page" >page.txt
    summary=$("$tool" --help | sed -n "s/^  $command  *//p")
    grep -qF "wirebench-$command - $summary" page.txt || complain "$page: no line of its NAME"
    for section in NAME SYNOPSIS DESCRIPTION 'EXIT STATUS' 'SEE ALSO'; do
        grep -qx "$section" page.txt || complain "$page has no section $section"
    done
    for option in $("$tool" "$command" --help | grep -oE '^ +(-[a-zA-Z], )?--[a-z][a-zA-Z-]+' |
        grep -oE -- '--[a-zA-Z-]+' | sort -u); do
        case $option in --help | --usage) continue ;; esac
        grep -qE -- "(^|[ ,])$option([=, .]|\$)" page.txt || complain "$page does not have $option"
    done
done
for page in wirebench*.1; do
    said=$(groff -ww -t -man -Tutf8 -z "$page" 2>&1)
    [ -z "$said" ] || complain "$page: $said"
done
rm -f page.txt
exit $failed
