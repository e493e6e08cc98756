// One long chain, W segments at a time. The first bond of a segment is its separator; the others are eliminated as a
// chain that starts free behind it, and what they leave is carried along with the same pivots (theory (20)-(23)):
//
//     start      f = w g,  a = w^2 X,  c = w q_s,  T = 0            (of the separator and its neighbour)
//     each bond  c' = (a + w q_k c) / P_k,  a' = w (q_{k+1} a + w X_{k+1} c) / P_k,  f' = l f,  T += f u_k
//
// c is what a segment leaves at its left joint, E and y what it leaves at its right one, f the coupling of the two and
// a = E c - f^2. Joining from left to right again adds only what is not negative:
//
//     P^ = E + c,  y^ = y + T,  E' = (E_free E + a) / P^,  y' = y_free + (f / P^) y^,
//     backwards t_s = y^ / P^ + (f / P^) t_s',  inside t_k = u_k + (f / P)_k t_s + l_{k+1} t_{k+1}.
//
// (E, 1) and (a, c) are two solutions of one linear recursion, so that the fractions of the ordinary sweep do for both.
#pragma once

#include "core/kernels/arithmetic/thresholds.hpp"
#include "core/kernels/eliminate/joint.hpp"
#include "core/kernels/memory/cut.hpp"
#include "core/kernels/memory/load.hpp"
#include "core/kernels/memory/prefetch.hpp"

namespace holonomic::HOL_ISA {

// What the elimination of the inner bonds of W segments leaves, and the solution at their separators.
struct Summary {
    vec E, y, a, c, f, T;  // y without the right-hand side of the separator behind
    vec q, b;              // of the separators: d.d and the right-hand side
    vec span, reach;       // largest w times the last q, times the separator's: see is_flagged_join()
    vec w_max, q_max;
    vec t, up;  // at the separators: y^ / P^, then t; f / P^
    mask flag;
};

// What the elimination keeps of a bond for the substitution: u = y / P, the multiplier of the joint behind it, f / P.
struct SegmentBond {
    vec u, l, fP;
};

// So many bonds, of 96 bytes each, behind a block drive what is kept of it out of any cache before it is read.
constexpr int64_t bonds_past_cache = 262144;

struct SegmentStore {
    Summary *summary;  // of all blocks; inside a molecule one more, for the separator behind the last segment
    SegmentBond *kept;
    bool past_cache;
    SegmentStore(double *store, const Cut &cut, int64_t block)
        : summary(reinterpret_cast<Summary *>(store) + block),
          kept(reinterpret_cast<SegmentBond *>(reinterpret_cast<Summary *>(store) + cut.blocks + cut.inside) +
               cut.first_row(block)),
          past_cache(cut.n_bonds + cut.bonds_behind - W * cut.first_row(block) > bonds_past_cache) {}
    HOL_FORCED void keep_bond(long k, const SegmentBond &bond) const {
        if (!past_cache) {
            kept[k] = bond;
            return;
        }
        store_past_cache(&kept[k].u, bond.u);
        store_past_cache(&kept[k].l, bond.l);
        store_past_cache(&kept[k].fP, bond.fP);
    }
};

static inline int64_t long_bytes(int64_t n_bonds) {
    const Cut cut(n_bonds);
    return cut.blocks * static_cast<int64_t>(sizeof(Summary)) +
           cut.first_row(cut.blocks) * static_cast<int64_t>(sizeof(SegmentBond));
}

// Products of six pivots, of which a consists after four bonds, underflow where the reciprocal of four of them is not
// below the first of these; products of three, where that of one is not below the second.
constexpr double largest_reciprocal_of_four = 1e190, largest_reciprocal_of_one = 1e90;

// The elimination of the inner bonds of W segments, a bond at a time.
struct Elimination {
    vec q;            // of the bond that is to be eliminated
    Fraction e, ac;   // E = A / F; a and c, in the same units of 1 / F
    vec rF, f, y, T;  // 1 / F; f is in its units, too
    vec w_max, q_max, margin;
    vec largest_rF, least_rF;
};

// From a separator and the bond behind it, whose right-hand side is b1.
template <bool uniform>
HOL_INLINE void start(Elimination &e, const Block &block, vec q0, const JointProducts &j, vec b1) {
    const vec w = w_at<uniform>(block, 1);
    e.q = j.q;
    e.e = {w * e.q, splat(1.0)};
    e.rF = splat(1.0);
    e.ac = {(w * w) * j.X, w * q0};
    e.y = b1;
    e.f = w * j.g;
    e.T = e.margin = e.largest_rF = vec{};
    e.least_rF = splat(1.0);
    e.w_max = w;
    e.q_max = max(q0, j.q);
}

// In a straight chain c, f and E shrink by the same factor at each bond. They are rounded in the same way, so that
// their ratios stay exact: segments of equal bonds would all have the same error in them.
HOL_INLINE void normalise(Elimination &e) {
    e.f = e.f * e.rF;
    e.e = {e.e.A * e.rF, splat(1.0)};
    e.ac = {e.ac.A * e.rF, e.ac.F * e.rF};
    e.largest_rF = max(e.largest_rF, e.rF);
    e.least_rF = min(e.least_rF, e.rF);
}

// What a segment leaves at its left joint, once that no longer changes. All further bonds together take at most
// n f^2 / E of c, n bonds being left; but the roundings of as many products would add up in it, and they are alike
// where bonds are alike.
struct Settled {
    mask which = none();
    vec c = {};
    // After normalise().
    void look(const Elimination &e) {
        const mask now = less(e.f * e.f, 0x1p-64 * (e.e.A * e.ac.F)) & ~which;
        c = select(now, e.ac.F, c);
        which = which | now;
    }
};

// Eliminates bond k; j is the joint behind it and b1 the right-hand side behind that. ragged: lanes may end there.
template <bool uniform, bool extended>
HOL_INLINE void step(Elimination &e, const Block &block, const SegmentStore &x, long k, const JointProducts &j, vec b1,
                     bool ragged) {
    const vec w = w_at<uniform>(block, k + 1);
    const vec wq = w * e.q, F1 = e.e.next(wq), c1 = e.ac.next(wq);
    vec left = {};
    if (!extended) left = spare(e.e, F1, spare_of_cross_products);
    e.rF = splat(1.0) / F1;
    const vec rP = e.e.F * e.rF, fP = e.f * e.rF, wwX = (w * w) * j.X, wq1 = w * j.q;
    vec wg = w * j.g;
    const mask live = ragged ? joint(block, k + 1) : none();
    if (ragged) wg = keep(live, wg);
    const vec l = wg * rP;
    x.keep_bond(k, {e.y * rP, l, fP});
    e.T = mul_add(fP, e.y, e.T);
    e.y = mul_add(l, e.y, b1);
    e.f = wg * e.f;
    e.e.pass(F1, wwX, wq1);
    e.ac.pass(c1, wwX, wq1);
    if (ragged) {
        e.e.A = keep(live, e.e.A);
        e.ac.A = keep(live, e.ac.A);
        left = keep(live, left);
    }
    if (!extended) e.margin = min(e.margin, left);
    if (!uniform) e.w_max = max(e.w_max, ragged ? keep(live, w) : w);  // inert bonds have masses of their own
    e.q = j.q;
    e.q_max = max(e.q_max, ragged ? keep(live, j.q) : j.q);
}

// Loads W segments, stage by stage, and eliminates their inner bonds: a group at a time where all have these bonds,
// with one quick test for all of it, then one at a time. block.len counts the separators behind them; `in` reads the
// segments alone.
template <bool uniform, bool extended>
HOL_NOINLINE void eliminate(const SegmentBlock &s, const Reader &in, const SeparatorsBehind &behind,
                            const SegmentStore x) {  // by value: stores don't change it
    const Block &block = s.block;
    const Source source = {&in.box, in.r, nullptr, nullptr, nullptr, 0, block.len};
    const long n = s.own_max, grouped = extended ? 0 : s.own_min / group * group;
    vec3 D[stage_bonds + 2 + W], low[extended ? stage_bonds + 2 + W : 1];  // D[0]: the last one of the stage before
    vec B[stage_bonds + 1 + W];
    Elimination e = {};
    Settled settled;
    mask flag = none();
    vec E0 = {};
    // Joints that have failed the cheap test, of m joints of bonds from d on. E0: E before the first, that of bond k.
    const auto look = [&](const vec3 *d, long k, long m) HOL_FORCED {
        const mask short_of = less(e.margin, vec{});
        if (extended || __builtin_expect(!any(short_of), 1)) return;
        flag = flag | (flagged_joints<uniform>(block, d, k, m, E0) & short_of);
        e.margin = vec{};
    };
    for (long k0 = 0; k0 < n; k0 += stage_bonds) {
        long end = k0 + stage_bonds < n ? k0 + stage_bonds : n, k = k0;
        in.load(k0, end, D + 1, extended ? low + 1 : nullptr, B);
        if (end == n) {
            D[1 + n - k0] = behind.d;
            if (extended) low[1 + n - k0] = behind.low;
            B[n - k0] = vec{};
            ++end;
        }
        while (k < end) {
            for (; k >= group && k < grouped && k < end; k += group) {
                const vec3 *const d = D + (k - k0);  // bonds k - 1, k ..
                const vec *const b = B + (k - k0);
                JointProducts j[group];
                plain_joints<group>(source, k - 1, d, j);
                E0 = e.e.A;
#pragma GCC unroll 8
                for (int i = 0; i < group; ++i) {
                    step<uniform, false>(e, block, x, k + i - 1, j[i], b[i], false);
                    if (i % 4 == 3) normalise(e);
                }
                look(d, k, group);
            }
            if (k == end) break;
            const vec3 *const d = D + (k - k0), *const l = extended ? low + (k - k0) : nullptr;
            const vec *const b = B + (k - k0);
            const bool alone = k >= grouped;  // else of the first group
            JointProducts j;
            if (k == 0) {
                x.summary->q = dot(d[1], d[1]);
                x.summary->b = b[0];
            } else if (extended) {
                j = extended_joint(d[0], l[0], d[1], l[1]);
            } else {
                plain_joints<1>(source, k - 1, d, &j);
            }
            if (k == 1) {
                start<uniform>(e, block, x.summary->q, j, b[0]);
                E0 = e.e.A;
            } else if (k > 1) {
                // The last joint is masked in the chain's last segment, others where that ends.
                if (alone) E0 = e.e.A;
                step<uniform, extended>(e, block, x, k - 1, j, b[0], true);
                if (alone || k % 4 == 3) normalise(e);
                if (alone)
                    look(d, k, 1);
                else if (k == group - 1)
                    look(D + 2, 2, group - 2);
            }
            ++k;
        }
        settled.look(e);
        D[0] = D[end - k0];
        if (extended) low[0] = low[end - k0];
    }
    Summary &sum = *x.summary;
    sum.E = e.e.A;
    sum.c = select(settled.which, settled.c, e.ac.F);
    sum.a = select(settled.which, e.e.A * settled.c, e.ac.A);
    sum.y = e.y;
    sum.f = e.f;
    sum.T = e.T;
    sum.span = e.w_max * e.q;
    sum.w_max = e.w_max;
    sum.q_max = e.q_max;
    sum.reach = uniform ? vec{} : e.w_max * sum.q;
    sum.flag = flag | ~less(e.largest_rF, splat(extended ? largest_reciprocal_of_one : largest_reciprocal_of_four)) |
               ~less(vec{}, e.least_rF);
}

// The rounding of the X of nearly parallel bonds reaches E' through a. With a = sum alpha_j X_j over n joints, its
// error is about 2 eps sqrt(a sum alpha_j q_j q_{j+1} / n) <= 2 eps sqrt(a w_max q c), q being the last of them; it is
// harmless where that is below join_tolerance S, S = E_free E + a. The sum A = sum alpha_j q_j q_{j+1} is at most n
// w_max q c by induction: it starts as w_s^2 q_s q_1 = w_s q_1 c, and a bond makes A' = w_k q_{k+1} (A + w_k q_k c) /
// P_k of it, while c' >= w_k q_k c / P_k by (21); so A' <= w_k q_{k+1} (n + 1) w_max q_k c / P_k <= (n + 1) w_max
// q_{k+1} c'.
//
// It reaches c, too, and there no test of the segment's own E sees it: a light atom in a straight joint just behind the
// separator, say. Seen from the far end, c is an effective inverse mass E' as any other, and its error at most 2 eps
// sqrt(w_max q_s c), q_s being the separator's. It is harmless where that is below join_tolerance sum, `sum` being what
// c is added to, c itself included, or times `factor`. With equal masses c >= w q_s / n, which is enough.
HOL_INLINE bool is_flagged_join(const Summary &s, int i, double S, double sum, double factor) {
    constexpr double most = join_tolerance * join_tolerance;
    return !(4 * s.a[i] * s.span[i] * s.c[i] <= most * S * S) ||
           !(s.reach[i] * s.c[i] * (factor * factor) <= most * (sum * sum));
}

// What is to be written of W segments.
struct SegmentOutputs {
    Packed pulls;  // per atom
    bool has_pulls;
    double *lambda, *tension;
    vec lambda_factor;
    double virial_factor;
    bool virial;
};

// Loads block j and eliminates its inner bonds. `terms`: of the right-hand sides; `strain` is added to rates, or
// nullptr.
void eliminate_block(int terms, const Box &, const Cut &, const Lane &, int64_t j, const AtomArray &r,
                     const AtomArray &v, const AtomArray &f, bool extended, double *store, const Arena &,
                     const double *strain = nullptr);

// Substitutes in block j and writes; `pulled` gets what its atoms are pulled with, times w_i if `weighted`.
void finish_block(bool weighted, const Box &, const AtomArray &r, const AtomArray &pulled, bool add,
                  const SegmentOutputs &, const Cut &, const Lane &, int64_t j, double *store, const Arena &, Tally &);

}  // namespace holonomic::HOL_ISA
