// Whether an output per atom is added to what is there.
#ifndef HOLONOMIC_CAPI_MODE_HPP
#define HOLONOMIC_CAPI_MODE_HPP

#include "core/error.hpp"
#include "holonomic.h"

namespace holonomic {

// Throws Error if the mode is neither HOL_WRITE nor HOL_ADD.
inline bool adds(hol_mode mode) {
    if (mode != HOL_WRITE && mode != HOL_ADD)
        throw make_error(Status::value, "mode is %d; it must be HOL_WRITE or HOL_ADD", static_cast<int>(mode));
    return mode != HOL_WRITE;
}

}  // namespace holonomic
#endif
