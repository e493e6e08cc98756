// Position level of a block of chains, from and to the caller's arrays: masses, lengths, bonds; moves, multipliers,
// virial.

namespace holonomic {
namespace HOL_ISA {

static inline BondLengths bond_lengths(const Block &block, const Lane *lane, Arena &arena) {
    bool uniform = block.n == block.n_min;
    const double *table[W];
    double first[W];
    for (int i = 0; i < W; ++i) {
        const Lane &one = lane[i < block.lanes ? i : 0];
        uniform = uniform && !one.length;
        table[i] = one.length;
        first[i] = one.length ? one.length[0] : one.length_uniform;
    }
    BondLengths x = {};
    x.a_min = x.a_max = load(first);
    if (!uniform) {
        vec *const a2 = arena.vecs(block.n), *const per_a2 = arena.vecs(block.n);
        interleave(table, block.len, 0, block.n, a2, [&](int i, long k) __attribute__((always_inline)) {
            return table[i] && k < block.len[i] ? table[i][k] : first[i];
        });
        const vec lengths = block.lengths();
        for (long k = 0; k < block.n; ++k) {
            const vec a = a2[k];
            x.a_min = min(a, x.a_min);
            x.a_max = max(a, x.a_max);
            a2[k] = k < block.n_min ? a * a : select(less(splat(static_cast<double>(k)), lengths), a * a, splat(1.0));
            per_a2[k] = splat(1.0) / a2[k];
        }
        x.a2 = a2;
        x.per_a2 = per_a2;
    }
    x.per_a_min = splat(1.0) / x.a_min;
    x.a2_uniform = x.a_min * x.a_min;
    x.per_a2_uniform = splat(1.0) / x.a2_uniform;
    return x;
}

// Bond vectors k0 .. k0 + W - 1, from pointers to atom k0 of each lane.
template <bool boxed>
HOL_INLINE void bonds_between(const Box &box, const double *const *p, vec3 *d) {
    vec m[3 * W];
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < W; ++i) m[j * W + i] = load(p[i] + W * j + 3) - load(p[i] + W * j);
        transpose(m + j * W);
    }
    for (int a = 0; a < W; ++a) {
        d[a] = {m[3 * a], m[3 * a + 1], m[3 * a + 2]};
        vec3 unused = {};
        if (boxed) wrap<false>(box, d[a], unused);
    }
}

template <bool boxed>
static inline void load_bond_vectors(const Block &block, const Box &box, const Packed &r, vec3 *D) {
    const vec lengths = block.lengths();
    const double *p[W];
    vec3 d[W];
    long k0 = 0;
    for (; k0 + W <= block.n_min; k0 += W) {
        for (int i = 0; i < W; ++i) p[i] = r.lane[i] + 3 * k0;
        bonds_between<boxed>(box, p, d);
        for (int a = 0; a < W; ++a) D[k0 + a] = d[a];
    }
    for (; k0 < block.n; k0 += W) {
        double buffer[W][3 * W + 3];
        for (int i = 0; i < W; ++i)
            p[i] = i == 0 || i < block.lanes ? window(r.lane[i], k0, block.len[i], block.roomy, buffer[i]) : p[0];
        bonds_between<boxed>(box, p, d);
        for (long a = 0; a < W && k0 + a < block.n; ++a) {  // inert bonds past the end of a lane: (1, 0, 0)
            const mask m = less(splat(static_cast<double>(k0 + a)), lengths);
            D[k0 + a] = {select(m, d[a].x, splat(1.0)), keep(m, d[a].y), keep(m, d[a].z)};
        }
    }
}

static inline void load_bond_vectors(const Block &block, const Box &box, const Packed &r, vec3 *D) {
    if (box.shape == Box::none)
        load_bond_vectors<false>(block, box, r, D);
    else
        load_bond_vectors<true>(block, box, r, D);
}

static inline void load_guess(const Block &block, const PositionsCall &call, const Newton &x) {
    const vec factor = (2 * call.dt * call.dt) * block.unit;
    for (int i = 0; i < W; ++i) {
        const int lane = i < block.lanes ? i : 0;
        for (long k = 0; k < block.n; ++k)
            x.tau[k][i] = k < block.len[i] ? factor[i] * call.lambda[block.first_bond[lane] + k] : 0.0;
    }
}

// Moves the atoms `first` .. n of the lanes in `which` by w_i (tau_{i+1} b_{i+1} - tau_i b_i), and changes their velocities
// by `per_dt` times that: either, or both. `before` is tau b of the bond before the first atom.
template <bool uniform_w, bool to_r, bool to_v>
static inline void store_moves(const Block &block, const Newton &x, mask which, const Packed &r, const Packed &v,
                               double per_dt, long first = 0, vec3 before = vec3{}) {
    const unsigned chosen = bits(which & block.in_use());
    const vec *const tau = x.tau;
    const vec3 *const b = x.b;
    const auto move = [&](long k, vec *value) __attribute__((always_inline)) {
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
static __attribute__((noinline)) long worst_bond(const Block &block, const Newton &x, int lane, double error) {
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
