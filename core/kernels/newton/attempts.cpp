// Position level of a block of chains once it has been read: a guess, Newton's method (theory (15)-(17)), what is
// done with lanes whose moves are coarse, and what is written. attempts.hpp says what each is for.
#include "core/kernels/newton/attempts.hpp"

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/extended/chain.hpp"
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/load.hpp"

namespace holonomic::HOL_ISA {

static void load_guess(const Block &block, const PositionsCall &call, const Newton &x) {
    const vec factor = (2 * call.dt * call.dt) * block.unit;
    for (int i = 0; i < W; ++i) {
        const int lane = i < block.lanes ? i : 0;
        for (long k = 0; k < block.n; ++k)
            x.tau[k][i] = k < block.len[i] ? factor[i] * call.lambda[block.first_bond[lane] + k] : 0.0;
    }
}

WorstBonds find_worst(const Newton &x, long n, vec first, vec end) {
    WorstBonds worst = {vec{}, first};
    Mover<either> mover(x);
    for (long k = 0; k < n; ++k) {
        const vec number = splat(static_cast<double>(k));
        vec error = {};
        length_error<either>(x, k, false, mover.bond(x, k), error);
        const mask greater = less_equal(first, number) & less(number, end) & less(worst.error, error);
        worst = {select(greater, error, worst.error), select(greater, number, worst.bond)};
    }
    return worst;
}

void note_worst(const Block &block, const Newton &x, const PositionsCall &call, mask which, vec error, Tally &tally) {
    if (!call.report || (tally.worst_chain >= 0 && !any(which & ~less(error, splat(tally.worst))))) return;
    const unsigned chosen = bits(which & block.in_use());
    int worst = -1;
    for (int i = 0; i < block.lanes; ++i) {
        if ((chosen >> i & 1) && take_worst(tally, error[i], block.chain[i])) worst = i;
    }
    if (worst < 0) return;
    const vec bond = find_worst(x, block.n, vec{}, block.lengths()).bond;
    tally.worst_bond = static_cast<int64_t>(bond[worst]);
}

mask coarse_moves(const Block &block, const Newton &x, Carried &carried, mask which, double part) {
    return x.w ? coarse_moves<differ>(block, x, carried, which, part)
               : coarse_moves<same>(block, x, carried, which, part);
}

void move_atoms(const Block &block, const Newton &x, mask which, const Packed &r, const Packed &v, double per_dt,
                long first, const vec3 &before) {
    if (!v.lane[0])
        store_pulls(block, x.w, x.b, x.tau, which, MoveSink<true, false>{r, v, per_dt}, first, before);
    else if (r.lane[0])
        store_pulls(block, x.w, x.b, x.tau, which, MoveSink<true, true>{r, v, per_dt}, first, before);
    else
        store_pulls(block, x.w, x.b, x.tau, which, MoveSink<false, true>{r, v, per_dt}, first, before);
}

void move_first(const Newton &x, unsigned chosen, const Packed &r, const Packed &v, double per_dt) {
    const vec3 pull = x.tau[0] * x.b[0], move = times_w<either>(x, 0, pull);
    if (v.lane[0])
        store_first(move, chosen, MoveSink<true, true>{r, v, per_dt});
    else
        store_first(move, chosen, MoveSink<true, false>{r, v, per_dt});
}

// The same to the lists. Where only `some` lanes move, -0 is added to the others: it takes the sign from no zero.
template <Same masses, bool to_v, bool some>
static void move_listed(const Block &block, const Newton &x, const AtomLists &lists, mask which, double *r, double *v,
                        double per_dt) {
    const AtomLists at = lists;
    const vec rate = splat(per_dt), stay = splat(-0.0);
    vec3 before = {};
    for (long k = 0; k <= block.n; ++k) {
        const vec3 after = x.tau[k] * x.b[k];
        vec3 m = times_w<masses>(x, k, after - before);
        if (some) m = {select(which, m.x, stay), select(which, m.y, stay), select(which, m.z, stay)};
        before = after;
        scatter<add_>(r, at, k, m);
        if (!to_v) continue;
        const vec3 q = gather(v, at, k);
        scatter<write_>(v, at, k, {mul_add(m.x, rate, q.x), mul_add(m.y, rate, q.y), mul_add(m.z, rate, q.z)});
    }
}

void add_virial(const Block &block, const Newton &x, mask which, double dt, Tally &tally) {
    add_virial(block.n, x.b, x.tau, which & block.in_use(), splat(1 / (dt * dt)) / block.unit, tally);
}

// Multipliers and counts of the lanes that are good.
static void note_solved(const Block &block, const Newton &x, const PositionsCall &call, const NewtonOutcome &out,
                        Tally &tally) {
    if (call.lambda) {
        const vec factor = splat(0.5 / (call.dt * call.dt)) / block.unit;
        store_bonds(block, x.tau, factor, out.converged | out.untouched, call.lambda);
    }
    count_moved(tally, __builtin_popcount(bits(out.converged)), out.solves);
}

Positions::Positions(const Block &b, const Lane *l, const PositionsCall &c, const BondLengths &a, Arena memory,
                     Tally &t)
    : block(b), lane(l), call(c), arena(memory), tally(t), r_ref(open(c.r_ref, b, l, arena, true)),
      r(open(c.r, b, l, arena, true)), v(open(c.v, b, l, arena, true)), x(b, a, arena) {}

void Positions::load() const {
    load_bond_vectors(block, call.box_ref, r_ref, x.b);
    load_bond_vectors(block, call.box, r, x.D);
}

// Goes on after a coarse move, from the coordinates as they are rounded. The moves that remain are small, and so
// are their roundings. Puts back the lanes in which this fails, and returns them.
mask Positions::settle(mask coarse, Carried &carried, NewtonOutcome &out) {
    Arena rest = arena;
    double *saved[W] = {};
    for (int i = 0; i < block.lanes; ++i) {
        saved[i] = rest.doubles(3 * (block.len[i] + 1));
        for (long e = 0; e < 3 * (block.len[i] + 1); ++e) saved[i][e] = r.lane[i][e];
    }
    vec *const total = rest.vecs(block.n);
    carried.largest_coordinate();  // of the coordinates as they came
    move_atoms(block, x, out.converged, r, {}, 0);
    mask wanted = coarse;
    for (int pass = 0; pass < 5 && any(wanted); ++pass) {
        for (long k = 0; k < block.n; ++k) {
            total[k] = x.tau[k];
            x.correction[k] = vec{};
        }
        load_bond_vectors(block, call.box, r, x.D);
        x.step = x.correction;
        const vec error = residuals(block, x);
        out.error = select(coarse, error, out.error);
        wanted = wanted & ~less_equal(error, carried.accepted());
        if (!any(wanted)) break;
        const NewtonOutcome again = solve_positions(block, x, call, carried, wanted, false, true);
        const mask moved = again.converged & wanted;
        move_atoms(block, x, moved, r, {}, 0);
        for (long k = 0; k < block.n; ++k) x.tau[k] = total[k] + keep(moved, x.tau[k]);
    }
    const unsigned back = bits(wanted);
    for (int i = 0; i < block.lanes; ++i)
        if (back >> i & 1)
            for (long e = 0; e < 3 * (block.len[i] + 1); ++e) r.lane[i][e] = saved[i][e];
    return wanted;
}

constexpr double turning_part = 0x1p14;

// Does the lanes in which multipliers depend on the last digits of the reference's bonds: such pulls, of atoms some
// 1e5 times lighter than their neighbours, turn with them. There the bonds must not be rounded. Returns the lanes
// that are done; the others are settled.
mask Positions::solve_extended(mask coarse, Carried &carried) {
    mask done = {};
    const unsigned chosen = bits(coarse_moves(block, x, carried, coarse, turning_part));
    for (int i = 0; i < block.lanes; ++i)
        if (chosen >> i & 1 && extended::chain_positions(call, lane[i], const_cast<double *>(arena.end), tally))
            done[i] = -1;
    return done;
}

// Moves the atoms of the lanes that have converged, and writes their other outputs. `moved`: D has been moved by all
// corrections, some of them larger than what they add up to, and has their roundings: so look at the bonds.
void Positions::finish(NewtonOutcome &out, Carried &carried, bool moved) {
    mask coarse = moved ? out.converged : coarse_moves(block, x, carried, out.converged);
    if (__builtin_expect(any(coarse), 0)) {
        extended_lanes = extended_lanes | solve_extended(coarse, carried);
        out.converged = out.converged & ~extended_lanes;
        coarse = coarse & ~extended_lanes;
    }
    const bool settled = __builtin_expect(any(coarse), 0);
    note_worst(block, x, call, (out.converged | out.untouched) & ~coarse, out.error, tally);
    if (settled) out.converged = out.converged & ~settle(coarse, carried, out);
    if (any(out.converged)) {
        if (settled) {
            note_worst(block, x, call, out.converged & coarse, out.error, tally);
            if (call.v.x) move_atoms(block, x, out.converged, {}, v, 1 / call.dt);
        } else {
            move_atoms(block, x, out.converged, r, v, 1 / call.dt);
        }
        close(call.r, block, lane, out.converged, r, false);
        if (call.v.x) close(call.v, block, lane, out.converged, v, false);
        if (call.virial) add_virial(block, x, out.converged, call.dt, tally);
    }
    note_solved(block, x, call, out, tally);
}

void Positions::solve() {
    const mask all = block.in_use();
    load();
    if (block.ahead) {
        x.next[0] = r_ref.lane[0];
        x.next[1] = r.lane[0];
        x.next[2] = v.lane[0];
    }
    if (call.guess) load_guess(block, call, x);
    const Source source = {&call.box, &r};
    Carried carried(block, x, call, source);
    NewtonOutcome out = solve_positions(block, x, call, carried, all, call.guess);
    finish(out, carried, false);
    mask rest = all & ~(out.converged | out.untouched | extended_lanes);
    if (__builtin_expect(!any(rest), 1)) return;
    // Once more from the start, with new factors at every step and nothing that can overflow on the way.
    load();
    out = solve_positions(block, x, call, carried, rest, false, true);
    finish(out, carried, true);
    rest = rest & ~(out.converged | out.untouched | extended_lanes);
    if (any(rest)) note_bad(block, rest, tally);
}

HOL_INLINE vec3 image_of(const Box &box, const vec3 &d) {
    vec3 image = d, unused = {};
    wrap<false>(box, image, unused);
    return image;
}

// Both references and positions: the lists are looked at once.
static void gather_bonds(const Block &block, const PositionsCall &call, const AtomLists &lists, const Newton &x) {
    const AtomLists at = lists;
    const double *const r_ref = base_of(call.r_ref), *const r = base_of(call.r), *const v = base_of(call.v);
    const bool boxed = call.box.lattice != Box::none || call.box_ref.lattice != Box::none;
    vec3 b0 = gather(r_ref, at, 0), r0 = gather(r, at, 0);
    for (long k = 0; k < block.n; ++k) {
        at.fetch(k, block.list_ahead, r_ref, r, v);
        const vec3 b1 = gather(r_ref, at, k + 1), r1 = gather(r, at, k + 1);
        x.b[k] = b1 - b0;
        x.D[k] = r1 - r0;
        b0 = b1;
        r0 = r1;
    }
    for (long k = 0; boxed && k < block.n; ++k) {
        if (call.box_ref.lattice != Box::none) x.b[k] = image_of(call.box_ref, x.b[k]);
        if (call.box.lattice != Box::none) x.D[k] = image_of(call.box, x.D[k]);
    }
}

bool listed_positions(const Block &block, const Lane *lane, const PositionsCall &call, const BondLengths &a,
                      Arena arena, Tally &tally) {
    if (!call.r_ref.packed || !call.r.packed || (call.v.x && !call.v.packed) || !listed(block, lane)) return false;
    const AtomLists at(lane);
    Newton x(block, a, arena);
    gather_bonds(block, call, at, x);
    if (call.guess) load_guess(block, call, x);
    const Source source = {&call.box, nullptr, base_of(call.r), at.atoms};
    Carried carried(block, x, call, source);
    const NewtonOutcome out = solve_positions(block, x, call, carried, block.in_use(), call.guess);
    const mask done = out.converged | out.untouched;
    if (any(~done) || any(coarse_moves(block, x, carried, out.converged))) return false;
    note_worst(block, x, call, done, out.error, tally);
    if (any(out.converged))
        choose(
            [&](auto masses, auto to_v, auto some) {
                move_listed<same_if(masses), to_v, some>(block, x, at, out.converged, base_of(call.r), base_of(call.v),
                                                         1 / call.dt);
            },
            !x.w, call.v.x != nullptr, any(out.untouched));
    if (call.virial) add_virial(block, x, out.converged, call.dt, tally);
    note_solved(block, x, call, out, tally);
    return true;
}

}  // namespace holonomic::HOL_ISA
