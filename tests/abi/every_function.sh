#!/usr/bin/env bash
# A program built against an earlier release runs with today's library. It is compiled with that release's header, and
# linked to a library that has that release's symbol versions and nothing in it, so that nothing of today's gets in.
#
#   every_function.sh SOURCE LIBRARY WORK 0.1          the header and symbols of 0.1 as frozen in tests/abi/frozen
#   every_function.sh SOURCE LIBRARY WORK last_tag     those of the last tag v*, and the program as it was then
#
# CC and READELF name programs. Exit status 77: there is no tag, or no git to ask.
set -eu
source=$1 library=$2 work=$3 release=$4
cc=${CC:-cc}
rm -rf "$work"
mkdir -p "$work/include" "$work/stub"
if [ "$release" = last_tag ]; then
    tag=$(git -C "$source" describe --tags --abbrev=0 --match 'v[0-9]*' 2>/dev/null) || { echo "no tag v*"; exit 77; }
    git -C "$source" show "$tag:capi/holonomic.h" >"$work/include/holonomic.h"
    git -C "$source" show "$tag:capi/holonomic.map" >"$work/holonomic.map"
    git -C "$source" show "$tag:tests/abi/every_function.c" >"$work/every_function.c"
    soversion=$(git -C "$source" show "$tag:CMakeLists.txt" | sed -n 's/^set(HOLONOMIC_SOVERSION \([0-9]*\)).*/\1/p')
    echo "the last tag is $tag"
else
    cp "$source/tests/abi/frozen/holonomic-$release.h" "$work/include/holonomic.h"
    cp "$source/tests/abi/frozen/holonomic-$release.map" "$work/holonomic.map"
    cp "$source/tests/abi/every_function.c" "$work/every_function.c"
    soversion=0
fi
[ -e "$(dirname "$library")/libholonomic.so.$soversion" ] ||
    { echo "today's library has another SOVERSION than $soversion: nothing is promised"; exit 77; }

functions=$(sed -n 's/^ *\(hol_[a-z_0-9]*\);.*/\1/p' "$work/holonomic.map" | sort)
for function in $functions; do echo "void $function(void); void $function(void) {}"; done >"$work/stub/stub.c"
"$cc" -shared -fPIC "$work/stub/stub.c" -o "$work/stub/libholonomic.so" \
    -Wl,-soname,libholonomic.so.$soversion -Wl,--version-script="$work/holonomic.map"
"$cc" -I "$work/include" "$work/every_function.c" -o "$work/program" -L "$work/stub" -lholonomic -lm

used=$("${READELF:-readelf}" --dyn-syms -W "$work/program" | grep -o 'hol_[a-z_0-9]*' | sort -u)
if [ "$used" != "$functions" ]; then
    echo "the program does not call:" $(printf '%s\n' "$used" "$used" "$functions" | sort | uniq -u)
    exit 1
fi
LD_LIBRARY_PATH=$(dirname "$library") "$work/program"
