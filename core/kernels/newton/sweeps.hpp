// The sweeps of Newton's method up and down the chains of a block.
#pragma once

#include "core/kernels/eliminate/effective_mass.hpp"
#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/newton/system.hpp"

namespace holonomic::HOL_ISA {

// Calls body(k, ragged) for the bonds of a block upwards, two at a time while all lanes have them. `fixed`: the number
// of bonds if the compiler knows it, else 0.
template <int fixed, int k = 0, class Body>
HOL_INLINE void go_up(const Block &block, const Body &body) {
    if constexpr (fixed > 0) {
        body(k, false);
        if constexpr (k + 1 < fixed) go_up<fixed, k + 1>(block, body);
    } else {
        long i = 0;
        for (; i + 2 <= block.n_min; i += 2) {
            body(i, false);
            body(i + 1, false);
        }
        for (; i < block.n_min; ++i) body(i, false);
        for (; i < block.n; ++i) body(i, true);
    }
}

// Calls two(k), for bonds k and k - 1, down to the first bond, and one(k) for a bond without partner. The pairs don't
// depend on the length of the block.
template <int fixed, int k = fixed - 1, class One, class Two>
HOL_INLINE void go_down(const Block &block, const One &one, const Two &two) {
    if constexpr (fixed > 0) {
        if constexpr (k % 2 == 0)
            one(k);
        else
            two(k);
        if constexpr (k > 1) go_down<fixed, k - (k % 2 == 0 ? 1 : 2)>(block, one, two);
    } else {
        long i = block.n - 1;
        if (i % 2 == 0) one(i--);
        for (; i >= 3; i -= 4) {
            two(i);
            two(i - 2);
        }
        if (i > 0) two(i);
    }
}

// Gives the bond vectors as the corrections `step` have moved them, one after the other.
template <Same masses>
struct Mover {
    vec3 pull, left;  // of the last bond, and the displacement of the atom behind it
    explicit HOL_FORCED Mover(const Newton &x) : pull(x.step[0] * x.b[0]), left(times_w<masses>(x, 0, pull)) {}
    HOL_FORCED vec3 bond(const Newton &x, long k) {
        const vec3 p = x.step[k + 1] * x.b[k + 1], right = times_w<masses>(x, k + 1, p - pull);
        const vec3 d = x.D[k] + (right - left);
        pull = p;
        left = right;
        return d;
    }
};

// D.D - a^2 of bond k, and its largest size, relative to a^2 if that differs among the bonds.
template <Same a>
HOL_INLINE vec length_error(const Newton &x, long k, bool ragged, const vec3 &d, vec &worst) {
    const bool all = a == same || (a == either && !x.a2);
    const vec a2 = all ? x.a2_uniform : x.a2[k];
    vec sigma = excess(d, a2);
    if (ragged) sigma = keep(live(x, k), sigma);
    worst = max(a == same ? abs(sigma) : abs(sigma) * (all ? x.per_a2_uniform : x.per_a2[k]), worst);
    return sigma;
}

template <Same a>
HOL_INLINE vec relative_error(const Newton &x, vec worst) {
    return a == same ? worst * x.per_a2_uniform : worst;
}

// Largest |D.D - a^2| / a^2; max() may lose a NaN, the sum y over all bonds keeps it.
template <Same a>
HOL_INLINE vec largest_error(const Newton &x, vec worst, vec y) {
    return mul_add(y, vec{}, relative_error<a>(x, worst));
}

enum FactorsOf { first_factors, renewed_factors, extended_factors };

// Eliminates with the Jacobian at D and substitutes forward. Returns the largest error. E is a fraction over four
// bonds, as in Sweep.
//   first_factors    D is as it was loaded; all lanes get factors
//   renewed_factors  D moved by the corrections so far; the lanes in `which` get factors
//   extended_factors  D as it stands; the lanes in `which`; a division per bond, and nothing that cancels
template <Same masses, Same a, FactorsOf factors, int fixed = 0>
HOL_INLINE vec eliminate(const Block &block, const Newton &x, mask which) {
    constexpr bool moved = factors == renewed_factors, all = factors == first_factors,
                   extended = factors == extended_factors;
    const long n = fixed > 0 ? fixed : block.n;
    Mover<masses> mover(x);
    vec3 d = moved ? mover.bond(x, 0) : x.D[0];
    vec worst = {}, y = {}, down = {}, last = {}, q = dot(d, x.b[0]);
    Fraction e = {times_w<masses>(x, 0, q), splat(1.0)};
    const auto bond = [&](long k, bool ragged) HOL_FORCED {
        ChainRow &row = x.row[k];
        const vec F1 = e.next(times_w<masses>(x, k + 1, q)), rF = splat(1.0) / F1, rP = e.F * rF;
        row.half_rP = all ? 0.5 * rP : select(which, 0.5 * rP, row.half_rP);
        row.down = down = all ? down : select(which, down, row.down);
        y = mul_add(down, y, length_error<a>(x, k, ragged, moved ? d : x.D[k], worst));
        row.u = y * row.half_rP;
        if (ragged || k + 1 == n) last = last + q;  // y knows nothing of a chain's last b, which must be a number, too
        if (k + 1 == n) {
            row.up = vec{};
            return;
        }
        const vec3 d1 = moved ? mover.bond(x, k + 1) : x.D[k + 1], b1 = x.b[k + 1];
        if (!moved) d = x.D[k];
        const vec q1 = dot(d1, b1);
        const vec lower = dot(d1, x.b[k]), upper = dot(b1, d);
        vec X = extended ? dot(cross(d, d1), cross(x.b[k], b1)) : mul_add(q, q1, -(lower * upper));
        const vec wP = times_w<masses>(x, k + 1, rP);
        vec up = wP * upper;
        down = wP * lower;
        if (ragged) {  // the last pivot of a chain may be 0: no product with its reciprocal
            const mask m = live(x, k + 1);
            up = keep(m, up);
            down = keep(m, down);
            X = keep(m, X);
        }
        row.up = all ? up : select(which, up, row.up);
        e.pass(F1, times_w<masses>(x, k + 1, times_w<masses>(x, k + 1, X)), times_w<masses>(x, k + 1, q1));
        if (extended || (k & 3) == 3) e = {e.A * rF, splat(1.0)};
        q = q1;
        if (moved) d = d1;
    };
    if constexpr (fixed > 0) {
        go_up<fixed>(block, bond);
    } else {
        long k = 0;
        if (!extended)
            for (; k + 4 < block.n_min; k += 4) {
                bond(k, false);
                bond(k + 1, false);
                bond(k + 2, false);
                bond(k + 3, false);
            }
        for (; k < n; ++k) bond(k, k + 1 >= block.n_min);
    }
    return largest_error<a>(x, worst, y + last);
}

// The same for chains of any length, masses and lengths, so that the common case stays short.
vec renew(const Block &, const Newton &, FactorsOf, mask which);
template <Same masses, Same a, int fixed>
HOL_NOINLINE vec renew(const Block &block, const Newton &x, mask which) {
    return eliminate<masses, a, renewed_factors, fixed>(block, x, which);
}

// Moves the bonds by the corrections `step` and substitutes forward the errors that their lengths have then. Returns
// the largest. `keep_bonds`: D becomes the moved bonds. `fetch`: nullptr, or atoms of this block; those of the next
// block are fetched meanwhile.
template <Same masses, Same a, bool keep_bonds, int fixed = 0>
HOL_INLINE vec correct(const Block &block, const Newton &x, const double *fetch) {
    Mover<masses> mover(x);
    vec worst = {}, y = {};
    go_up<fixed>(block, [&](long k, bool ragged) HOL_FORCED {
        if (!keep_bonds && fixed == 0 && k % 2 == 0 && fetch) fetch_ahead<2>(fetch, k, block.ahead);
        const vec3 d = mover.bond(x, k);
        if (keep_bonds) {
            const mask m = live(x, k);
            x.D[k] = {select(m, d.x, x.D[k].x), select(m, d.y, x.D[k].y), select(m, d.z, x.D[k].z)};
        }
        y = mul_add(x.row[k].down, y, length_error<a>(x, k, ragged, d, worst));
        x.row[k].u = y * x.row[k].half_rP;
    });
    return largest_error<a>(x, worst, y);
}

// Goes down the chain and adds the corrections to tau, which is 0 the first time. `all`: in all lanes, else in `which`.
template <int fixed>
HOL_INLINE void substitute_back(const Block &block, const Newton &x, bool first, bool separate, bool all, mask which) {
    vec t = {};
    const auto add = [&](long k, vec correction) HOL_FORCED {
        const vec change = all ? correction : keep(which, correction);
        if (separate) x.step[k] = change;
        x.tau[k] = first ? change : x.tau[k] + change;
    };
    // Two bonds wait for the one behind them together, by the product of their factors.
    go_down<fixed>(
        block,
        [&](long k) HOL_FORCED {
            t = mul_add(x.row[k].up, t, x.row[k].u);
            add(k, t);
        },
        [&](long k) HOL_FORCED {
            const ChainRow &a = x.row[k], &b = x.row[k - 1];
            const vec up = a.up, u = a.u, both = b.up * up, sum = mul_add(b.up, u, b.u);
            add(k, mul_add(up, t, u));
            t = mul_add(both, t, sum);
            add(k - 1, t);
        });
}

// What is rarer, for chains of any length, masses and lengths (newton/solve.cpp). The largest error alone:
vec residuals(const Block &, const Newton &);
// correct(), where D becomes the moved bonds:
vec correct_bonds(const Block &, const Newton &);
// Back in some of the lanes:
void substitute_back_in(const Block &, const Newton &, bool first, bool separate, mask which);

}  // namespace holonomic::HOL_ISA
