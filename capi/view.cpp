#include "view.hpp"

#include "core/error.hpp"

namespace holonomic {

AtomArray viewed_array(const hol_view *view, const char *name) {
    if (!view) return AtomArray{};
    if (!view->x || !view->y) throw make_error(Status::null, "the view of %s has no x or no y", name);
    if (view->element != HOL_DOUBLE && view->element != HOL_FLOAT)
        throw make_error(Status::value, "the view of %s has the element type %d; it must be HOL_DOUBLE or HOL_FLOAT",
                         name, static_cast<int>(view->element));
    if (view->reserved != 0)
        throw make_error(Status::value, "the view of %s has a reserved member that is not 0", name);
    const bool is_float = view->element == HOL_FLOAT;
    const std::int64_t size = is_float ? sizeof(float) : sizeof(double);
    if (view->stride == 0 || view->stride % size != 0)
        throw make_error(Status::value,
                         "the view of %s has a stride of %lld bytes; it must be a multiple of %lld, not 0", name,
                         static_cast<long long>(view->stride), static_cast<long long>(size));
    AtomArray array{static_cast<char *>(view->x),
                    static_cast<char *>(view->y),
                    static_cast<char *>(view->z),
                    view->stride,
                    is_float,
                    false};
    array.packed = !is_float && view->stride == 3 * size && array.y == array.x + size && array.z == array.x + 2 * size;
    return array;
}

void check_dimensions(const AtomArray *const *arrays, int n) {
    for (int i = 1; i < n; ++i)
        if (arrays[i]->x && !arrays[i]->z != !arrays[0]->z)
            throw make_error(Status::value, "some views have z and some have not");
}

}  // namespace holonomic
