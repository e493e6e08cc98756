#!/bin/sh
# What is compiled for one instruction set stays in it. The linker keeps one copy of an inline function that several
# objects have; should that be the AVX2 one, an older machine dies of it. So each object of kernels defines nothing
# that another could use but its table, and whatever else it exposes bears the name of its instruction set.
#
#   check_kernels.sh OBJECT...        NM names the program to use
set -eu
status=0
count=0
for object in "$@"; do
    case $object in
        */kernels_*) ;;
        *) continue ;;
    esac
    count=$((count + 1))
    name=${object##*/kernels_}
    name=${name%%.*}
    exposed=$("$NM" -C -g --defined-only "$object" | cut -d ' ' -f 2-)
    strong=$(printf '%s\n' "$exposed" | grep -v '^[WVuw] ' || :)
    [ "${strong#* }" = "holonomic::$name::kernels" ] || { echo "$object: not its table alone: $strong"; status=1; }
    # In a weak symbol every type and function of the library must be of this namespace, and nothing of the standard library.
    foreign=$(printf '%s\n' "$exposed" | grep '^[WVuw] ' | grep -v "^. \(vtable for \)\?holonomic::$name::" || :)
    [ -z "$foreign" ] || { echo "$object: may end up in other paths: $foreign"; status=1; }
done
[ $count -gt 0 ] || { echo "no object of kernels among $*"; exit 1; }
exit $status
