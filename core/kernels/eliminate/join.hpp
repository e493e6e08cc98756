// The elimination of a long chain block by block, and the solution at the separators (segment.hpp).
#ifndef HOLONOMIC_KERNELS_ELIMINATE_JOIN_HPP
#define HOLONOMIC_KERNELS_ELIMINATE_JOIN_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/eliminate/segment.hpp"

namespace holonomic::HOL_ISA {

static inline void add_stretching(const Block &own, const double *strain, const vec3 *D, vec *B) {
    for (long k = 0; k < own.n; ++k) B[k] = B[k] + keep(joint(own, k), stretching(strain, D[k]));
}

// Loads block j and eliminates its inner bonds. `strain` is added to rates, or nullptr.
template <int terms, bool uniform>
static inline void eliminate_block_of(const Box &box, const SegmentBlock &s, const Packed &r, const Packed &v,
                                      const Packed &f, bool careful, const SegmentStore &x, Arena arena,
                                      const double *strain) {
    const bool boxed = box.shape != Box::none;
    const long n = s.own_max;
    SegmentBonds in = {r, v, f, nullptr, nullptr, nullptr, {}, {}, 0};
    find_next(s, box, r, in);
    Block own = own_block(s);
    vec3 *const D = reinterpret_cast<vec3 *>(arena.vecs(3 * (n + W))), *const low = reinterpret_cast<vec3 *>(
                                                                           arena.vecs(3 * (n + W)));
    vec *const B = arena.vecs(n + W);
    const Source source = {&in.r, nullptr, nullptr, &box, s.block.len};
    in.D = D;
    in.low = low;
    in.B = B;
    if (careful) {
        choose([&](auto has_box) { load_bonds<terms, uniform, has_box, true>(own, box, r, v, f, D, low, B); }, boxed);
        if (strain) add_stretching(own, strain, D, B);
        eliminate<in_scratch, uniform, true>(s.block, box, source, in, n, x);
        return;
    }
    in.full = s.own_min / group * group;
    if (boxed || strain) {
        if (boxed)
            load_bonds<terms, uniform, true, false>(own, box, r, v, f, D, low, B);
        else
            load_bonds<terms, uniform, false, false>(own, box, r, v, f, D, low, B);
        if (strain) add_stretching(own, strain, D, B);
        eliminate<in_scratch, uniform, false>(s.block, box, source, in, n, x);
        return;
    }
    if (in.full < n) load_tail<terms, uniform>(own, box, r, v, f, in.full, D, B);
    eliminate<terms, uniform, false>(s.block, box, source, in, n, x);
}

template <int terms>
static inline void eliminate_block(const Box &box, const Cut &cut, const Lane &lane, int64_t j, const AtomArray &r,
                                   const AtomArray &v, const AtomArray &f, bool careful, double *store, Arena arena,
                                   const double *strain = nullptr) {
    SegmentBlock s = segment_block(cut, j, lane);
    set_masses(s.block, s.lane, arena);
    // All are in place or none is, so that the segments are equally far apart in each array.
    const Packed pr = open(r, s.block, s.lane, arena, true), pv = open(v, s.block, s.lane, arena, true);
    const Packed pf = open(f, s.block, s.lane, arena, true);
    const SegmentStore x(store, cut, j);
    choose([&](auto uniform) { eliminate_block_of<terms, uniform>(box, s, pr, pv, pf, careful, x, arena, strain); },
           s.block.uniform_w);
    if (x.past_cache) settle_stores();
}

// The rounding of the X of nearly parallel bonds reaches E' through a. With a = sum alpha_j X_j, its error is about
// 2 eps sqrt(a sum alpha_j q_j q_{j+1} / n) <= 2 eps sqrt(a w_max q c), because sum alpha_j q_j q_{j+1} <= n w_max q c;
// it is harmless where that is below join_tolerance S, S = E_free E + a.
constexpr double join_tolerance = 8;
HOL_INLINE bool is_doubtful_join(const Summary &s, int i, double S) {
    return !(4 * s.a[i] * s.span[i] * s.c[i] <= join_tolerance * join_tolerance * S * S);
}

// Solves for the separators. `careful` says how the segments were eliminated.
static inline JoinResult long_join(const Lane &lane, bool careful, double *store) {
    const Cut cut(lane.n_bonds);
    Summary *const all = SegmentStore(store, cut, 0).summary;
    double E = 0, y = 0;
    for (int64_t j = 0; j < cut.blocks; ++j) {
        Summary &s = all[j];
        if (j == 0) E = relative_w(lane, 0) * s.q[0];
        if (any(s.doubt)) return careful ? join_bad : join_doubtful;
        for (int i = 0; i < W; ++i) {
            const double P = E + s.c[i], yhat = (y + s.b[i]) + s.T[i], S = s.E[i] * E + s.a[i];
            if (!careful && is_doubtful_join(s, i, S)) return join_doubtful;
            s.t[i] = yhat / P;
            s.up[i] = s.f[i] / P;
            E = S / P;
            y = s.y[i] + s.up[i] * yhat;
        }
    }
    double t = 0;
    for (int64_t j = cut.blocks - 1; j >= 0; --j) {
        Summary &s = all[j];
        for (int i = W - 1; i >= 0; --i) {
            t = j == cut.blocks - 1 && i == W - 1 ? s.t[i] : s.t[i] + s.up[i] * t;
            s.t[i] = t;
            if (!(t - t == 0)) return careful ? join_bad : join_doubtful;
        }
    }
    return join_good;
}

}  // namespace holonomic::HOL_ISA
#endif
