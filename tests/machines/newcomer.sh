#!/usr/bin/env bash
# What README tells someone with a clean clone to do, on a machine with nothing on it: scripts/test, and scripts/demo.
#
#   newcomer.sh SUITE WORK [WITHOUT]
#       SUITE    bookworm, trixie, noble        WORK      folder for the machine and its logs
#       WITHOUT  a name of scripts/setup.sh that is not installed there: then scripts/test alone
# The last line has the counts. FRESH_TESTS (environment): arguments for ctest, to try this out with a few tests; then no demo.
# CMAKE_ARGS goes to scripts/test; FRESH_CCACHE is a folder for ccache, which is on the machine then.
# Exit status 77: no mmdebstrap, no root, or the distribution can't be had.
set -u
suite=$1 work=$2 without=${3:-}
top=$(cd "$(dirname "$0")/../.." && pwd) || exit 1
. "$top/tests/machines/bare_machine.sh"
name=$suite${without:+-without-$without}
mirror=
[ "$suite" != noble ] || mirror=http://archive.ubuntu.com/ubuntu/
make_machine "$suite" "$work/$name" $mirror
git -C "$top" diff --quiet HEAD || echo "what is not committed is not tried"
git clone --quiet --no-hardlinks "$top" "$root/srv/holonomic" || exit 1
ccache=()
if [ -n "${FRESH_CCACHE:-}" ]; then
    inside sh -c 'apt-get update -qq && apt-get install -y -qq --no-install-recommends ccache' </dev/null >"$root.log" 2>&1 || exit 1
    ccache=(CCACHE_DIR=/srv/shared CCACHE_BASEDIR=/srv CCACHE_NOHASHDIR=1 CMAKE_C_COMPILER_LAUNCHER=ccache
        CMAKE_CXX_COMPILER_LAUNCHER=ccache)
    shared=$FRESH_CCACHE
fi

began=$SECONDS
log=$root.test.log
# shellcheck disable=SC2086
inside "${ccache[@]}" CMAKE_ARGS="${CMAKE_ARGS:-}" HOLONOMIC_WITHOUT="$without" /srv/holonomic/scripts/test ${FRESH_TESTS:-} \
    </dev/null 2>&1 | tee "$log" | grep --line-buffered -E '^(==|The following tests FAILED|	 *[0-9]+ - .*(Failed|SEGFAULT|Timeout))'
status=${PIPESTATUS[0]}
counts=$(awk '
    /tests passed, .* tests? failed out of/ { failed = $4; total = $NF; counted = 1 }
    /^The following tests did not run:/ { skipping = 1; next }
    skipping && / \(Skipped\)/ { ++skipped; next }
    skipping { skipping = 0 }
    END { print counted ? total - failed - skipped " passed, " failed + 0 " failed, " skipped + 0 " skipped" : "no tests were run" }' "$log")
result="$name: scripts/test $counts in $((SECONDS - began)) s"
if [ -z "$without${FRESH_TESTS:-}" ]; then
    began=$SECONDS
    if inside /srv/holonomic/scripts/demo </dev/null >"$root.demo.log" 2>&1; then
        result+="; scripts/demo passed in $((SECONDS - began)) s"
    else
        result+="; scripts/demo FAILED after $((SECONDS - began)) s"
        tail -n 20 "$root.demo.log"
        status=1
    fi
fi
echo "$result"
exit "$status"
