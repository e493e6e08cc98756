// What Newton's method has found, to and from the caller's arrays: a guess, moves, multipliers, the worst bond, the
// virial.
#ifndef HOLONOMIC_KERNELS_NEWTON_OUTPUTS_HPP
#define HOLONOMIC_KERNELS_NEWTON_OUTPUTS_HPP

#include "core/kernels/memory/sink.hpp"
#include "core/kernels/newton/sweeps.hpp"

namespace holonomic {
namespace HOL_ISA {

static inline void load_guess(const Block &block, const PositionsCall &call, const Newton &x) {
    const vec factor = (2 * call.dt * call.dt) * block.unit;
    for (int i = 0; i < W; ++i) {
        const int lane = i < block.lanes ? i : 0;
        for (long k = 0; k < block.n; ++k)
            x.tau[k][i] = k < block.len[i] ? factor[i] * call.lambda[block.first_bond[lane] + k] : 0.0;
    }
}

// Moves the atoms `first` .. n of the lanes in `which` by w_i (tau_{i+1} b_{i+1} - tau_i b_i), and changes their
// velocities by `per_dt` times that: either, or both. `before` is tau b of the bond before the first atom.
template <bool uniform_w, bool to_r, bool to_v>
static inline void store_moves(const Block &block, const Newton &x, mask which, const Packed &r, const Packed &v,
                               double per_dt, long first = 0, vec3 before = vec3{}) {
    const unsigned chosen = bits(which & block.in_use());
    const vec *const tau = x.tau;
    const vec3 *const b = x.b;
    const auto move = [&](long k, vec *value) HOL_FORCED {
        const vec3 after = times(tau[k], b[k]), m = times_w<uniform_w>(x, k, minus(after, before));
        value[0] = m.x;
        value[1] = m.y;
        value[2] = m.z;
        before = after;
    };
    long k0 = first;
    if (chosen == (1u << W) - 1) {
        const vec rate = splat(per_dt);
        for (; k0 + W <= block.n_min; k0 += W) {
            vec value[3 * W];
            for (int a = 0; a < W; ++a) move(k0 + a, value + 3 * a);
            for (int j = 0; j < 3; ++j) {
                transpose(value + j * W);
                for (int i = 0; i < W; ++i) {
                    const long e = 3 * k0 + j * W;
                    if (to_r) store(r.lane[i] + e, load(r.lane[i] + e) + value[j * W + i]);
                    if (to_v) store(v.lane[i] + e, mul_add(value[j * W + i], rate, load(v.lane[i] + e)));
                }
            }
        }
    }
    for (; k0 <= block.n; ++k0) {
        vec value[3];
        move(k0, value);
        for (int i = 0; i < block.lanes; ++i) {
            if (!(chosen >> i & 1) || k0 > block.len[i]) continue;
            for (int c = 0; c < 3; ++c) {
                const long e = 3 * k0 + c;
                if (to_r) r.lane[i][e] = r.lane[i][e] + value[c][i];
                if (to_v) v.lane[i][e] = mul_add(value[c][i], per_dt, v.lane[i][e]);
            }
        }
    }
}

// Writes tau times a factor of the lanes in `which`; zeros as +0.
static inline void store_multipliers(const Block &block, const Newton &x, vec factor, mask which, double *out) {
    const unsigned chosen = bits(which & block.in_use());
    double *p[W];
    for (int i = 0; i < block.lanes; ++i) p[i] = out + block.first_bond[i];
    long k0 = 0;
    if (chosen == (1u << W) - 1)
        for (; k0 + W <= block.n_min; k0 += W) {
            vec m[W];
            for (int a = 0; a < W; ++a) m[a] = mul_add(x.tau[k0 + a], factor, vec{});
            transpose(m);
            for (int i = 0; i < W; ++i) store(p[i] + k0, m[i]);
        }
    for (; k0 < block.n; ++k0) {
        const vec value = mul_add(x.tau[k0], factor, vec{});
        for (int i = 0; i < block.lanes; ++i)
            if ((chosen >> i & 1) && k0 < block.len[i]) p[i][k0] = value[i];
    }
}

// The first bond of a lane with this error.
template <bool uniform_w, bool uniform_a>
HOL_NOINLINE long worst_bond(const Block &block, const Newton &x, int lane, double error) {
    Mover<uniform_w> mover = Mover<uniform_w>::start(x);
    long k = 0;
    for (vec worst = {}; k < block.len[lane]; ++k) {
        length_error<uniform_a>(x, k, false, Mover<uniform_w>::bond(mover, x, k), worst);
        if (relative_error<uniform_a>(x, worst)[lane] >= error) break;
    }
    return k < block.len[lane] ? k : 0;
}

template <bool uniform_w, bool uniform_a>
static inline void note_worst(const Block &block, const Newton &x, const PositionsCall &call, mask which, vec error,
                              Tally &tally) {
    if (!call.report) return;
    const unsigned chosen = bits(which & block.in_use());
    int worst = -1;
    for (int i = 0; i < block.lanes; ++i) {
        if (!(chosen >> i & 1)) continue;
        if (!(error[i] > tally.worst || tally.worst_chain < 0 ||
              (error[i] == tally.worst && block.chain[i] < tally.worst_chain)))
            continue;
        tally.worst = error[i];
        tally.worst_chain = block.chain[i];
        worst = i;
    }
    if (worst >= 0) tally.worst_bond = worst_bond<uniform_w, uniform_a>(block, x, worst, tally.worst);
}

// - sum tau b (x) b / dt^2 over the bonds of the lanes in `which`.
static inline void add_virial(const Block &block, const Newton &x, mask which, double dt, Tally &tally) {
    vec s[6] = {};
    for (long k = 0; k < block.n; ++k) {
        const vec3 b = x.b[k], p = times(x.tau[k], b);
        const vec term[6] = {p.x * b.x, p.x * b.y, p.x * b.z, p.y * b.y, p.y * b.z, p.z * b.z};
        for (int c = 0; c < 6; ++c) s[c] = s[c] + term[c];
    }
    const vec factor = splat(1 / (dt * dt)) / block.unit;
    for (int c = 0; c < 6; ++c) tally.virial[c] -= sum_lanes(keep(which & block.in_use(), s[c] * factor));
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
