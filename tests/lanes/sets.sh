#!/bin/sh
# Says which sets of kernels there are, which of them run on this machine and which can't.
#
#   sets.sh FOLDER INSTRUCTION_SET SET...
set -u
folder=$1 instruction_set=$2
shift 2
echo "without HOLONOMIC_ISA: $("$instruction_set")"
ran=0
for set in "$@"; do
    if "${0%/*}/with_set.sh" "$set" "$folder" "$instruction_set" true; then
        echo "$set: runs here"
        ran=$((ran + 1))
    fi
done
[ $ran -gt 0 ]
