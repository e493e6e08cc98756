#!/bin/sh
# What is compiled for one instruction set stays in it. The linker keeps one copy of an inline function that several
# objects have; should that be the AVX2 one, an older machine dies of it. So whatever an object of kernels exposes bears the
# name of its instruction set.
#
#   check_kernels.sh OBJECT...        NM names the program to use
set -eu
status=0
count=0
for object in "$@"; do
    case $object in
        */holonomic_kernels_*) ;;
        *) continue ;;
    esac
    count=$((count + 1))
    name=${object##*/holonomic_kernels_}
    name=${name%%.*}
    exposed=$("$NM" -C -g --defined-only "$object" | cut -d ' ' -f 2-)
    # Every symbol, weak or not, must be of this namespace, and none of the standard library.
    foreign=$(printf '%s\n' "$exposed" | grep -v "^. \(vtable for \)\?holonomic::$name::" || :)
    [ -z "$foreign" ] || { echo "$object: may end up in other paths: $foreign"; status=1; }
done
[ $count -gt 0 ] || { echo "no object of kernels among $*"; exit 1; }
exit $status
