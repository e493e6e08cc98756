#!/bin/sh
# Prints the number from which a soak of this commit starts: ten digits of its name, so that every commit covers new
# ground and what it finds can be repeated; beyond the numbers of all tests.
#   first_number.sh SOURCE_DIRECTORY
set -u
commit=$(git -C "$1" rev-parse HEAD 2>/dev/null) || commit=0000000000
echo $((0x$(printf %.10s "$commit") * 1000000 + 10000000000))
