# shellcheck shell=bash
# Sourced by scripts that need a bare Debian system; they run as root.

# Makes a bare Debian in the folder SYSTEM, unless it exists.
make_bare() { # SYSTEM RELEASE MIRROR
    local system=$1 release=$2 mirror=$3
    [ "$(id -u)" -eq 0 ] || { echo "run as root: debootstrap and chroot require it" >&2; exit 2; }
    command -v debootstrap >/dev/null || apt-get install -y --no-install-recommends debootstrap
    [ ! -f "$system/.complete" ] || return 0
    debootstrap --variant=minbase "$release" "$system" "$mirror"
    # The bare system must reach the mirror in the same way as this machine (proxy, host names).
    cp -a /etc/apt/apt.conf.d/. "$system/etc/apt/apt.conf.d/"
    rm -f "$system"/etc/apt/apt.conf.d/{20packagekit,50appstream}
    cp -L /etc/resolv.conf /etc/hosts "$system/etc/" 2>/dev/null || true
    touch "$system/.complete"
}

# open_bare mounts the machine's devices and processes in the system; close_bare unmounts them.
open_bare() { # SYSTEM
    local kind
    for kind in proc sys dev; do
        mountpoint -q "$1/$kind" || mount --rbind "/$kind" "$1/$kind"
        # An unmount in the system must not unmount the machine's folders.
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
