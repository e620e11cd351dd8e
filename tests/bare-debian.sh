#!/usr/bin/env bash
# Checks that ./bootstrap demo and ./bootstrap test work on a new system: makes a bare Debian with
# debootstrap (release bookworm, Debian 12, by default), clones this checkout into it, and runs each
# command there twice, from different folders. Run manually as root; takes some minutes and 2 GB
# below FOLDER. Usage: tests/bare-debian.sh FOLDER [RELEASE [MIRROR]]
set -euo pipefail

folder=${1:?usage: tests/bare-debian.sh FOLDER [RELEASE [MIRROR]]}
release=${2:-bookworm}
mirror=${3:-http://deb.debian.org/debian}
source=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=tests/bare-system.sh
. "$source/tests/bare-system.sh"

mkdir -p "$folder"
system=$(cd "$folder" && pwd)/$release
make_bare "$system" "$release" "$mirror"
open_bare "$system"
trap 'close_bare "$system"' EXIT

rm -rf "$system/home/newcomer"
mkdir -p "$system/home/newcomer"
git clone --quiet "$source" "$system/home/newcomer/wirebench"

inside "$system" sh -c 'cd / && /home/newcomer/wirebench/bootstrap demo'
inside "$system" sh -c 'cd /tmp && ../home/newcomer/wirebench/bootstrap demo'
inside "$system" sh -c 'cd /home/newcomer/wirebench/demo && test -s report.pdf && test -s report.html &&
    test -s report.json && ls figures/*.svg figures/*.png >/dev/null'
inside "$system" sh -c 'cd /home/newcomer/wirebench && ./bootstrap test'
inside "$system" sh -c 'cd / && /home/newcomer/wirebench/bootstrap test'
# The installed tool must find its shipped files after the source folder has been moved away.
inside "$system" sh -c 'cd /home/newcomer/wirebench && meson install -C build >/dev/null &&
    mv /home/newcomer/wirebench /home/newcomer/away && cd / && wirebench --version &&
    wirebench solve cantilever --wire type3 --length-mm 85 --deflection-mm 53 --points 2 &&
    rm -rf /tmp/report &&
    (wirebench report fixtures/campaigns/single-wires.yaml -o /tmp/report || [ $? -eq 4 ]) &&
    test -s /tmp/report/report.pdf && test -s /usr/local/share/man/man1/wirebench-record.1'
echo "bare Debian $release: demo and test work, twice each"
