#include "core/caller/view.hpp"

namespace holonomic {

AtomArray packed_array(const double *p) {
    if (!p) return AtomArray{};
    char *const x = const_cast<char *>(reinterpret_cast<const char *>(p));
    return {x, x + sizeof(double), x + 2 * sizeof(double), 3 * sizeof(double), false, true};
}

void unify_layout(AtomArray *const *arrays, int n) {
    bool packed = true;
    for (int i = 0; i < n; ++i) packed = packed && (arrays[i]->packed || !arrays[i]->x);
    for (int i = 0; i < n; ++i) arrays[i]->packed = packed;
}

}  // namespace holonomic
