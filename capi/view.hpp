// Views of the C interface, checked, as the core takes them.
#ifndef HOLONOMIC_CAPI_VIEW_HPP
#define HOLONOMIC_CAPI_VIEW_HPP

#include "core/caller/view.hpp"
#include "holonomic.h"

namespace holonomic {

// As the view says; absent if it is a null pointer. Throws Error with `name` in the message if it makes no sense.
AtomArray viewed_array(const hol_view *view, const char *name);

// All views of a call have z, or none has.
void check_dimensions(const AtomArray *const *arrays, int n);

}  // namespace holonomic
#endif
