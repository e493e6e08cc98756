#!/usr/bin/env bash
# A program built against an earlier release runs with today's library. It is compiled with that release's header, and
# linked to a library that has that release's symbol versions and nothing in it, so that nothing of today's gets in.
#
#   every_function.sh LIBRARY WORK HEADER MAP PROGRAM        the header and the symbols of the release, and a program in C
#
# CC and READELF name programs. Exit status 77: today's library has another SOVERSION.
set -eu
library=$1 work=$2 header=$3 map=$4 program=$5
cc=${CC:-cc}
rm -rf "$work"
mkdir -p "$work/include" "$work/stub"
cp "$header" "$work/include/holonomic.h"
cp "$map" "$work/holonomic.map"
cp "$program" "$work/every_function.c"
soversion=0
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
