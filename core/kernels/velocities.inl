// Velocity level of a block of chains: the same solve with d . (v_k - v_{k-1}) on the right; v_i += w_i G_i. Velocities
// are read once, stay in lanes until they are right, and are written once.

namespace holonomic {
namespace HOL_ISA {

// Working arrays of a projection.
struct Projection {
    System s;
    vec3 *v;    // of the atoms
    vec *left;  // of the bonds: what rounding leaves of the rates, then the multipliers that correct it
    Projection(long n, Arena &arena)
        : s(n, arena), v(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + 1 + W)))), left(arena.vecs(n + 1)) {}
    Projection(const System &system, vec3 *velocities, vec *rates) : s(system), v(velocities), left(rates) {}
    System correction() const { return System(s.D, left, s.L, s.pivots); }
    // Whether nothing has overflowed: what is not finite is carried to the first bond by the backward sweep, and to the
    // last one by the substitution of the rates.
    mask finite(long n) const { return HOL_ISA::finite(s.t[0] + left[n - 1]); }
};

// d . (v_{k+1} - v_k)
HOL_INLINE vec rate_of(const vec3 &d, const vec3 &v0, const vec3 &v1) { return dot(d, difference(v0, v1)); }

// The atoms k0 .. k0 + W - 1 of all lanes, from pointers to atom k0.
HOL_INLINE void load_atoms(const double *const *p, vec3 *atoms) {
    vec *const elements = &atoms->x;
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        vec e[W];
        HOL_UNROLL
        for (int i = 0; i < W; ++i) e[i] = load(p[i] + W * j);
        transpose(e);
        HOL_UNROLL
        for (int i = 0; i < W; ++i) elements[j * W + i] = e[i];
    }
}

HOL_INLINE vec3 load_atom(const Packed &p) {
    vec3 a;
    for (int i = 0; i < W; ++i) {
        a.x[i] = p.lane[i][0];
        a.y[i] = p.lane[i][1];
        a.z[i] = p.lane[i][2];
    }
    return a;
}

// The atoms k0 + 1 .. k0 + W where lanes may end; what is behind their ends is of no use.
static __attribute__((noinline)) void load_ragged_atoms(const Block &block, const Packed &p, long k0, vec3 *atoms) {
    double buffer[W][3 * W + 3];
    const double *from[W];
    for (int i = 0; i < W; ++i) from[i] = window(p.lane[i], k0, block.len[i], block.roomy, buffer[i]) + 3;
    load_atoms(from, atoms + k0 + 1);
}

// Loads and eliminates. Returns the lanes that plain arithmetic can answer for.
template <bool uniform, bool boxed>
static __attribute__((noinline)) mask forward_velocities(const Block &block, const Box &box, const Packed &r,
                                                         const Packed &v, const Projection &x) {
    const System &s = x.s;
    const Source source = {&r, nullptr, nullptr, &box, nullptr};
    Sweep<uniform, true> sweep{block, source, s};
    constexpr long group = W > 4 ? W : 4;
    const Places at(r, v, v);
    x.v[0] = load_atom(v);
    long k0 = 0;
    for (; k0 + group <= block.n_min; k0 += group) {
        HOL_UNROLL
        for (long k = k0; k < k0 + group; k += W) {
            vec unused[W];
            load_full_chunk<none_, uniform, boxed, false>(block, box, at, k, s.D + k, nullptr, unused);
            const double *pv[W];
            HOL_UNROLL
            for (int i = 0; i < W; ++i) pv[i] = at.v + 3 * (k + 1) + at.lane[i];
            if (__builtin_expect(block.ahead != 0, 0)) fetch_ahead(at.v, k, block.ahead);
            load_atoms(pv, x.v + k + 1);
        }
        HOL_UNROLL
        for (long k = k0; k < k0 + group; ++k)
            sweep.step(k, rate_of(s.D[k], x.v[k], x.v[k + 1]), (k - k0) % 4 == 0, false);
    }
    const long ragged_from = k0;
    for (; k0 < block.n; k0 += W) {
        load_ragged_chunk<none_, uniform, boxed, false>(block, box, r, r, r, k0, s.D + k0, nullptr, s.t + k0);
        load_ragged_atoms(block, v, k0, x.v);
    }
    for (long k = ragged_from; k < block.n; ++k)
        sweep.step(k, keep(joint(block, k), rate_of(s.D[k], x.v[k], x.v[k + 1])), k % 4 == 0, k >= block.n_min);
    return ~sweep.doubt();
}

// The same with compensated products of unrounded bond vectors: good in all lanes.
template <bool uniform, bool boxed>
static __attribute__((noinline)) mask forward_velocities_careful(const Block &block, const Box &box, const Packed &r,
                                                                 const Packed &v, const Projection &x) {
    load_bonds<none_, uniform, boxed, true>(block, box, r, r, r, x.s.D, x.s.D_low, x.s.t);
    x.v[0] = load_atom(v);
    for (long k0 = 0; k0 < block.n; k0 += W) load_ragged_atoms(block, v, k0, x.v);
    for (long k = 0; k < block.n; ++k)
        x.s.t[k] = keep(joint(block, k), rate_of(x.s.D[k], x.v[k], x.v[k + 1]));
    forward_careful<uniform>(block, x.s);
    return ~none();
}

template <bool uniform>
static inline mask forward_velocities(const Block &block, const Box &box, const Packed &r, const Packed &v,
                                      const Projection &x, bool careful) {
    if (box.shape != Box::none)
        return careful ? forward_velocities_careful<uniform, true>(block, box, r, v, x)
                       : forward_velocities<uniform, true>(block, box, r, v, x);
    return careful ? forward_velocities_careful<uniform, false>(block, box, r, v, x)
                   : forward_velocities<uniform, false>(block, box, r, v, x);
}

// The backward sweep, u to t, and what it makes of velocities: v_k + w_k (t_{k+1} d_{k+1} - t_k d_k), rounded once.
template <bool uniform>
struct Pull {
    const Block &block;
    const Projection x;  // by value: its pointers stay in registers
    const vec *const u;
    vec t = {};
    vec3 after = {};  // t d of bond k + 1

    inline __attribute__((always_inline)) vec3 moved(long k, const vec3 &before) const {
        const vec w = w_at<uniform>(block, k);
        const vec3 v = x.v[k], g = difference(before, after);
        return {mul_add(w, g.x, v.x), mul_add(w, g.y, v.y), mul_add(w, g.z, v.z)};
    }
    // Atom k + 1; the last is atom 0.
    inline __attribute__((always_inline)) vec3 step(long k) {
        t = mul_add(x.s.L[k + 1], t, u[k]);
        const vec3 before = scaled_bond(x.s.D[k], t), v = moved(k + 1, before);
        after = before;
        return v;
    }
    inline __attribute__((always_inline)) vec3 finish() const { return moved(0, vec3{}); }
};

// That for u in s.t, which becomes t; `left` gets the rates of the velocities as they are rounded now.
template <bool uniform>
struct FirstPull {
    Pull<uniform> pull;
    vec3 d = {}, v1 = {};  // bond k + 1, atom k + 2

    FirstPull(const Block &block, const Projection &x, long n) : pull{block, x, x.s.t} { x.s.L[n] = vec{}; }
    inline __attribute__((always_inline)) void step(long k) {
        keep_velocity(k + 1, pull.step(k));
        pull.x.s.t[k] = pull.t;
        d = pull.x.s.D[k];
    }
    inline __attribute__((always_inline)) void finish() { keep_velocity(0, pull.finish()); }
    inline __attribute__((always_inline)) void keep_velocity(long k, const vec3 &v) {
        pull.x.v[k] = v;
        pull.x.left[k] = rate_of(d, v, v1);
        v1 = v;
    }
};

// From u to the velocities. The recursion gives the multipliers to a few roundings of themselves; what that leaves of
// the rates goes with a second substitution, for the rates of the velocities as they are rounded: this prepares it,
// unless they are to be rounded to floats. Returns the lanes in which all is finite.
template <bool uniform>
static __attribute__((noinline)) mask pull_back(const Block &block, const Projection &x, bool twice) {
    long k = block.n;
    FirstPull<uniform> pull(block, x, k);
    while (k % 4 != 0) pull.step(--k);
    while (k > 0) {
        k -= 4;
        pull.step(k + 3);
        pull.step(k + 2);
        pull.step(k + 1);
        pull.step(k);
    }
    pull.finish();
    for (k = twice ? block.n_min : 0; k < block.n; ++k)
        x.left[k] = twice ? keep(joint(block, k), x.left[k]) : vec{};
    if (twice) substitute(block.n, x.correction());
    return x.finite(block.n);
}

static inline mask pull_back(const Block &block, const Projection &x, bool twice) {
    return block.uniform_w ? pull_back<true>(block, x, twice) : pull_back<false>(block, x, twice);
}

// The second substitution, and the velocities of the lanes in `which` to `out`.
template <bool uniform>
static __attribute__((noinline)) void correct_and_store(const Block &block, const Projection &x, mask which,
                                                        const Packed &out) {
    Pull<uniform> pull{block, x, x.left};
    const Packed to = out;
    const unsigned chosen = bits(which);
    const long full = block.n / W * W, fast = chosen == (1u << W) - 1 ? block.n_min : 0;
    if (full < block.n) {
        vec3 value[W] = {};
        for (long k = block.n - 1; k >= full; --k) value[k - full] = pull.step(k);
        store_ragged<write_>(block, full + 1, &value->x, chosen, out);
    }
    for (long k0 = full - W; k0 >= 0; k0 -= W) {
        vec value[3 * W];
        HOL_UNROLL
        for (long b = W - 1; b >= 0; --b) {
            const vec3 v = pull.step(k0 + b);
            value[3 * b] = v.x;
            value[3 * b + 1] = v.y;
            value[3 * b + 2] = v.z;
        }
        if (__builtin_expect(k0 + W <= fast, 1))
            store_chunk<write_>(k0 + 1, value, to);
        else
            store_ragged<write_>(block, k0 + 1, value, chosen, out);
    }
    const vec3 v = pull.finish();
    for (int i = 0; i < W; ++i) {
        if (!(chosen >> i & 1)) continue;
        out.lane[i][0] = v.x[i];
        out.lane[i][1] = v.y[i];
        out.lane[i][2] = v.z[i];
    }
}

template <bool uniform>
static __attribute__((noinline)) void correct_and_scatter(const Block &block, const Projection &x, const AtomLists &at,
                                                          double *out) {
    Pull<uniform> pull{block, x, x.left};
    for (long k = block.n - 1; k >= 0; --k) scatter<write_>(out, at, k + 1, pull.step(k));
    scatter<write_>(out, at, 0, pull.finish());
}

// Lists of atoms in packed arrays. Whether this did all that there was to do; else nothing has been written.
static inline bool listed_velocities(const Block &block, const Lane *lane, const VelocitiesCall &call, Arena arena) {
    if (!call.r.packed || call.virial || !listed(block, lane)) return false;
    const AtomLists at(lane);
    const Projection x(block.n, arena);
    mask good = forward_listed<rate>(block, call.box, at, call.r, call.v, call.v, x.s, x.v);
    good = good & pull_back(block, x, true);
    if (any(~good)) return false;
    if (call.lambda) store_bonds(block, x.s.t, 0.5 * block.mass, good, call.lambda);
    block.uniform_w ? correct_and_scatter<true>(block, x, at, base_of(call.v))
                    : correct_and_scatter<false>(block, x, at, base_of(call.v));
    return true;
}

static void velocities_block(const Block &block, const Lane *lane, const VelocitiesCall &call, Arena arena,
                             Tally &tally) {
    if (block.staged && listed_velocities(block, lane, call, arena)) return;
    const Packed r = open(call.r, block, lane, arena, true), v = open(call.v, block, lane, arena, true);
    const Projection x(block.n, arena);
    mask rest = block.in_use();
    for (int careful = 0; careful < 2 && any(rest); ++careful) {
        mask good = block.uniform_w ? forward_velocities<true>(block, call.box, r, v, x, careful)
                                    : forward_velocities<false>(block, call.box, r, v, x, careful);
        good = good & pull_back(block, x, !call.v.is_float) & rest;
        rest = rest & ~good;
        if (!any(good)) continue;
        if (call.lambda) store_bonds(block, x.s.t, 0.5 * block.mass, good, call.lambda);
        if (call.virial) add_virial(block.n, x.s.D, x.s.t, good, block.mass, tally);
        block.uniform_w ? correct_and_store<true>(block, x, good, v) : correct_and_store<false>(block, x, good, v);
        close(call.v, block, lane, good, v, false);
    }
    if (any(rest)) note_bad(block, rest, tally);
}

static void velocities(const VelocitiesCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, velocities_block);
}

}  // namespace HOL_ISA
}  // namespace holonomic
