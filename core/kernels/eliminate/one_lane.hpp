// The sweep down a chain that comes alone, in sets of one lane. Each multiplier waits for the one behind it; meanwhile
// four atoms at a time get their pulls (memory/fours.hpp).
#pragma once

#include "core/kernels/memory/fours.hpp"

#if HOL_FOURS
namespace holonomic::HOL_ISA {

// Turns u[0 .. n-1] into t and calls put(e, pull) for all components e = 3 k + c of the atoms, with a double or, from e
// on, with four of them. The last u is added to zero, as backward() does.
template <class Put>
HOL_INLINE void pull_down(long n, const vec3 *D, vec *u, const vec *L, const Put &put) {
    double t = 0, *const x = &u->element;
    vec3 after = {};
    const auto pull = [&](long k, const vec3 &before) HOL_FORCED {
        const vec3 g = after - before;
        put(3 * k, g.x.element);
        put(3 * k + 1, g.y.element);
        put(3 * k + 2, g.z.element);
        after = before;
    };
    long k = n;
    while (k > 0 && (k % 4 != 0 || k == n)) {
        --k;
        t = k + 1 == n ? x[k] + 0.0 : mul_add(L[k + 1].element, t, x[k]);
        x[k] = t;
        pull(k + 1, vec{t} * D[k]);
    }
    four behind = {t, 0, 0, 0};
    for (; k > 0; k -= 4) {
        const double *const d = &D[k - 4].x.element;
        const double t3 = mul_add(L[k].element, t, x[k - 1]), t2 = mul_add(L[k - 1].element, t3, x[k - 2]),
                     t1 = mul_add(L[k - 2].element, t2, x[k - 3]);
        t = mul_add(L[k - 3].element, t1, x[k - 4]);
        const four before = {t, t1, t2, t3};
        const four next = _mm256_shuffle_pd(before, _mm256_permute2f128_pd(before, behind, 0x21), 5);
        store_any(x + k - 4, before);
        const auto part = [&](auto j) HOL_FORCED {
            const four g =
                spread<j>(next) * load_any<four>(d + 4 * j + 3) - spread<j>(before) * load_any<four>(d + 4 * j);
            put(3 * (k - 3) + 4 * j, g);
        };
        part(Constant<int, 2>{});
        part(Constant<int, 1>{});
        part(Constant<int, 0>{});
        behind = before;
    }
    after = vec{t} * D[0];
    pull(0, vec3{});
}

}  // namespace holonomic::HOL_ISA
#endif
