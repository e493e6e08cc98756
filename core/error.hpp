// How the core reports a failure to the C layer.
#pragma once

#include <cstdint>

#include "core/status.hpp"

namespace holonomic {

// Thrown after every output that is due has been written. Numbers are counted from 0; -1: does not apply.
struct Error {
    Status status;
    char message[640];  // text, with the numbers already in the caller's counting
    std::int64_t chain = -1, bond = -1, atom = -1, n_bad = 0;
    int base = 0;  // of the caller's counting
};

[[gnu::format(printf, 2, 3)]] Error make_error(Status status, const char *format, ...);

// Throws it, of this bond and atom, or -1.
[[noreturn]] inline void fail(Error error, int base, std::int64_t bond, std::int64_t atom) {
    error.bond = bond;
    error.atom = atom;
    error.base = base;
    throw error;
}

}  // namespace holonomic
