// Metric of one long chain: the lanes are its segments. The map from e of one bond to that of the next, and from f of
// one bond to that of the bond before, is a fraction of linear functions with coefficients that are not negative, so
// that the maps of whole segments are found without a subtraction; then each segment goes on as a chain of its own.
//
// Theory (32):
//     e_k = ((delta_k + p_k) e_{k-1} + delta_k p_k) / (e_{k-1} + p_k),   R_k = f_k - delta_k:  the mirror image
//
// A lane's window has a bond more on the left of its segment and two more on the right, so that the forces on its atoms
// need nothing from other lanes.
#ifndef HOLONOMIC_KERNELS_VERBS_METRIC_LONG_HPP
#define HOLONOMIC_KERNELS_VERBS_METRIC_LONG_HPP

#include "core/kernels/eliminate/deficits.hpp"
#include "core/kernels/memory/cut.hpp"
#include "core/kernels/memory/packed.hpp"

namespace holonomic {
namespace HOL_ISA {

// e' = (a e + b) / (e + d)
struct Map {
    vec a, b, d;
    // This map after which that of bond k follows.
    inline HOL_FORCED Map then(vec delta, vec p) const {
        const vec r = splat(1.0) / (a + p), both = delta + p, product = delta * p;
        return {mul_add(both, a, product) * r, mul_add(both, b, product * d) * r, mul_add(p, d, b) * r};
    }
};

HOL_INLINE Map select(mask m, const Map &x, const Map &y) {
    return {select(m, x.a, y.a), select(m, x.b, y.b), select(m, x.d, y.d)};
}

struct MetricSummary {
    Map forward, mirrored;  // of e from the window's first bond to the one before the next window's; of R, two bonds on
    vec delta;              // of the bond to which f_end belongs
    vec e_start, f_end;     // of the first bond and of the last one of which f is needed
    mask short_of_one;      // f_end is that of the window before, too: the chain's last segment has two bonds
    mask bad;
};

HOL_INLINE MetricSummary &metric_summary(double *store, int64_t j) {
    return reinterpret_cast<MetricSummary *>(store)[j];
}

// Window of each lane: bonds first-1 .. first+own+2 of the chain, as far as they exist.
struct MetricWindow {
    SegmentBlock s;
    vec own_first, own_end;  // the segment's own bonds in the window
    vec f_at;                // the second bond behind them, or the last one of the chain: place of f_end
};

static inline MetricWindow metric_window(const Cut &cut, int64_t j, const Lane &lane) {
    MetricWindow x;
    x.s = segment_block(cut, j, lane);
    Block &block = x.s.block;
    block.n = 0;
    block.n_min = cut.longest() + 4;
    for (int i = 0; i < W; ++i) {
        const long before = x.s.from[i] > 0 ? 1 : 0, end = before + x.s.own[i];
        x.s.from[i] -= before;
        const int64_t left = lane.n_bonds - x.s.from[i];
        block.len[i] = static_cast<long>(end + 3 < left ? end + 3 : left);
        block.n = block.len[i] > block.n ? block.len[i] : block.n;
        block.n_min = block.len[i] < block.n_min ? block.len[i] : block.n_min;
        x.own_first[i] = static_cast<double>(before);
        x.own_end[i] = static_cast<double>(end);
        x.f_at[i] = static_cast<double>(end + 1 < left ? end + 1 : left - 1);
    }
    return x;
}

HOL_INLINE mask equal(long k, vec place) { return equal(splat(static_cast<double>(k)), place); }

template <bool uniform>
static inline void measure_window(const MetricCall &call, const Lane &lane, MetricWindow &x, const Geometry &g,
                                  Arena &arena) {
    const Packed r = open_segments(call.r, x.s, lane, arena, true), absent = {};
    if (call.box.shape != Box::none)
        load_bonds<none_, uniform, true, true>(x.s.block, call.box, r, absent, absent, g.u, g.low, g.t);
    else
        load_bonds<none_, uniform, false, true>(x.s.block, call.box, r, absent, absent, g.u, g.low, g.t);
    measure<uniform>(x.s.block, g);
}

template <bool uniform>
static inline void map_window(const MetricCall &call, const Lane &lane, MetricWindow &x, Arena arena,
                              MetricSummary &sum) {
    const Block &block = x.s.block;
    const Geometry g(block.n, arena);
    measure_window<uniform>(call, lane, x, g, arena);
    const vec headroom = splat(call.force.x ? call.kT * 0x1p300 : 0.0);
    mask good = first_lanes(W);
    Map forward = {}, mirrored = {};
    for (long k = 0; k < block.n; ++k) {
        good = good & less(vec{}, w_at<uniform>(block, k) + w_at<uniform>(block, k + 1)) &
               finite(g.reciprocal[k] + headroom * g.reciprocal[k]);
        const vec delta = g.delta[k], p = g.p[k];
        if (k > 0) forward = k > 1 ? forward.then(delta, p) : Map{delta + p, delta * p, p};
        if (k > 2) mirrored = k > 3 ? mirrored.then(delta, p) : Map{delta + p, delta * p, p};
        if (any(equal(k + 1, x.own_end))) sum.forward = select(equal(k + 1, x.own_end), forward, sum.forward);
        if (any(equal(k, x.f_at))) {
            sum.mirrored = select(equal(k, x.f_at), mirrored, sum.mirrored);
            sum.delta = select(equal(k, x.f_at), delta, sum.delta);
        }
    }
    sum.short_of_one = equal(2, x.f_at);
    sum.e_start = g.delta[0];  // right for the chain's first segment; the others get theirs when they are joined
    sum.bad = ~good;
}

// Forces on the atoms behind each own bond, and on atom 0 of the chain.
static inline void store_window_forces(const MetricCall &call, const Lane &lane, const MetricWindow &x,
                                       const Geometry &g) {
    const AtomArray &force = call.force;
    for (int i = 0; i < W; ++i) {
        const long first = static_cast<long>(x.own_first[i]), end = static_cast<long>(x.own_end[i]);
        for (long k = first == 0 ? 0 : first + 1; k <= end; ++k) {
            double value[3] = {0, 0, 0};
            for (int side = 0; side < 2; ++side) {  // the bond that ends at the atom, the one that starts there
                const long b = k - 1 + side;
                if (b < 0 || b >= x.s.block.len[i]) continue;
                const vec3 phi = g.u[b];
                const double t = side == 0 ? -g.t[b][i] : g.t[b][i];
                value[0] += t * phi.x[i];
                value[1] += t * phi.y[i];
                value[2] += t * phi.z[i];
            }
            unstage(force, lane, x.s.from[i] + k, 0, value, call.add);
        }
    }
}

template <bool uniform>
static inline void finish_window(const MetricCall &call, const Lane &lane, MetricWindow &x, Arena arena,
                                 const MetricSummary &sum, Tally &tally) {
    const Block &block = x.s.block;
    const Geometry g(block.n, arena);
    measure_window<uniform>(call, lane, x, g, arena);
    mask good = first_lanes(W);
    const MetricSums sums = eliminate_metric<uniform>(block, g, sum.e_start, x.own_first, x.own_end, call, good);
    tally.log_det += sum_lanes(sums.log_det);
    tally.log_det_z += sum_lanes(sums.log_det_z);
    if (!call.force.x) return;
    vec f = splat(1.0);  // anything positive, until f_end is reached
    for (long k = block.n - 1; k > 0; --k) {
        f = select(equal(k, x.f_at), sum.f_end, f);
        weigh_normal<uniform>(block, g, k, f);
        turn(g, k, call.kT);
        f = next_deficit(g, k, f);
    }
    turn(g, 0, call.kT);
    store_window_forces(call, lane, x, g);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
