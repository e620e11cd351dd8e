#!/usr/bin/env bash
# Proof that ./bootstrap demo and ./bootstrap test are all a newcomer needs: makes a bare Debian 12
# with debootstrap, clones this checkout into it, and runs both there, each twice, from another
# folder. Run by hand as root; takes some minutes and 2 GB below FOLDER.
# Usage: tests/bare-debian.sh FOLDER [MIRROR]
set -euo pipefail

folder=${1:?usage: tests/bare-debian.sh FOLDER [MIRROR]}
mirror=${2:-http://deb.debian.org/debian}
source=$(cd "$(dirname "$0")/.." && pwd)
[ "$(id -u)" -eq 0 ] || { echo "run me as root: debootstrap and chroot need it" >&2; exit 2; }
command -v debootstrap >/dev/null || apt-get install -y --no-install-recommends debootstrap

mkdir -p "$folder"
system=$(cd "$folder" && pwd)/bookworm
if [ ! -f "$system/.complete" ]; then
    debootstrap --variant=minbase bookworm "$system" "$mirror"
    # How this machine reaches its mirror is its own business; the guest does it the same way.
    cp -a /etc/apt/apt.conf.d/. "$system/etc/apt/apt.conf.d/"
    rm -f "$system"/etc/apt/apt.conf.d/{20packagekit,50appstream}
    cp -L /etc/resolv.conf /etc/hosts "$system/etc/" 2>/dev/null || true
    touch "$system/.complete"
fi
for kind in proc sys dev; do
    mountpoint -q "$system/$kind" || mount --rbind "/$kind" "$system/$kind"
done
trap 'for kind in dev sys proc; do umount -R -l "$system/$kind"; done' EXIT

rm -rf "$system/home/newcomer"
mkdir -p "$system/home/newcomer"
git clone --quiet "$source" "$system/home/newcomer/wirebench"

inside() {
    echo "--- $*"
    chroot "$system" /usr/bin/env -i HOME=/root TERM=dumb LANG=C.UTF-8 \
        PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@"
}
inside sh -c 'cd / && /home/newcomer/wirebench/bootstrap demo'
inside sh -c 'cd /tmp && ../home/newcomer/wirebench/bootstrap demo'
inside sh -c 'cd /home/newcomer/wirebench/demo && test -s report.pdf && test -s report.html &&
    test -s report.json && ls figures/*.svg figures/*.png >/dev/null'
inside sh -c 'cd /home/newcomer/wirebench && ./bootstrap test'
inside sh -c 'cd / && /home/newcomer/wirebench/bootstrap test'
# Installed, with the source gone, the tool finds what it ships with.
inside sh -c 'cd /home/newcomer/wirebench && meson install -C build >/dev/null &&
    mv /home/newcomer/wirebench /home/newcomer/away && cd / && wirebench --version &&
    wirebench solve cantilever --wire type3 --length-mm 85 --deflection-mm 53 --points 2 &&
    (wirebench report fixtures/campaigns/single-wires.yaml -o /tmp/report || [ $? -eq 4 ]) &&
    test -s /tmp/report/report.pdf && test -s /usr/local/share/man/man1/wirebench-record.1'
echo "bare Debian: demo and test both work, twice"
