// What a call can end with. The values are those of hol_status in the public header, which capi/status.cpp asserts:
// core includes nothing of capi.
#pragma once

namespace holonomic {

enum class Status {
    ok = 0,
    null = 1,
    value = 2,
    index = 3,
    shared_atom = 4,
    memory = 5,
    not_finite = 6,
    degenerate = 7,
    no_convergence = 8,
    not_definite = 9,
    internal = 10,
    lengths = 11,
    unsupported = 12,
    state = 13,
    callback = 14
};

}  // namespace holonomic
