#!/usr/bin/env bash
# Completion offers what the table of commands and the options' --help have, in bash as it is
# typed; in zsh where there is one. Usage: completion.sh WIREBENCH SOURCE_ROOT
set -eu
tool=$(realpath "$1") scripts=$2/cli/completion
export WIREBENCH_DATA=$2
failed=0
# shellcheck source=/dev/null
. "$scripts/wirebench.bash"

type_line() { # TEXT: what bash offers behind it, sorted
    COMP_LINE="$tool $1" COMP_POINT=$((${#tool} + 1 + ${#1})) COMPREPLY=()
    _wirebench
    printf '%s\n' "${COMPREPLY[@]}" | LC_ALL=C sort
}

expect() { # TEXT EXPECTED: equal, as lists
    local offered expected
    offered=$(type_line "$1") expected=$(printf '%s\n' "$2" | tr ' ' '\n' | LC_ALL=C sort)
    if [ -z "$2" ] || [ "$offered" != "$expected" ]; then
        echo "behind 'wirebench $1':"
        diff <(echo "$expected") <(echo "$offered") | head -20
        failed=1
    fi
}

# Long options of --help; "=" behind those that take a value.
options() {
    "$tool" "$@" --help | grep -oE '^ +(-[a-zA-Z], )?--[a-z][a-zA-Z0-9-]+=?' |
        grep -oE -- '--[a-zA-Z0-9-]+=?' | sort -u
}

commands=$("$tool" --help | awk '/^  [a-z]/ { print $1 }')
[ "$(echo "$commands" | wc -w)" -ge 17 ] || { echo "too few commands in --help"; exit 1; }
expect '' "$commands
--help
--version"
expect 'cali' calibrate
kinds=(cantilever wire3d wire1d bundle bending3p harness)
expect 'solve ' "${kinds[*]}"
expect 'import ' 'force mocap'
for command in $commands; do
    case $command in solve | import) continue ;; esac # of kinds
    expect "$command --" "$(options "$command")"
done
for kind in "${kinds[@]}"; do
    expect "solve $kind --" "$(options solve "$kind")"
done
for kind in force mocap; do
    expect "import $kind --" "$(options import "$kind")"
done
for other in --tensile --constituents --compliance; do
    expect "calibrate $other --" "$(options calibrate "$other")"
done
expect 'export --to mujoco --' "$(options export --to mujoco)"

# Values, joined and apart; '=' splits words in bash, so that only what stands behind it is offered.
expect 'solve cantilever --law=ela' 'elastic elastoplastic'
expect 'solve cantilever --law ' 'elastic elastoplastic'
expect 'calibrate --method=' 'cycle paper'
expect 'import force x --decimal ' 'point comma'
expect 'export type3 --to=t' 'table table-csv'
expect 'stage rig.yaml ' 'home jog unlock release check'
expect 'solve wire3d residual-' 'residual-1-8awg residual-2-8awg'
# Files are left to the shell.
[ -z "$(type_line 'record --specimen ')$(type_line 'info ')$(type_line 'none ')" ] ||
    { echo "something is offered where a file is wanted"; failed=1; }

# zsh in a terminal of its own: what it made of a line is what the command was then run with.
if command -v zsh >/dev/null; then
    place=$(mktemp -d)
    trap 'rm -rf "$place"' EXIT
    cat >"$place/wirebench" <<END
#!/bin/sh
[ "\$1" != --complete ] || exec "$tool" "\$@"
echo "\$@" >"$place/ran.new" && mv "$place/ran.new" "$place/ran"
END
    chmod +x "$place/wirebench"
    cat >"$place/type" <<END
zmodload zsh/zpty
TERM=vt100 zpty shell zsh -f
zpty -w shell "fpath=($scripts \\\$fpath); path=($place \\\$path); autoload -U compinit; compinit -u -d $place/dump"
zpty -w shell "PS1='rea''dy '"
zpty -r -m shell answer '*ready *'
zpty -w shell \$'wirebench calib\t--meth\tpa\t'
zpty -r -m shell answer '*ready *'
END
    timeout 120 zsh -f "$place/type" >"$place/said" 2>&1 || true
    [ "$(cat "$place/ran" 2>/dev/null)" = 'calibrate --method=paper' ] ||
        { echo "zsh completes otherwise:"; cat "$place/said" "$place/ran"; failed=1; }
fi
exit $failed
