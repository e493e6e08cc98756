// Acceleration and velocity level of a block of chains: load, eliminate, substitute, store.

namespace holonomic {
namespace HOL_ISA {

// Interleaved working arrays of a linear solve.
struct System {
    vec3 *D, *D_low;
    vec *t, *L;  // t: right-hand side, then u, then the solution t = 2 lambda
    vec *pivots;  // 1 / P
    System(long n, Arena &arena)
        : D(reinterpret_cast<vec3 *>(arena.vecs(3 * n))), D_low(reinterpret_cast<vec3 *>(arena.vecs(3 * n))),
          t(arena.vecs(n)), L(arena.vecs(n)), pivots(arena.vecs(n)) {}
};

template <int terms, bool uniform, bool boxed, bool careful>
static __attribute__((noinline)) mask solve(const Block &block, const Box &box, const Packed &r, const Packed &v,
                                            const Packed &f, const System &s) {
    load_bonds<terms, uniform, boxed, careful>(block, box, r, v, f, s.D, s.D_low, s.t);
    mask doubt = none();
    if (careful)
        forward_careful<uniform>(block, s.D, s.D_low, s.t, s.L, s.pivots);
    else
        doubt = forward<uniform, terms == rate>(block, Source{&r, &box}, s.D, s.t, s.L, s.pivots);
    backward(block.n, s.t, s.L);
    return finite(s.t[0]) & ~doubt & block.in_use();
}

template <int terms, bool careful>
static inline mask solve_any(const Block &block, const Box &box, const Packed &r, const Packed &v, const Packed &f,
                             const System &s) {
    const bool boxed = box.shape != Box::none;
    if (block.uniform_w)
        return boxed ? solve<terms, true, true, careful>(block, box, r, v, f, s)
                     : solve<terms, true, false, careful>(block, box, r, v, f, s);
    return boxed ? solve<terms, false, true, careful>(block, box, r, v, f, s)
                 : solve<terms, false, false, careful>(block, box, r, v, f, s);
}

template <bool careful>
static inline mask solve_forces(const Block &block, const ForcesCall &call, const Packed &r, const Packed &v,
                                const Packed &f, const System &s) {
    if (call.v.x && call.f.x)
        return solve_any<velocity_squared | force_difference, careful>(block, call.box, r, v, f, s);
    if (call.f.x) return solve_any<force_difference, careful>(block, call.box, r, v, f, s);
    if (call.v.x) return solve_any<velocity_squared, careful>(block, call.box, r, v, f, s);
    return solve_any<none_, careful>(block, call.box, r, v, f, s);
}

// - sum t d (x) d over the bonds of the lanes in `which`.
static inline void add_virial(long n, const vec3 *d, const vec *t, mask which, double factor, Tally &tally) {
    vec s[6] = {};
    for (long k = 0; k < n; ++k) {
        const vec3 p = {t[k] * d[k].x, t[k] * d[k].y, t[k] * d[k].z};
        s[0] = mul_add(p.x, d[k].x, s[0]);
        s[1] = mul_add(p.x, d[k].y, s[1]);
        s[2] = mul_add(p.x, d[k].z, s[2]);
        s[3] = mul_add(p.y, d[k].y, s[3]);
        s[4] = mul_add(p.y, d[k].z, s[4]);
        s[5] = mul_add(p.z, d[k].z, s[5]);
    }
    for (int c = 0; c < 6; ++c) tally.virial[c] -= factor * sum_lanes(keep(which, s[c]));
}

// G_i = t_{i+1} d_{i+1} - t_i d_i of the atoms first .. n, where `before` is t d of the bond before atom `first`; times
// w_i where `weighted`.
template <bool weighted, bool uniform, Update update>
static inline void store_pulls_from(const Block &block, long first, vec3 before, const vec3 *d, const vec *t,
                                    mask which, const Packed &out) {
    const unsigned chosen = bits(which);
    const auto pull = [&](long k, const vec3 &after, vec *value) __attribute__((always_inline)) {
        // A zero is +0, whatever padding stands beside it.
        vec3 g = {(after.x - before.x) + 0.0, (after.y - before.y) + 0.0, (after.z - before.z) + 0.0};
        if (weighted) {
            const vec w = w_at<uniform>(block, k);
            g = {w * g.x, w * g.y, w * g.z};
        }
        value[0] = g.x;
        value[1] = g.y;
        value[2] = g.z;
        before = after;
    };
    long k0 = first;
    if (chosen == (1u << W) - 1)
        for (; k0 + W <= block.n_min; k0 += W) {
            vec value[3 * W];
            for (int a = 0; a < W; ++a) {
                const long k = k0 + a;
                pull(k, {t[k] * d[k].x, t[k] * d[k].y, t[k] * d[k].z}, value + 3 * a);
            }
            store_chunk<update>(k0, value, out);
        }
    for (; k0 <= block.n; k0 += W) {
        vec value[3 * W] = {};
        for (int a = 0; a < W; ++a) {
            const long k = k0 + a;
            if (k > block.n) break;
            vec3 after = {};
            if (k < block.n) after = {t[k] * d[k].x, t[k] * d[k].y, t[k] * d[k].z};
            pull(k, after, value + 3 * a);
        }
        store_ragged<update>(block, k0, value, chosen, out);
    }
}

template <bool weighted, bool uniform>
static inline void store_pulls(const Block &block, const vec3 *d, const vec *t, mask which, Update update,
                               const Packed &out) {
    if (update == add_)
        store_pulls_from<weighted, uniform, add_>(block, 0, vec3{}, d, t, which, out);
    else
        store_pulls_from<weighted, uniform, write_>(block, 0, vec3{}, d, t, which, out);
}

static inline void note_bad(const Block &block, mask bad, Tally &tally) {
    const unsigned which = bits(bad & block.in_use());
    for (int i = 0; i < block.lanes; ++i) {
        if (!(which >> i & 1)) continue;
        if (tally.n_bad == 0 || block.chain[i] < tally.first_bad) tally.first_bad = block.chain[i];
        ++tally.n_bad;
    }
}

// Fills a block with the chains first .. first + lanes - 1 of a unit. Of a regular unit, the block before this one may
// still be in place.
static inline void open_block(const Unit &unit, int64_t first, Block &block, Lane *lane) {
    const int64_t left = unit.count - first;
    block.lanes = left < W ? static_cast<int>(left) : W;
    block.roomy = false;
    block.ahead = 0;
    if (unit.regular) {
        const Lane &head = unit.lanes[0];
        const int64_t n = head.n_bonds;
        if (first == 0) {
            block.n = block.n_min = n;
            for (int i = 0; i < W; ++i) {
                lane[i] = head;
                block.len[i] = n;
            }
        }
        for (int i = 0; i < block.lanes; ++i) {
            const int64_t c = first + i;
            lane[i].first_atom = head.first_atom + c * (n + 1);
            if (head.atoms) lane[i].atoms = head.atoms + c * (n + 1);
            lane[i].first_bond = block.first_bond[i] = head.first_bond + c * n;
            lane[i].chain = block.chain[i] = head.chain + c;
        }
        block.roomy = (left - block.lanes) * (n + 1) >= W && !head.atoms;
        if (unit.large) block.ahead = 3 * W * (n + 1);  // the next unit often goes on where this one ends
        return;
    }
    block.n = 0;
    block.n_min = longest_lane + 1;
    for (int i = 0; i < block.lanes; ++i) {
        lane[i] = unit.lanes[first + i];
        block.len[i] = lane[i].n_bonds;
        block.first_bond[i] = lane[i].first_bond;
        block.chain[i] = lane[i].chain;
        if (lane[i].n_bonds > block.n) block.n = lane[i].n_bonds;
        if (lane[i].n_bonds < block.n_min) block.n_min = lane[i].n_bonds;
    }
    for (int i = block.lanes; i < W; ++i) block.len[i] = block.len[0];
}

static inline void set_masses(Block &block, const Lane *lane, Arena &arena) {
    const double *tables[W] = {};
    double uniform[W] = {};
    for (int i = 0; i < block.lanes; ++i) {
        tables[i] = lane[i].w;
        uniform[i] = lane[i].w_uniform;
    }
    set_masses(block, tables, uniform, arena);
}

static inline Packed open(const AtomArray &array, const Block &block, const Lane *lane, Arena &arena, bool read) {
    Packed packed = {};
    if (!array.x) return packed;
    double *staging = nullptr;
    for (int i = 0; i < block.lanes; ++i)
        if (!in_place(array, lane[i])) staging = arena.next;
    if (staging) arena.next += W * staged_size(block.n);
    for (int i = 0; i < block.lanes; ++i) open_lane(array, lane[i], 0, block.len[i], block.n, packed, i, staging, read);
    repeat_first(packed, block.lanes);
    return packed;
}

// Copies staged lanes back.
static inline void close(const AtomArray &array, const Block &block, const Lane *lane, mask which, const Packed &packed,
                         bool add) {
    const unsigned chosen = bits(which);
    for (int i = 0; i < block.lanes; ++i)
        if ((chosen >> i & 1) && !in_place(array, lane[i])) unstage(array, lane[i], 0, block.len[i], packed.lane[i], add);
}

static void store_forces(const Block &block, const Lane *lane, const ForcesCall &call, const System &s, mask which,
                         const Packed &g, Arena arena) {
    if (call.lambda) store_bonds(block, s.t, 0.5, which, call.lambda);
    if (call.tension) {
        vec *value = arena.vecs(block.n);
        for (long k = 0; k < block.n; ++k) value[k] = s.t[k] * sqrt(dot(s.D[k], s.D[k]));
        store_bonds(block, value, 1, which, call.tension);
    }
    if (!call.g.x) return;
    bool staged = false;
    for (int i = 0; i < block.lanes; ++i) staged = staged || !in_place(call.g, lane[i]);
    if (!staged) {
        store_pulls<false, true>(block, s.D, s.t, which, call.add ? add_ : write_, g);
        return;
    }
    Packed out = g;  // all lanes through staging, so that packed ones among them are added to in the end, too
    double *staging = arena.doubles(W * staged_size(block.n));
    for (int i = 0; i < block.lanes; ++i) out.lane[i] = staging + i * staged_size(block.n);
    store_pulls<false, true>(block, s.D, s.t, which, write_, out);
    const unsigned chosen = bits(which);
    for (int i = 0; i < block.lanes; ++i)
        if (chosen >> i & 1) unstage(call.g, lane[i], 0, block.len[i], out.lane[i], call.add);
}

static void forces_block(const Block &block, const Lane *lane, const ForcesCall &call, Arena arena, Tally &tally) {
    const Packed r = open(call.r, block, lane, arena, true), v = open(call.v, block, lane, arena, true);
    const Packed f = open(call.f, block, lane, arena, true);
    Packed g;
    if (call.g.x)
        for (int i = 0; i < block.lanes; ++i)
            if (in_place(call.g, lane[i]))
                g.lane[i] = reinterpret_cast<double *>(call.g.x) + 3 * lane[i].first_atom;
    const System s(block.n, arena);
    mask good = solve_forces<false>(block, call, r, v, f, s);
    store_forces(block, lane, call, s, good, g, arena);
    if (call.virial) add_virial(block.n, s.D, s.t, good, 1, tally);
    mask rest = block.in_use() & ~good;
    if (__builtin_expect(!any(rest), 1)) return;
    // The lanes that plain arithmetic can't answer for, once more with compensated products.
    good = solve_forces<true>(block, call, r, v, f, s) & rest;
    store_forces(block, lane, call, s, good, g, arena);
    if (call.virial) add_virial(block.n, s.D, s.t, good, 1, tally);
    rest = rest & ~good;
    if (any(rest)) note_bad(block, rest, tally);
}

// A faster path for small molecules: returns the first one that it has left (molecules.inl). Most calls have none.
template <class Call>
static int64_t small_molecules(const Call &, const Unit &, const Block &, int64_t first, Tally &) {
    return first;
}
static int64_t small_molecules(const ForcesCall &call, const Unit &unit, const Block &block, int64_t first, Tally &);
static int64_t small_molecules(const VelocitiesCall &call, const Unit &unit, const Block &block, int64_t first, Tally &);
static int64_t small_molecules(const PositionsCall &call, const Unit &unit, const Block &block, int64_t first, Tally &);

template <class Call, class Work>
static inline void for_each_block(const Call &call, const Unit &unit, double *scratch, Tally &tally, Work work) {
    Block block;
    Lane lane[W];
    Arena arena = {scratch};
    for (int64_t first = 0; first < unit.count; first += W) {
        open_block(unit, first, block, lane);
        if (first == 0 || !unit.regular || block.lanes < W) {
            arena = {scratch};
            set_masses(block, lane, arena);
        }
        if (block.lanes == W) {
            const int64_t next = small_molecules(call, unit, block, first, tally);
            if (next > first) {
                first = next - W;  // the rest goes on from there
                continue;
            }
        }
        work(block, lane, call, arena, tally);
    }
}

static void forces(const ForcesCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, forces_block);
}

}  // namespace HOL_ISA
}  // namespace holonomic
