#!/bin/sh
# Whether sets of kernels give the same bits, for chains of SHORTEST to LONGEST bonds. Sets that can't run here are named; with
# fewer than two there is nothing to compare (exit status 77).
#
#   same_bits.sh FOLDER DIGEST SHORTEST LONGEST SET...        FOLDER: see with_set.sh
set -u
folder_of_sets=$1 digest=$2 shortest=$3 longest=$4
shift 4
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
first='' compared=0
for set in "$@"; do
    HOLONOMIC_ISA=$set "$digest" "$longest" "$shortest" >"$folder/$set"
    status=$?
    if [ $status -eq 77 ]; then
        HOLONOMIC_ISA=$set LD_LIBRARY_PATH=$folder_of_sets "$digest" "$longest" "$shortest" >"$folder/$set"
        status=$?
    fi
    if [ $status -eq 77 ]; then
        echo "$set can't run here"
        continue
    fi
    [ $status -eq 0 ] && [ -s "$folder/$set" ] || { echo "$set: $digest failed"; exit 1; }
    if grep failed "$folder/$set"; then exit 1; fi
    if [ -z "$first" ]; then
        first=$set
        continue
    fi
    compared=$((compared + 1))
    if ! cmp -s "$folder/$first" "$folder/$set"; then
        echo "$first and $set differ:"
        diff "$folder/$first" "$folder/$set" | head -n 20
        exit 1
    fi
    echo "$first and $set: the same bits in $(wc -l <"$folder/$set") scenes"
done
[ $compared -gt 0 ] || exit 77
