#include "view.hpp"

#include "core/error.hpp"

namespace holonomic {

AtomArray checked_array(const hol_const_view &view, const char *name) {
    if (!view.x || !view.y) throw make_error(Status::null, "the view of %s has no x or no y", name);
    if (view.element != HOL_DOUBLE && view.element != HOL_FLOAT)
        throw make_error(Status::value, "the view of %s has the element type %d; it must be HOL_DOUBLE or HOL_FLOAT",
                         name, static_cast<int>(view.element));
    if (view.reserved != 0) throw make_error(Status::value, "the view of %s has a reserved member that is not 0", name);
    const bool is_float = view.element == HOL_FLOAT;
    const std::int64_t size = is_float ? sizeof(float) : sizeof(double);
    if (view.stride == 0 || view.stride % size != 0)
        throw make_error(Status::value,
                         "the view of %s has a stride of %lld bytes; it must be a multiple of %lld, not 0", name,
                         static_cast<long long>(view.stride), static_cast<long long>(size));
    const auto bytes = [](const void *p) { return const_cast<char *>(static_cast<const char *>(p)); };
    AtomArray array{bytes(view.x), bytes(view.y), bytes(view.z), view.stride, is_float, false};
    array.packed = !is_float && view.stride == 3 * size && array.y == array.x + size && array.z == array.x + 2 * size;
    return array;
}

void refuse_same(const char *name, const char *other) {
    throw make_error(Status::value, "%s is the array that was given for %s", name, other);
}

void check_dimensions(std::initializer_list<const AtomArray *> arrays) {
    const AtomArray *first = nullptr;
    for (const AtomArray *const array : arrays) {
        if (!array->x) continue;
        if (!first) first = array;
        if (!array->z != !first->z) throw make_error(Status::value, "some views have z and some have not");
    }
}

}  // namespace holonomic
