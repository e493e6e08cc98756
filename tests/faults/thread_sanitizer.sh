#!/usr/bin/env bash
# Builds the library and the test of concurrent use with ThreadSanitizer, and runs it. Without OpenMP: its run-time is not
# instrumented, and what it orders would look like races. The threads are the caller's, as in the promise.
#
#   thread_sanitizer.sh BUILD_DIRECTORY        CMAKE_ARGS: further options for cmake
set -u
top=$(cd "$(dirname "$0")/../.." && pwd) || exit 1
build=$1
# shellcheck disable=SC2086
cmake -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS="-g1 -Og -fsanitize=thread" \
    -DCMAKE_C_FLAGS="-g1 -Og -fsanitize=thread" -DHOLONOMIC_BUILD_TESTS=ON -DHOLONOMIC_BUILD_FORTRAN=OFF \
    -DHOLONOMIC_WITH_OPENMP=OFF ${CMAKE_ARGS:-} || exit 1
cmake --build "$build" -j "${JOBS:-2}" --target test_concurrent_use || exit 1
TSAN_OPTIONS="halt_on_error=1 exitcode=66" "$build/tests/faults/test_concurrent_use"
