// The largest coordinate of each chain of a block: its rounding is what a length may be off by (criterion.hpp).
// Packed rows are read W numbers at a time, atoms of lists one by one.
#include "core/kernels/newton/criterion.hpp"

namespace holonomic::HOL_ISA {

vec extent(const Block &block, const Source &source) {
    const bool in_rows = !source.atoms && !source.lanes;
    vec largest = {};
    for (int i = 0; i < W; ++i) {
        double x = 0, of_rows[W];
        const auto look = [&](const double *p, long n) {
            for (long e = 0; e < n; ++e) x = abs(p[e]) > x ? abs(p[e]) : x;
        };
        const double *const row = source.atom(i, 0);
        const long count = 3 * (block.len[i] + 1);
        vec m = {};
        long e = 0;
        for (; in_rows && e + W <= count; e += W) m = max(m, abs(load(row + e)));
        store(of_rows, m);
        look(of_rows, W);
        if (in_rows) look(row + e, count - e);
        for (long k = 0; !in_rows && k <= block.len[i]; ++k) look(source.atom(i, k), 3);
        largest[i] = x;
    }
    return largest;
}

}  // namespace holonomic::HOL_ISA
