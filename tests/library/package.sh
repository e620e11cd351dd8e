#!/bin/bash
# The files of `meson install` in an empty folder suffice for a program that uses only the header and
# pkg-config: it builds, runs, and needs libwirebench.so.0. Usage:
#     package.sh BUILD_ROOT SOURCE_ROOT VERSION COMPILER...
set -eu
build=$1 source=$2 version=$3
shift 3
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
DESTDIR=$place meson install -C "$build" --no-rebuild --quiet
export PKG_CONFIG_PATH=
PKG_CONFIG_PATH=$(dirname "$(find "$place" -name wirebench.pc)")
export PKG_CONFIG_SYSROOT_DIR=$place
[ "$(pkg-config --modversion wirebench)" = "$version" ]
cp "$source"/examples/*.c "$place"
cd "$place"
for example in *.c; do
    # shellcheck disable=SC2046 # the flags are words
    "$@" -std=c11 -Wall -Wextra -Wpedantic -Werror "$example" -o "${example%.c}" \
        $(pkg-config --cflags --libs wirebench) -lm
done
# The header is C90 but for its types, and C++ in C++.
printf '#include <wirebench.h>\nint main() { return wirebench_version() == 0; }\n' >use.cc
if command -v c++ >/dev/null; then
    # shellcheck disable=SC2046 # the flags are words
    c++ -Wall -Wextra -Wpedantic -Werror use.cc -o use $(pkg-config --cflags --libs wirebench)
fi
export LD_LIBRARY_PATH
LD_LIBRARY_PATH=$(dirname "$(find "$place" -name libwirebench.so.0)")
readelf -d solve_cantilever | grep -q 'NEEDED.*\[libwirebench\.so\.0\]'
WIREBENCH_DATA=$(dirname "$(find "$place" -type d -path '*wirebench/fixtures')")
export WIREBENCH_DATA
[ "$(./solve_cantilever type1 0.085 0.05 | wc -l)" = 22 ]
[ ! -e use ] || ./use
# The Python module lies where Debian's Python looks, and finds the library by its soname.
module=$(find "$place" -path '*-packages/wirebench/__init__.py')
if [ -n "$module" ]; then
    packages=$(dirname "$(dirname "$module")")
    /usr/bin/python3 -c "import sys; sys.exit('${packages#"$place"}' not in sys.path)" ||
        { echo "${packages#"$place"} is not in Python's path"; exit 1; }
    if /usr/bin/python3 -c 'import numpy' 2>/dev/null; then
        [ "$(PYTHONPATH=$packages PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c \
            'import wirebench; print(wirebench.version())')" = "$version" ]
    fi
fi
