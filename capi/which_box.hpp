// Which of its two boxes a call means.
#ifndef HOLONOMIC_CAPI_WHICH_BOX_HPP
#define HOLONOMIC_CAPI_WHICH_BOX_HPP

#include "boundary.hpp"

namespace holonomic {

// Throws Error if it is neither HOL_BOX nor HOL_REFERENCE_BOX.
inline bool is_reference(hol_which_box box) {
    if (box != HOL_BOX && box != HOL_REFERENCE_BOX)
        throw make_error(Status::value, "box is %d; it must be HOL_BOX or HOL_REFERENCE_BOX", static_cast<int>(box));
    return box == HOL_REFERENCE_BOX;
}
inline const Cell &box_of(const hol_chains *chains, hol_which_box box) {
    return is_reference(box) ? chains->chains.box_of_reference() : chains->chains.box;
}

}  // namespace holonomic
#endif
