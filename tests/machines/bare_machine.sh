# A machine with nothing on it but a distribution's essential packages and apt: a folder to change root to. To be read with `.`.
#
#   leave_out WORDS...                       says why, and ends with 77
#   make_machine SUITE ROOT [MIRROR]         SUITE: bookworm, trixie, noble, ...; MIRROR: if not given, from where this machine gets
#                                            its own packages. Ends with 77 where that can't be had; needs root and mmdebstrap.
#                                            The folder is removed when the script ends.
#   inside COMMAND...                        runs there with an environment of its own (`inside NAME=VALUE COMMAND...`); a folder
#                                            that $shared names is /srv/shared there

leave_out() {
    echo "left out: $*"
    exit 77
}

make_machine() {
    local suite=$1 mirror=${3:-} trust=
    [ "$(id -u)" -eq 0 ] || leave_out "only root can make a machine of its own"
    command -v mmdebstrap >/dev/null || leave_out "no mmdebstrap"
    [ -n "$mirror" ] || mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -v security | head -n 1)
    [ -n "$mirror" ] || leave_out "no mirror known"
    rm -rf "$2"
    mkdir -p "$(dirname "$2")"
    root=$(cd "$(dirname "$2")" && pwd)/$(basename "$2")
    trap 'rm -rf --one-file-system "$root"' EXIT
    case $mirror in
        *ubuntu*)
            if [ ! -e /usr/share/keyrings/ubuntu-archive-keyring.gpg ]; then
                echo "there is no key here to check $suite with: it is taken as it comes"
                trust="[trusted=yes] "
            fi
            mirror="deb $trust$mirror $suite main universe"
            ;;
    esac
    echo "making $suite"
    mmdebstrap --variant=minbase --include=apt,ca-certificates "$suite" "$root" "$mirror" </dev/null >"$root.log" 2>&1 ||
        { tail -n 5 "$root.log"; leave_out "$suite can't be had"; }
    # apt reaches its sources as it does outside.
    cp /etc/resolv.conf "$root/etc/" 2>/dev/null || :
    cp /etc/apt/apt.conf.d/* "$root/etc/apt/apt.conf.d/" 2>/dev/null || :
    [ ! -d /etc/apt/auth.conf.d ] || cp -r /etc/apt/auth.conf.d "$root/etc/apt/"
    mkdir -p "$root/srv/shared"
    inside true || leave_out "nothing can be mounted in a machine of its own"
}

# What is mounted there is seen by the command alone, so nothing is left that could be removed with the machine.
inside() {
    unshare --mount sh -c '
        mount --rbind /dev "$0/dev" && mount --bind /proc "$0/proc" && mount --rbind /sys "$0/sys" &&
            { [ -z "$1" ] || mount --bind "$1" "$0/srv/shared"; } && shift && exec chroot "$0" "$@"' "$root" "${shared:-}" \
        /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C DEBIAN_FRONTEND=noninteractive "$@"
}
