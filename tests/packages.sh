#!/usr/bin/env bash
# Tests the Debian packages on bare Debian 12 systems that debootstrap makes below FOLDER:
# - two builds of the last commit (different folder, user mask, time zone, language, number of jobs
#   and time) give the same bytes;
# - lintian reports no errors;
# - a build from source computes the same numbers;
# - on a system without a compiler the packages are installed, used, and removed without leftovers;
# - autopkgtest passes.
# Run manually as root; takes half an hour and 5 GB. Usage: tests/packages.sh FOLDER [MIRROR]
# NOCHECK=1 skips the tests in the first build.
set -euo pipefail

folder=${1:?usage: tests/packages.sh FOLDER [MIRROR]}
mirror=${2:-http://deb.debian.org/debian}
source=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=tests/bare-system.sh
. "$source/tests/bare-system.sh"

mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
builder=$folder/builder clean=$folder/builder/srv/clean
make_bare "$folder/pristine" bookworm "$mirror"
[ -f "$builder/.complete" ] || cp -a "$folder/pristine" "$builder"
close_all() {
    [ ! -d "$clean" ] || close_bare "$clean"
    close_bare "$builder"
}
close_all # mounts of an interrupted run
open_bare "$builder"
trap close_all EXIT

commit=$(git -C "$source" rev-parse HEAD)
unpack() { # FOLDER: the last commit, without .git
    rm -rf --one-file-system "${builder:?}$1"
    mkdir -p "$builder$1/wirebench"
    git -C "$source" archive "$commit" | tar -x -C "$builder$1/wirebench"
}

# build FOLDER [VARIABLE=VALUE...]: its packages beside the source.
build() {
    local place=$1
    shift
    unpack "$place"
    inside "$builder" env "$@" sh -c "umask \${MASK:-022}; cd $place/wirebench && dpkg-buildpackage -us -uc" \
        >"$builder$place/log" 2>&1 || { tail -n 40 "$builder$place/log"; exit 1; }
}

echo "=== build"
unpack /home/one
inside "$builder" apt-get update -q
inside "$builder" apt-get install -qy --no-install-recommends build-essential lintian autopkgtest
inside "$builder" sh -c 'cd /home/one/wirebench && apt-get build-dep -qy --no-install-recommends ./'
build /home/one ${NOCHECK:+DEB_BUILD_OPTIONS=nocheck}
build /srv/second/place DEB_BUILD_OPTIONS='nocheck parallel=3' MASK=002 TZ=Asia/Kathmandu LANG=C LC_ALL=C
ls -l "$builder"/home/one/*.deb
for file in "$builder"/home/one/*.deb "$builder"/home/one/*.tar.*; do
    cmp "$file" "$builder/srv/second/place/$(basename "$file")"
done
echo "built twice, with the same bytes"

echo "=== lintian"
inside "$builder" sh -c 'cd /home/one && lintian --allow-root --info --fail-on error *.changes'

echo "=== a source build computes the same"
# Runs the package's program from its build folder. CPU times are printed for information only.
cat >"$builder/home/compare" <<'END'
set -eu
cd /home/source/wirebench
meson setup build -Dtests=disabled -Dmpi=disabled >/dev/null
ninja -C build --quiet
export WIREBENCH_DATA=$PWD
package=/home/one/wirebench/debian/wirebench/usr/bin/wirebench
seconds() { # PROGRAM ARGUMENTS...: prints the CPU time; standard output goes to `out`
    program=$1
    shift
    /usr/bin/env bash -c 'TIMEFORMAT="%U"; time "$@" >out 2>log' - "$program" "$@" 2>&1
}
compare() { # ARGUMENTS...
    of_package='' of_source=''
    for i in 1 2 3; do
        of_package="$of_package $(seconds $package "$@")"
        cp out out.package
        of_source="$of_source $(seconds build/cli/wirebench "$@")"
        test -s out
        cmp out out.package
    done
    echo "$*: the same; CPU seconds of the package$of_package, of the source build$of_source"
}
compare solve cantilever --wire type3 --length-mm 85 --deflection-mm 53 --cycles 20
compare solve wire3d follower-8awg-elastic
compare solve bundle 7-type3 --selective 100 --duration-s 0.02
END
unpack /home/source
inside "$builder" sh /home/compare

echo "=== install, use, remove"
close_bare "$clean"
rm -rf --one-file-system "$clean"
mkdir -p "$builder/srv"
cp -a "$folder/pristine" "$clean"
open_bare "$clean"
cp "$builder"/home/one/*.deb "$clean/root/"
# Their dependencies are installed first: all other files must be gone after the removal.
inside "$clean" apt-get update -q
# shellcheck disable=SC2046 # names are words
needs=$(for deb in "$clean"/root/*.deb; do dpkg-deb -f "$deb" Depends; done | tr ',' '\n' |
    sed 's/|.*//; s/(.*//; s/ //g' | grep -v wirebench | sort -u)
# shellcheck disable=SC2086
inside "$clean" apt-get install -qy --no-install-recommends $needs gcc libc6-dev pkgconf >/dev/null
files() {
    chroot "$clean" find / -xdev -path /tmp -prune -o -path /var/log -prune -o -path /var/cache -prune \
        -o -path /root -prune -o -path /var/lib/apt -prune -o -path /var/lib/dpkg -prune -o -print |
        grep -v __pycache__ | LC_ALL=C sort
}
files >"$folder/before"
inside "$clean" sh -c 'apt-get install -qy --no-install-recommends /root/*.deb'
files >"$folder/installed"
[ "$(comm -13 "$folder/before" "$folder/installed" | wc -l)" -gt 100 ]
version=$(dpkg-parsechangelog -l "$source/debian/changelog" -S Version 2>/dev/null ||
    sed -n '1s/.*(\(.*\)).*/\1/p' "$source/debian/changelog")
[ "$(chroot "$clean" wirebench --version)" = "wirebench ${version%-*} ($version)" ]
for part in round-trip library; do
    cp "$source/debian/tests/$part" "$clean/root/"
    inside "$clean" "/root/$part"
done
# The report uses all shipped recordings, from the installed package.
inside "$clean" sh -c 'cd /tmp && wirebench report fixtures/campaigns/single-wires.yaml -o report && test -s report/report.pdf'
# shellcheck disable=SC2016 # expanded inside the system
inside "$clean" bash -c '. /usr/share/bash-completion/completions/wirebench
    COMP_LINE="wirebench rec" COMP_POINT=13; _wirebench; test "${COMPREPLY[*]}" = "record recover"'
# shellcheck disable=SC2016 # expanded inside the system
inside "$clean" sh -c 'for command in $(wirebench --complete "" | sed -n "s/^\([a-z]*\)\t.*/\1/p"); do
    test -s /usr/share/man/man1/wirebench-$command.1.gz || exit 1; done'
inside "$clean" apt-get purge -qy wirebench libwirebench0 libwirebench-dev python3-wirebench wirebench-examples
files >"$folder/after"
diff "$folder/before" "$folder/after"
echo "installed, used and removed; no files are left"

echo "=== autopkgtest"
inside "$builder" sh -c 'autopkgtest --no-built-binaries /home/one/*.deb /home/one/wirebench -- chroot /srv/clean'
echo "packages: reproducible, free of lintian errors, installed, used, removed"
