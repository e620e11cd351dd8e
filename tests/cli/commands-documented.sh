#!/bin/sh
# Every command of the tool and every long option of its --help stands in docs/commands.md.
# Usage: commands-documented.sh WIREBENCH SOURCE_ROOT
set -eu
tool=$(realpath "$1")
manual=$2/docs/commands.md
bad=0
commands=$("$tool" --help | awk '/^  [a-z]/ { print $1 }')
[ "$(echo "$commands" | wc -w)" -ge 12 ] || { echo "too few commands in --help"; exit 1; }
check() { # COMMAND [KIND]
    grep -qE "wirebench $*" "$manual" || { echo "'$*' is not documented"; bad=1; }
    for option in $("$tool" "$@" --help | grep -oE '^ +(-[a-z], )?--[a-z][a-z-]+' |
        grep -oE -- '--[a-z-]+' | sort -u); do
        case $option in --help | --usage) continue ;; esac
        grep -qF -- "\`$option" "$manual" || {
            echo "'$* $option' is not documented"
            bad=1
        }
    done
}
for command in $commands; do
    check "$command"
done
# `solve --help` has the options that all kinds share.
for kind in cantilever wire3d wire1d bundle; do
    check solve "$kind"
done
for kind in force mocap; do
    check import "$kind"
done
check export --to mujoco
for other in --tensile --constituents --compliance; do
    check calibrate "$other"
done
exit $bad
