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
    # Every symbol, weak or not, must be of this namespace, and none of the standard library: mangled names tell, the others
    # begin with what a function returns.
    foreign=$("$NM" -g --defined-only "$object" | cut -d ' ' -f 2- |
        grep -v "^. _Z\(T[VIS]\)\?\(GV\)\?Z*N[KVr]*9holonomic${#name}$name" || :)
    [ -z "$foreign" ] || { echo "$object: may end up in other paths: $foreign"; status=1; }
done
[ $count -gt 0 ] || { echo "no object of kernels among $*"; exit 1; }
exit $status
