#!/bin/sh
# What `meson install` puts into an empty place works from there: the version is told, shipped
# fixtures are found, the manual page is there. Usage: install.sh WIREBENCH BUILD_ROOT PREFIX
set -eu
tool=$(realpath "$1") build=$2 prefix=$3
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
version=$("$tool" --version)
echo "$version" | grep -qE '^wirebench [0-9]+\.[0-9]+\.[0-9]+ \([0-9a-f.a-z-]+\)$'
DESTDIR=$place meson install -C "$build" --no-rebuild --quiet
cd "$place$prefix"
[ "$(bin/wirebench --version)" = "$version" ]
for file in fixtures/wires/type1.yaml fixtures/specimens/type1-L85-1.yaml fixtures/rigs/paper.yaml \
    fixtures/campaigns/single-wires.yaml fixtures/virtual/wires.yaml recordings/index.yaml; do
    [ -s "share/wirebench/$file" ] || { echo "$file is not installed"; exit 1; }
done
[ -z "$(find share/wirebench -name '*.[ch]')" ] || { echo "sources are installed"; exit 1; }
WIREBENCH_DATA=$place$prefix/share/wirebench bin/wirebench solve cantilever --wire type3 \
    --length-mm 85 --deflection-mm 53 --points 2 | grep -q '^cycle,phase,deflection_mm,'
