// Position level of a block of chains: load, iterate (newton.inl), move the atoms, store.

namespace holonomic {
namespace HOL_ISA {

static inline void note_worst(const Block &block, const Newton &x, mask which, vec error, Tally &tally) {
    const unsigned chosen = bits(which);
    for (int i = 0; i < block.lanes; ++i) {
        if (!(chosen >> i & 1)) continue;
        if (!(error[i] > tally.worst || tally.worst_chain < 0 ||
              (error[i] == tally.worst && block.chain[i] < tally.worst_chain)))
            continue;
        tally.worst = error[i];
        tally.worst_chain = block.chain[i];
        double largest = -1;
        for (long k = 0; k < block.len[i]; ++k) {
            const double e = abs(2 * x.s[k][i]) / (x.a2 ? x.a2[k][i] : x.a2_uniform[i]);
            if (e > largest) {
                largest = e;
                tally.worst_bond = k;
            }
        }
    }
}

template <bool uniform>
static void store_positions(const Block &block, const Lane *lane, const PositionsCall &call, const Newton &x,
                            const Outcome &out, const Packed &r, const Packed &v, Tally &tally) {
    const mask done = out.converged | out.untouched;
    if (any(out.converged)) {
        close(call.r, block, lane, out.converged, r, false);
        if (call.v.x) {
            for (long k = 0; k < block.n; ++k) x.up[k] = (1 / call.dt) * x.tau[k];
            store_pulls<true, uniform>(block, x.b, x.up, out.converged, add_, v);
            close(call.v, block, lane, out.converged, v, false);
        }
        if (call.virial) add_virial(block.n, x.b, x.tau, out.converged, 1 / (call.dt * call.dt), tally);
    }
    if (call.lambda) {
        if (any(out.untouched))
            for (long k = 0; k < block.n; ++k) x.tau[k] = keep(out.converged, x.tau[k]);
        store_bonds(block, x.tau, 0.5 / (call.dt * call.dt), done, call.lambda);
    }
    note_worst(block, x, done, out.error, tally);
    tally.n_corrected += __builtin_popcount(bits(out.converged));
    if (out.solves > tally.iterations) tally.iterations = out.solves;
}

// Lanes in which an atom's displacement is the difference of pulls so large that their rounding is more than the
// coordinates': light atoms between heavy ones in a taut chain. Elsewhere moving the atoms costs one rounding of them.
static inline mask coarse_moves(const Block &block, const Newton &x, vec largest_coordinate) {
    vec pull = {}, reach = {};
    for (long k = 0; k < block.n; ++k) {
        const vec w = block.uniform_w ? block.w_uniform : max(block.w[k], block.w[k + 1]);
        pull = max(w * abs(x.tau[k]), pull);
        reach = max(a2_at(x, k), reach);
    }
    reach = sqrt(reach);
    return less(0.25 * (largest_coordinate + sqrt(x.a2_min)), pull * reach);
}

static inline void load_bond_vectors(const Block &block, const Box &box, const Packed &r, vec3 *D, vec *unused) {
    const Packed absent = {};
    if (box.shape == Box::none)
        load_bonds<none_, true, false, false>(block, box, r, absent, absent, D, nullptr, unused);
    else
        load_bonds<none_, true, true, false>(block, box, r, absent, absent, D, nullptr, unused);
}

static void load_positions(const Block &block, const PositionsCall &call, const Packed &r_ref, const Packed &r,
                           const Newton &x) {
    load_bond_vectors(block, call.box, r_ref, x.b, x.s);
    load_bond_vectors(block, call.box, r, x.D, x.s);
    if (!call.guess) return;
    const double factor = 2 * call.dt * call.dt;
    for (long k = 0; k < block.n; ++k)
        for (int i = 0; i < W; ++i) {
            const int lane = i < block.lanes ? i : 0;
            x.tau[k][i] = k < block.len[i] ? factor * call.lambda[block.first_bond[lane] + k] : 0.0;
        }
}

// Moves the atoms of the lanes that have converged. Where that is too coarse, goes on from the coordinates as they are
// now rounded: the moves that remain are small, and so are their roundings. Lanes that do not get there are put back.
template <bool uniform>
static void move_atoms(const Block &block, const PositionsCall &call, const Newton &x, const Packed &r, vec carried,
                       vec largest_coordinate, Outcome &out, Arena arena) {
    const mask coarse = out.converged & coarse_moves(block, x, largest_coordinate);
    double *saved[W] = {};
    if (__builtin_expect(any(coarse), 0))
        for (int i = 0; i < block.lanes; ++i) {
            saved[i] = arena.doubles(3 * (block.len[i] + 1));
            for (long e = 0; e < 3 * (block.len[i] + 1); ++e) saved[i][e] = r.lane[i][e];
        }
    store_pulls<true, uniform>(block, x.b, x.tau, out.converged, add_, r);
    if (__builtin_expect(!any(coarse), 1)) return;
    vec *const total = arena.vecs(block.n);
    mask wanted = coarse;
    for (int pass = 0; pass < 5 && any(wanted); ++pass) {
        for (long k = 0; k < block.n; ++k) total[k] = x.tau[k];
        load_bond_vectors(block, call.box, r, x.D, x.s);
        Outcome again = {};
        vec error = residuals(block, x);
        out.error = select(coarse, error, out.error);
        wanted = wanted & ~less_equal(error, max(splat(call.tolerance), carried));
        if (!any(wanted)) break;
        again = solve_positions<uniform, true>(block, x, call, carried, wanted, false);
        store_pulls<true, uniform>(block, x.b, x.tau, again.converged & wanted, add_, r);
        for (long k = 0; k < block.n; ++k) x.tau[k] = total[k] + keep(again.converged & wanted, x.tau[k]);
    }
    if (!any(wanted)) return;
    const unsigned back = bits(wanted);
    for (int i = 0; i < block.lanes; ++i)
        if (back >> i & 1)
            for (long e = 0; e < 3 * (block.len[i] + 1); ++e) r.lane[i][e] = saved[i][e];
    out.converged = out.converged & ~wanted;
}

template <bool uniform>
static void positions_block_of(const Block &block, const Lane *lane, const PositionsCall &call, Arena arena,
                               Tally &tally) {
    const Packed r_ref = open(call.r_ref, block, lane, arena, true), r = open(call.r, block, lane, arena, true);
    const Packed v = open(call.v, block, lane, arena, true);
    Newton x(block.n, arena);
    set_lengths(block, lane, x, arena);
    const vec largest = extent(block, r), carried = carried_error(call.r, largest, x.a2_min);
    load_positions(block, call, r_ref, r, x);
    Outcome out = solve_positions<uniform, false>(block, x, call, carried, block.in_use(), call.guess);
    move_atoms<uniform>(block, call, x, r, carried, largest, out, arena);
    store_positions<uniform>(block, lane, call, x, out, r, v, tally);
    mask rest = block.in_use() & ~(out.converged | out.untouched);
    if (__builtin_expect(!any(rest), 1)) return;
    // Once more from the start, with new factors at every step and nothing that can overflow on the way.
    load_positions(block, call, r_ref, r, x);
    out = solve_positions<uniform, true>(block, x, call, carried, rest, false);
    out.untouched = out.untouched & rest;
    move_atoms<uniform>(block, call, x, r, carried, largest, out, arena);
    store_positions<uniform>(block, lane, call, x, out, r, v, tally);
    rest = rest & ~(out.converged | out.untouched);
    if (any(rest)) note_bad(block, rest, tally);
}

static void positions_block(const Block &block, const Lane *lane, const PositionsCall &call, Arena arena,
                            Tally &tally) {
    if (block.uniform_w)
        positions_block_of<true>(block, lane, call, arena, tally);
    else
        positions_block_of<false>(block, lane, call, arena, tally);
}

static void positions(const PositionsCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, positions_block);
}

}  // namespace HOL_ISA
}  // namespace holonomic
