#!/bin/sh
# scripts/release in a clone whose checks are stand-ins: it tags what passes, and nothing else.
#
#   release.sh SOURCE WORK        Exit status 77: no git, or the source is no clone
set -eu
source=$1 work=$2
git -C "$source" rev-parse HEAD >/dev/null 2>&1 || { echo "left out: no git, or no clone"; exit 77; }
rm -rf "$work"
# What is in the working tree, committed or not.
mkdir -p "$work"
cd "$source"
for file in .ci/run scripts/release scripts/setup.sh capi/holonomic.h CITATION.cff CHANGELOG.md fpm.toml python/holonomic/__init__.py \
    hosts/mpi/CMakeLists.txt tests/abi/holonomic-*.abi; do
    mkdir -p "$work/$(dirname "$file")"
    cp "$file" "$work/$file"
done
cd "$work"
mkdir build
fail() { cat build/output; echo "$*"; exit 1; }

# Every step that .ci/run knows is one of a release's.
steps=$(sed -n 's/^steps="\(.*\)"$/\1/p' scripts/release)
for step in $(sed -n 's/^ *\([a-z0-9 |]*\)).*/\1/p' .ci/run | tr -d '|' | tr ' ' '\n' | sort -u); do
    case $step in '' | 0 | 77) continue ;; windows) continue ;; esac # Windows is no machine that releases are held to
    case " $steps " in *" $step "*) ;; *) echo "scripts/release leaves out .ci/run $step"; exit 1 ;; esac
done

echo 'echo "$1" >>"$STEPS"; echo "== LEFT OUT: test nothing (no tool)"; [ "$1" != "${FAILS:-}" ]' >.ci/run
printf '#!/bin/sh\necho fuzz "$1" >>"$STEPS"\n' >scripts/fuzz
printf '#!/bin/sh\nexit "${SOAK_IS_OLD:-0}"\n' >scripts/soak
echo /build >.gitignore
chmod +x .ci/run scripts/fuzz scripts/soak
version=$(sed -n 's/^version: //p' CITATION.cff)
sed -i "s/^## $version .*/## $version (unreleased)/" CHANGELOG.md
git init -q .
git config user.name test
git config user.email test@localhost
git add -A
git commit -q -m first
first=$(git rev-parse HEAD)
export STEPS="$work/build/steps"

: >"$STEPS"
no_tag() { [ -z "$(git tag)" ] && [ "$(git rev-parse HEAD)" = "$first" ] || fail "$1: a tag or a commit was made"; }

scripts/release --help >build/output && grep -q -e '--dry-run' build/output || fail "no help"
scripts/release --dry-run >build/output || fail "the dry run finds something wrong"
grep -q "would run: release .* fuzz; .* v$version" build/output || fail "the dry run does not say what would be run"
[ ! -s "$STEPS" ] || fail "the dry run ran something"
no_tag "dry run"
! scripts/release --dry >build/output 2>&1 || fail "an argument that there is not"

# What stops it before anything is run.
! SOAK_IS_OLD=1 scripts/release >build/output 2>&1 && grep -q 'WRONG: the soak' build/output || fail "an old soak"
echo >>fpm.toml
! scripts/release >build/output 2>&1 && grep -q 'WRONG: nothing is left uncommitted' build/output || fail "something uncommitted"
git checkout -q fpm.toml
sed -i "s/^version: .*/version: 0.0.1/" CITATION.cff
! scripts/release --dry-run >build/output 2>&1 && grep -q 'WRONG: CITATION.cff' build/output || fail "another version in CITATION.cff"
git checkout -q CITATION.cff
[ ! -s "$STEPS" ] || fail "steps were run"

# A step that fails; then those that have passed are not run again.
! FAILS=tidy scripts/release >build/output 2>&1 && grep -q 'tidy failed' build/output || fail "a step that fails"
no_tag "a step that fails"
: >"$STEPS"
scripts/release >build/output 2>&1 || fail "it was not released"
printf '%s\n' tidy lanes arm "fuzz 600" | diff - "$STEPS" || fail "other steps were run"

[ "$(git tag)" = "v$version" ] && [ "$(git rev-parse "v$version^{commit}")" = "$(git rev-parse HEAD)" ] || fail "no tag"
[ "$(git rev-parse HEAD^)" = "$first" ] || fail "more commits than one"
today=$(date -u +%Y-%m-%d)
grep -qx "date-released: $today" CITATION.cff && grep -qx "## $version ($today)" CHANGELOG.md || fail "no date"
git tag -l --format='%(contents)' "v$version" >build/output
grep -qx '### Added' build/output && grep -q 'LEFT OUT: test nothing' build/output || fail "the tag does not say what is new"
! scripts/release --dry-run >build/output 2>&1 && grep -q "WRONG: there is no tag v$version yet" build/output || fail "it would be released twice"
