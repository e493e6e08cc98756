#!/bin/sh
# Runs a test with the kernels SET, which the library in FOLDER has if the one that is installed has not; or says that they
# can't run here and ends with 77.
#
#   with_set.sh SET FOLDER INSTRUCTION_SET COMMAND...
set -u
HOLONOMIC_ISA=$1 folder=$2 instruction_set=$3
shift 3
export HOLONOMIC_ISA
if [ "$("$instruction_set")" != "$HOLONOMIC_ISA" ]; then
    LD_LIBRARY_PATH=$folder${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
    export LD_LIBRARY_PATH
    if [ "$("$instruction_set")" != "$HOLONOMIC_ISA" ]; then
        echo "the kernels '$HOLONOMIC_ISA' can't run on this machine"
        exit 77
    fi
fi
exec "$@"
