# shellcheck shell=bash
# Sourced by scripts that need a bare Debian; they run as root.

# Makes one in the folder SYSTEM, unless it is there.
make_bare() { # SYSTEM RELEASE MIRROR
    local system=$1 release=$2 mirror=$3
    [ "$(id -u)" -eq 0 ] || { echo "run me as root: debootstrap and chroot need it" >&2; exit 2; }
    command -v debootstrap >/dev/null || apt-get install -y --no-install-recommends debootstrap
    [ ! -f "$system/.complete" ] || return 0
    debootstrap --variant=minbase "$release" "$system" "$mirror"
    # How this machine reaches its mirror is its own business; the guest does it the same way.
    cp -a /etc/apt/apt.conf.d/. "$system/etc/apt/apt.conf.d/"
    rm -f "$system"/etc/apt/apt.conf.d/{20packagekit,50appstream}
    cp -L /etc/resolv.conf /etc/hosts "$system/etc/" 2>/dev/null || true
    touch "$system/.complete"
}

# The machine's devices and processes are seen inside between these two.
open_bare() { # SYSTEM
    local kind
    for kind in proc sys dev; do
        mountpoint -q "$1/$kind" || mount --rbind "/$kind" "$1/$kind"
        # What is unmounted inside stays on the machine.
        mount --make-rslave "$1/$kind"
    done
}
close_bare() { # SYSTEM
    local kind
    for kind in dev sys proc; do
        ! mountpoint -q "$1/$kind" || umount -R -l "$1/$kind"
    done
}

inside() { # SYSTEM COMMAND...
    local system=$1
    shift
    echo "--- $*"
    chroot "$system" /usr/bin/env -i HOME=/root TERM=dumb LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
        PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@"
}
