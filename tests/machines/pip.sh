#!/usr/bin/env bash
# From a machine with nothing on it to the first right result in Python, by pip from a clean clone: at most five minutes on two free
# cores.
#
#   pip.sh SUITE WORK
#       SUITE    bookworm, noble, ...        WORK     folder for the machine and its log
# PIP_SECONDS (environment): another limit, where the cores are not free. Exit status 77: no mmdebstrap, no root, or the distribution
# can't be had.
set -u
suite=$1 work=$2
top=$(cd "$(dirname "$0")/../.." && pwd) || exit 1
. "$top/tests/machines/bare_machine.sh"
mirror=
[ "$suite" != noble ] || mirror=http://archive.ubuntu.com/ubuntu/
make_machine "$suite" "$work/$suite-pip" $mirror
git -C "$top" diff --quiet HEAD || echo "what is not committed is not tried"
git clone --quiet --no-hardlinks "$top" "$root/srv/holonomic" || exit 1

began=$SECONDS
# numpy and setuptools are the distribution's: nothing is asked of another network than apt's.
inside sh -ec '
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends g++ cmake make python3-venv python3-numpy python3-setuptools python3-wheel
    echo "packages: $(cut -d " " -f 1 /proc/uptime)"
    python3 -m venv --system-site-packages /srv/environment
    cd /srv/holonomic
    /srv/environment/bin/pip install --no-build-isolation --no-index .
    echo "installed: $(cut -d " " -f 1 /proc/uptime)"
    cd /srv
    /srv/environment/bin/python holonomic/tests/python/installed.py /srv/environment
    times' </dev/null >"$root.log" 2>&1 || { tail -n 20 "$root.log"; exit 1; }
took=$((SECONDS - began))
tail -n 3 "$root.log" | head -n 1
echo "$suite: the first result by pip after $took s; processor time of all that was run: $(tail -n 1 "$root.log")"
[ "$took" -le "${PIP_SECONDS:-300}" ] || { echo "that is more than ${PIP_SECONDS:-300} s"; exit 1; }
