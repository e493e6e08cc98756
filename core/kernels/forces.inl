// Acceleration and velocity level of a block of chains: load, eliminate, substitute, store.

namespace holonomic {
namespace HOL_ISA {

template <bool careful>
static inline mask forward_forces(const Block &block, const ForcesCall &call, const Packed &r, const Packed &v,
                                    const Packed &f, const System &s, mask &calm) {
    if (call.v.x && call.f.x)
        return forward_any<velocity_squared | force_difference, careful>(block, call.box, r, v, f, s, calm);
    if (call.f.x) return forward_any<force_difference, careful>(block, call.box, r, v, f, s, calm);
    if (call.v.x) return forward_any<velocity_squared, careful>(block, call.box, r, v, f, s, calm);
    return forward_any<none_, careful>(block, call.box, r, v, f, s, calm);
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
    block.roomy = block.staged = false;
    block.ahead = block.list_ahead = 0;
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
        block.staged = head.atoms != nullptr;
        block.roomy = (left - block.lanes) * (n + 1) >= W && !block.staged;
        if (unit.large) block.ahead = 3 * W * (n + 1);  // the next unit often goes on where this one ends
        if (unit.large && left >= 2 * W) block.list_ahead = W * (n + 1);
        return;
    }
    block.n = 0;
    block.n_min = unit.lanes[first].n_bonds;
    for (int i = 0; i < block.lanes; ++i) {
        lane[i] = unit.lanes[first + i];
        block.staged = block.staged || lane[i].atoms;
        block.len[i] = lane[i].n_bonds;
        block.first_bond[i] = lane[i].first_bond;
        block.chain[i] = lane[i].chain;
        if (lane[i].n_bonds > block.n) block.n = lane[i].n_bonds;
        if (lane[i].n_bonds < block.n_min) block.n_min = lane[i].n_bonds;
    }
    for (int i = block.lanes; i < W; ++i) block.len[i] = block.len[0];
    // Chains of the same length one behind the other: those of the next block often go on where these end.
    bool consecutive = unit.large && !block.staged && block.lanes == W && block.n == block.n_min;
    for (int i = 1; i < block.lanes; ++i)
        consecutive = consecutive && lane[i].first_atom == lane[0].first_atom + i * (block.n + 1);
    if (consecutive) block.ahead = 3 * W * (block.n + 1);
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

HOL_INLINE bool in_place(const AtomArray &array, const Block &block) { return array.packed && !block.staged; }

// The lanes of a block in an array of the caller's or, where that can't be used in place, in staging buffers.
static inline Packed open(const AtomArray &array, const Block &block, const Lane *lane, Arena &arena, bool read) {
    Packed packed = {};
    if (!array.x) return packed;
    const bool direct = in_place(array, block);
    for (int i = 0; i < block.lanes; ++i) {
        if (direct) {
            packed.lane[i] = reinterpret_cast<double *>(array.x) + 3 * lane[i].first_atom;
        } else {
            packed.lane[i] = arena.doubles(staged_size(block.n));
            if (read) stage(array, lane[i], 0, block.len[i], packed.lane[i]);
        }
    }
    repeat_first(packed, block.lanes);
    return packed;
}

// Copies staged lanes back.
static inline void close(const AtomArray &array, const Block &block, const Lane *lane, mask which, const Packed &packed,
                         bool add) {
    if (in_place(array, block)) return;
    const unsigned chosen = bits(which & block.in_use());
    for (int i = 0; i < block.lanes; ++i)
        if (chosen >> i & 1) unstage(array, lane[i], 0, block.len[i], packed.lane[i], add);
}

// What a call wants of the lanes in `which`, from u.
static void finish_forces(const Block &block, const ForcesCall &call, const System &s, mask which, const Packed &g,
                          Update update, Arena arena, Tally &tally) {
    if (call.lambda) store_bonds(block, s.t, splat(0.5), which, call.lambda);
    if (call.tension) {
        vec *value = arena.vecs(block.n);
        for (long k = 0; k < block.n; ++k) value[k] = s.t[k] * sqrt(dot(s.D[k], s.D[k]));
        store_bonds(block, value, splat(1.0), which, call.tension);
    }
    if (call.g.x) store_pulls(block, s.D, s.t, which, update, g);
    if (call.virial) add_virial(block.n, s.D, s.t, which, splat(1.0), tally);
}

static void forces_block(const Block &block, const Lane *lane, const ForcesCall &call, Arena arena, Tally &tally) {
    if (block.staged && listed_forces(block, lane, call, arena)) return;
    const Packed r = open(call.r, block, lane, arena, true), v = open(call.v, block, lane, arena, true);
    const Packed f = open(call.f, block, lane, arena, true), g = open(call.g, block, lane, arena, false);
    const Update update = call.add && in_place(call.g, block) ? add_ : write_;  // else unstage() adds
    const System s(block.n, arena);
    mask calm, good = forward_forces<false>(block, call, r, v, f, s, calm);
    const bool plain = block.lanes == W && !any(~(good & calm));
    if (__builtin_expect(plain && !call.tension && !call.virial, 1)) {
        if (update == add_)
            substitute_and_store<add_>(block, s, g, call.lambda, splat(0.5));
        else
            substitute_and_store<write_>(block, s, g, call.lambda, splat(0.5));
    } else {
        backward(0, block.n, s.t, s.L);
        good = good & finite(s.t[0]) & block.in_use();
        finish_forces(block, call, s, good, g, update, arena, tally);
    }
    mask rest = block.in_use() & ~good;
    if (__builtin_expect(any(rest), 0)) {
        // The lanes that plain arithmetic can't answer for, once more with compensated products.
        forward_forces<true>(block, call, r, v, f, s, calm);
        backward(0, block.n, s.t, s.L);
        const mask mended = finite(s.t[0]) & rest;
        finish_forces(block, call, s, mended, g, update, arena, tally);
        good = good | mended;
        rest = rest & ~mended;
        if (any(rest)) note_bad(block, rest, tally);
    }
    if (call.g.x) close(call.g, block, lane, good, g, call.add);
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
