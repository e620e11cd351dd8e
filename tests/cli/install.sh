#!/bin/bash
# What `meson install` puts into an empty place works from there: the version is printed, shipped
# fixtures are found, the manual page is there. Usage: install.sh WIREBENCH BUILD_ROOT PREFIX
set -eu
. "$(dirname "$0")/wait.sh"
tool=$(realpath "$1") build=$2 prefix=$3
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
version=$("$tool" --version)
echo "$version" | grep -qE '^wirebench [0-9]+\.[0-9]+\.[0-9]+ \([0-9a-f.a-z-]+\)$'
DESTDIR=$place meson install -C "$build" --no-rebuild --quiet
cd "$place$prefix"
[ "$(bin/wirebench --version)" = "$version" ]
for file in fixtures/wires/type1.yaml fixtures/specimens/type1-L85-1.yaml fixtures/rigs/paper.yaml \
    fixtures/campaigns/single-wires.yaml fixtures/models/follower-8awg.yaml \
    fixtures/machines/two-rollers.yaml fixtures/virtual/wires.yaml recordings/index.yaml; do
    [ -s "share/wirebench/$file" ] || { echo "$file is not installed"; exit 1; }
done
pages='man/man1/wirebench.1 man/man1/wirebench-solve.1'
[ -e "$build/docs/wirebench.1" ] || pages= # lowdown was not there
for file in bash-completion/completions/wirebench $pages; do
    [ -s "share/$file" ] || { echo "$file is not installed"; exit 1; }
done
[ -s lib/udev/rules.d/60-wirebench.rules ]
[ -z "$(find share/wirebench -name '*.[ch]')" ] || { echo "sources are installed"; exit 1; }
WIREBENCH_DATA=$place$prefix/share/wirebench bin/wirebench solve cantilever --wire type3 \
    --length-mm 85 --deflection-mm 53 --points 2 | grep -q '^cycle,phase,deflection_mm,'

# From any folder the shipped files are found by the names that the manual uses.
export WIREBENCH_DATA=$place$prefix/share/wirebench
cd "$place"
"$place$prefix/bin/wirebench" rig fixtures/rigs/paper.yaml \
    --specimen fixtures/specimens/type1-L85-1.yaml --run run 2>rig.log &
rig=$!
wait_until $rig grep -qsx ready rig.log || { cat rig.log; exit 1; }
! grep -q "$place" run/rig.yaml || { echo "the rig file holds a path of the machine"; exit 1; }
kill -INT $rig
wait $rig
