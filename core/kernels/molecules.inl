// Small molecules of one kind over consecutive atoms: the same arithmetic as for any block, with the number of bonds
// known to the compiler, so that everything stays in registers. What needs more than plain arithmetic, and the last
// molecules of a unit, behind which nothing may be read, are left to the general path.

namespace holonomic {
namespace HOL_ISA {

constexpr int largest_molecule = 5;

// The atoms of W molecules: element 3 a + c is component c of atom a. Up to W - 1 doubles behind each are read.
template <int N>
HOL_INLINE void load_molecules(const double *p, vec *elements) {
    HOL_UNROLL
    for (int j = 0; j < (3 * (N + 1) + W - 1) / W; ++j) {
        HOL_UNROLL
        for (int i = 0; i < W; ++i) elements[j * W + i] = load(p + 3 * (N + 1) * i + j * W);
        transpose(elements + j * W);
    }
}

// Bonds D[k] of W molecules and their right-hand sides t[k], rounded as load_chunk() does.
template <int N, int terms, bool uniform>
HOL_INLINE void load_molecules(const Block &block, const double *r, const double *v, const double *f, vec3 *D, vec *t) {
    vec e[(3 * (N + 1) + W - 1) / W * W], p[3 * N], *const d = &D[0].x;
    load_molecules<N>(r, e);
    HOL_UNROLL
    for (int c = 0; c < 3 * N; ++c) d[c] = e[c + 3] - e[c];
    if (terms & (velocity_squared | rate)) {
        load_molecules<N>(v, e);
        HOL_UNROLL
        for (int c = 0; c < 3 * N; ++c) {
            const vec dv = e[c + 3] - e[c];
            p[c] = terms & rate ? dv * d[c] : (block.mass * dv) * dv;
        }
    }
    if (terms & force_difference) {
        load_molecules<N>(f, e);
        HOL_UNROLL
        for (int c = 0; c < 3 * N; ++c) {
            const vec df = uniform ? e[c + 3] - e[c] : block.w[c / 3 + 1] * e[c + 3] - block.w[c / 3] * e[c];
            p[c] = terms & velocity_squared ? mul_add(df, d[c], p[c]) : df * d[c];
        }
    }
    HOL_UNROLL
    for (int k = 0; k < N; ++k) t[k] = (p[3 * k] + p[3 * k + 1]) + p[3 * k + 2];
}

// G of the atoms of W molecules, times w where `weighted`.
template <int N, bool weighted, bool uniform, Update update>
HOL_INLINE void store_molecules(const Block &block, const vec3 *D, const vec *t, double *out) {
    constexpr int elements = 3 * (N + 1), full = elements / W, rest = elements % W;
    vec value[(full + 1) * W] = {};
    vec3 before = {};
    HOL_UNROLL
    for (int k = 0; k <= N; ++k) {
        vec3 after = {};
        if (k < N) after = {t[k] * D[k].x, t[k] * D[k].y, t[k] * D[k].z};
        const vec w = weighted ? w_at<uniform>(block, k) : splat(1.0);
        const vec3 g = {after.x - before.x, after.y - before.y, after.z - before.z};
        value[3 * k] = weighted ? w * g.x : g.x;
        value[3 * k + 1] = weighted ? w * g.y : g.y;
        value[3 * k + 2] = weighted ? w * g.z : g.z;
        before = after;
    }
    HOL_UNROLL
    for (int j = 0; j < full; ++j) {
        transpose(value + j * W);
        for (int i = 0; i < W; ++i) {
            double *p = out + elements * i + j * W;
            store(p, update == add_ ? load(p) + value[j * W + i] : value[j * W + i]);
        }
    }
    HOL_UNROLL
    for (int e = 0; e < rest; ++e)
        for (int i = 0; i < W; ++i) {
            double &p = out[elements * i + full * W + e];
            p = update == add_ ? p + value[full * W + e][i] : value[full * W + e][i];
        }
}

template <int N>
HOL_INLINE void store_multipliers(const vec *t, vec factor, double *out) {
    for (int k = 0; k < N; ++k) {
        const vec lambda = mul_add(factor, t[k], vec{});  // zeros as +0
        for (int i = 0; i < W; ++i) out[N * i + k] = lambda[i];
    }
}

// Whether W molecules from `first` on may be done here.
HOL_INLINE bool molecules_left(const Unit &unit, int64_t first) {
    const int64_t n = unit.lanes[0].n_bonds;
    return (unit.count - first - W) * (n + 1) >= W;
}

// From molecule `first` on; returns the first one that is not done.
template <int N, int terms, bool uniform>
static int64_t forces_of_molecules(const ForcesCall &call, const Unit &unit, const Block &block, int64_t first) {
    const Lane &head = unit.lanes[0];
    const auto atoms = [&](const AtomArray &a) {
        return a.x ? reinterpret_cast<double *>(a.x) + 3 * head.first_atom : nullptr;
    };
    const double *const r = atoms(call.r), *const v = atoms(call.v), *const f = atoms(call.f);
    double *const g = atoms(call.g);
    for (; molecules_left(unit, first); first += W) {
        vec3 D[N];
        vec t[N], L[N + 1];
        const int64_t at = 3 * (N + 1) * first;
        load_molecules<N, terms, uniform>(block, r + at, v ? v + at : v, f ? f + at : f, D, t);
        Packed from;
        for (int i = 0; i < W; ++i) from.lane[i] = const_cast<double *>(r) + at + 3 * (N + 1) * i;
        const Source source = {&from, nullptr, nullptr, &call.box, nullptr};
        Sweep<uniform, false> sweep{block, source, System(D, t, L, nullptr)};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) sweep.step(k, t[k], k % 4 == 0, false);
        if (__builtin_expect(any(sweep.doubt() | ~sweep.calm()), 0)) break;
        backward(0, N, t, L);
        if (g) {
            if (call.add)
                store_molecules<N, false, true, add_>(block, D, t, g + at);
            else
                store_molecules<N, false, true, write_>(block, D, t, g + at);
        }
        if (call.lambda) store_multipliers<N>(t, splat(0.5), call.lambda + head.first_bond + N * first);
    }
    return first;
}

template <int N, bool uniform>
static int64_t velocities_of_molecules(const VelocitiesCall &call, const Unit &unit, const Block &block,
                                       int64_t first) {
    const Lane &head = unit.lanes[0];
    const double *const r = reinterpret_cast<double *>(call.r.x) + 3 * head.first_atom;
    double *const v = reinterpret_cast<double *>(call.v.x) + 3 * head.first_atom;
    for (; molecules_left(unit, first); first += W) {
        vec3 D[N];
        vec t[N], L[N + 1], pivots[N];
        const int64_t at = 3 * (N + 1) * first;
        load_molecules<N, rate, uniform>(block, r + at, v + at, nullptr, D, t);
        Packed from;
        for (int i = 0; i < W; ++i) from.lane[i] = const_cast<double *>(r) + at + 3 * (N + 1) * i;
        const Source source = {&from, nullptr, nullptr, &call.box, nullptr};
        const System s(D, t, L, pivots);
        Sweep<uniform, true> sweep{block, source, s};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) sweep.step(k, t[k], k % 4 == 0, false);
        if (__builtin_expect(any(sweep.doubt() | ~sweep.calm()), 0)) break;
        backward(0, N, t, L);
        if (call.lambda) store_multipliers<N>(t, 0.5 * block.mass, call.lambda + head.first_bond + N * first);
        store_molecules<N, true, uniform, add_>(block, D, t, v + at);
        vec rounded[(3 * (N + 1) + W - 1) / W * W];  // as in finish_velocities
        load_molecules<N>(v + at, rounded);
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            const vec *const a = rounded + 3 * k;
            t[k] = dot(D[k], vec3{a[3] - a[0], a[4] - a[1], a[5] - a[2]});
        }
        substitute(N, s);
        backward(0, N, t, L);
        store_molecules<N, true, uniform, add_>(block, D, t, v + at);
    }
    return first;
}

template <int N, bool uniform>
static int64_t molecules(const ForcesCall &call, const Unit &unit, const Block &block, int64_t first) {
    if (call.v.x && call.f.x)
        return forces_of_molecules<N, velocity_squared | force_difference, uniform>(call, unit, block, first);
    if (call.f.x) return forces_of_molecules<N, force_difference, uniform>(call, unit, block, first);
    return first;
}

template <int N, bool uniform>
static int64_t molecules(const VelocitiesCall &call, const Unit &unit, const Block &block, int64_t first) {
    return velocities_of_molecules<N, uniform>(call, unit, block, first);
}

HOL_INLINE bool plain_layout(const ForcesCall &call) {
    return call.r.packed && (!call.v.x || call.v.packed) && (!call.f.x || call.f.packed) &&
           (!call.g.x || call.g.packed) && !call.tension && !call.virial && call.box.shape == Box::none;
}

HOL_INLINE bool plain_layout(const VelocitiesCall &call) {
    return call.r.packed && call.v.packed && !call.virial && call.box.shape == Box::none;
}

// The molecules from `first` on that can be done here; returns the first one that can't.
template <class Call>
static int64_t any_molecules(const Call &call, const Unit &unit, const Block &block, int64_t first) {
    if (!unit.regular || unit.lanes[0].atoms || unit.lanes[0].n_bonds > largest_molecule || !plain_layout(call))
        return first;
    const bool uniform = block.uniform_w;
    switch (unit.lanes[0].n_bonds) {
        case 1: return uniform ? molecules<1, true>(call, unit, block, first) : molecules<1, false>(call, unit, block, first);
        case 2: return uniform ? molecules<2, true>(call, unit, block, first) : molecules<2, false>(call, unit, block, first);
        case 3: return uniform ? molecules<3, true>(call, unit, block, first) : molecules<3, false>(call, unit, block, first);
        case 4: return uniform ? molecules<4, true>(call, unit, block, first) : molecules<4, false>(call, unit, block, first);
        default: return uniform ? molecules<5, true>(call, unit, block, first) : molecules<5, false>(call, unit, block, first);
    }
}

static int64_t small_molecules(const ForcesCall &call, const Unit &unit, const Block &block, int64_t first, Tally &) {
    return any_molecules(call, unit, block, first);
}

static int64_t small_molecules(const VelocitiesCall &call, const Unit &unit, const Block &block, int64_t first,
                               Tally &) {
    return any_molecules(call, unit, block, first);
}

}  // namespace HOL_ISA
}  // namespace holonomic
