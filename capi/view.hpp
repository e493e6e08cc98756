// Views of the C interface, checked, as the core takes them.
#ifndef HOLONOMIC_CAPI_VIEW_HPP
#define HOLONOMIC_CAPI_VIEW_HPP

#include <cstdint>
#include <initializer_list>
#include <type_traits>

#include "boundary.hpp"
#include "core/caller/packed_array.hpp"
#include "holonomic.h"

namespace holonomic {

// As the view says. Throws Error with `name` in the message if it makes no sense.
AtomArray checked_array(const hol_const_view &view, const char *name);

// An argument of `count` elements; absent if it is a null pointer. Most functions come in pairs, one for packed
// doubles, one for views: both are one template over what it is given, inlined by force as guarded() is.
inline AtomArray array_of(std::int64_t, const double *packed, const char *) { return packed_array(packed); }

// Absent as well if there are no elements. Most views are of packed doubles: Fortran's arrays come as views.
inline AtomArray array_of(std::int64_t count, const hol_const_view *view, const char *name) {
    if (!view || count == 0) return AtomArray{};
    const double *const x = static_cast<const double *>(view->x);
    if (x && view->element == HOL_DOUBLE && view->reserved == 0 && view->stride == 3 * sizeof(double) &&
        view->y == x + 1 && view->z == x + 2)
        return packed_array(x);
    return checked_array(*view, name);
}
inline AtomArray array_of(std::int64_t count, const hol_view *view, const char *name) {
    if (!view) return AtomArray{};
    const hol_const_view read = hol_view_read(view);
    return array_of(count, &read, name);
}

// Throws Error where two arrays that can't be one are: the one was given in the other's place. Of no molecules nothing
// is read.
[[noreturn]] void refuse_same(const char *name, const char *other);
inline void need_apart(const hol_chains &of, const AtomArray &a, const char *name, const AtomArray &b,
                       const char *other) {
    if (a.x && a.x == b.x && of.chains.n_molecules() > 0) refuse_same(name, other);
}

// All views of a call that are there have z, or none has.
void check_dimensions(std::initializer_list<const AtomArray *> arrays);
// The same of a call that was given such arguments.
template <class Given>
__attribute__((always_inline)) inline void check_dimensions_of(std::initializer_list<const AtomArray *> arrays) {
    if constexpr (!std::is_same_v<Given, double>) check_dimensions(arrays);
}

}  // namespace holonomic
#endif
