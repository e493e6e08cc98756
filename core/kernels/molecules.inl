// Small molecules of one kind over consecutive atoms: the same arithmetic as for any block, with the number of bonds
// known to the compiler, so that everything stays in registers. What needs more than plain arithmetic, and the last
// molecules of a unit, behind which nothing may be read, are left to the general path.

namespace holonomic {
namespace HOL_ISA {

constexpr int largest_molecule = 5;

// Vectors of W molecules' atoms, rounded up to what is transposed at a time.
template <int N>
constexpr int vectors_of = (3 * (N + 1) + W - 1) / W * W;

// The atoms of W molecules: element 3 a + c is component c of atom a. Up to W - 1 doubles behind each are read.
template <int N>
HOL_INLINE void load_molecules(const double *p, vec *elements) {
    HOL_UNROLL
    for (int j = 0; j < vectors_of<N> / W; ++j) {
        HOL_UNROLL
        for (int i = 0; i < W; ++i) elements[j * W + i] = load(p + 3 * (N + 1) * i + j * W);
        transpose(elements + j * W);
    }
}

// Bonds D[k] of W molecules and their right-hand sides t[k], rounded as load_chunk() does.
template <int N, int terms, bool uniform>
HOL_INLINE void load_molecules(const Block &block, const double *r, const double *v, const double *f, vec3 *D, vec *t) {
    vec e[vectors_of<N>], p[3 * N], *const d = &D[0].x;
    load_molecules<N>(r, e);
    HOL_UNROLL
    for (int c = 0; c < 3 * N; ++c) d[c] = e[c + 3] - e[c];
    if (terms == none_) return;
    if (terms & velocity_squared) {
        load_molecules<N>(v, e);
        HOL_UNROLL
        for (int c = 0; c < 3 * N; ++c) {
            const vec dv = e[c + 3] - e[c];
            p[c] = (block.mass * dv) * dv;
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

// Writes the atoms of W molecules, elements as above, transposed in place.
template <int N, Update update>
HOL_INLINE void store_elements(vec *value, double *out) {
    constexpr int elements = 3 * (N + 1), full = elements / W, rest = elements % W;
    HOL_UNROLL
    for (int j = 0; j < full; ++j) transpose(value + j * W);
    for (int i = 0; i < W; ++i)  // in the order of the addresses: faster from memory
        for (int j = 0; j < full; ++j) {
            double *p = out + elements * i + j * W;
            store(p, update == add_ ? load(p) + value[j * W + i] : value[j * W + i]);
        }
    HOL_UNROLL
    for (int e = 0; e < rest; ++e)
        for (int i = 0; i < W; ++i) {
            double &p = out[elements * i + full * W + e];
            p = update == add_ ? p + value[full * W + e][i] : value[full * W + e][i];
        }
}

// G of the atoms of W molecules.
template <int N, Update update>
HOL_INLINE void store_pulls(const vec3 *D, const vec *t, double *out) {
    vec value[vectors_of<N>];
    vec3 before = {};
    HOL_UNROLL
    for (int k = 0; k <= N; ++k) {
        const vec3 after = k < N ? scaled_bond(D[k], t[k]) : vec3{}, g = difference(before, after);
        value[3 * k] = g.x;
        value[3 * k + 1] = g.y;
        value[3 * k + 2] = g.z;
        before = after;
    }
    store_elements<N, update>(value, out);
}

// Writes factor times a value per bond of W molecules; zeros as +0. Rows of W elements, the rest of which the next
// molecule's row overwrites, as long as they stay inside.
template <int N>
HOL_INLINE void store_multipliers(const vec *t, vec factor, double *out) {
    constexpr int whole = N < W ? N : W;
    vec row[W] = {};
    HOL_UNROLL
    for (int k = 0; k < whole; ++k) row[k] = mul_add(factor, t[k], vec{});
    if (N == 1) return store(out, row[0]);
    transpose(row);
    HOL_UNROLL
    for (int i = 0; i < W; ++i) {
        if (N * i + W <= N * W)
            store(out + N * i, row[i]);
        else
            for (int k = 0; k < whole; ++k) out[N * i + k] = row[i][k];
    }
    HOL_UNROLL
    for (int k = whole; k < N; ++k) {
        const vec value = mul_add(factor, t[k], vec{});
        for (int i = 0; i < W; ++i) out[N * i + k] = value[i];
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
                store_pulls<N, add_>(D, t, g + at);
            else
                store_pulls<N, write_>(D, t, g + at);
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
        vec t[N], left[N + 1], L[N + 1], pivots[N], elements[vectors_of<N>];
        const int64_t at = 3 * (N + 1) * first;
        load_molecules<N, none_, uniform>(block, r + at, nullptr, nullptr, D, t);
        load_molecules<N>(v + at, elements);
        Packed from;
        for (int i = 0; i < W; ++i) from.lane[i] = const_cast<double *>(r) + at + 3 * (N + 1) * i;
        const Source source = {&from, nullptr, nullptr, &call.box, nullptr};
        const Projection x({D, t, L, pivots}, reinterpret_cast<vec3 *>(elements), left);
        Sweep<uniform, true> sweep{block, source, x.s};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) sweep.step(k, rate_of(D[k], x.v[k], x.v[k + 1]), k % 4 == 0, false);
        FirstPull<uniform> pull(block, x, N);
        HOL_UNROLL
        for (int k = N - 1; k >= 0; --k) pull.step(k);
        pull.finish();
        substitute(N, x.correction());
        if (__builtin_expect(any(sweep.doubt() | ~x.finite(N)), 0)) break;
        Pull<uniform> correction{block, x, left};
        HOL_UNROLL
        for (int k = N - 1; k >= 0; --k) x.v[k + 1] = correction.step(k);
        x.v[0] = correction.finish();
        if (call.lambda) store_multipliers<N>(t, 0.5 * block.mass, call.lambda + head.first_bond + N * first);
        store_elements<N, write_>(elements, v + at);
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
