// Position level of a block of chains: load, iterate (newton/iterate.hpp), move the atoms, store.
#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/atom_rows.hpp"
#include "core/kernels/memory/parts.hpp"
#include "core/kernels/memory/small.hpp"
#include "core/kernels/newton/attempts.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

// Small molecules. Where a lane needs more than the first attempt, its W molecules are left to the general path.

// Masses and lengths of blocks of N bonds for Newton's method. `uniform`: there is only one inverse mass, and one
// length; else both have tables. No function that is called gets the memory of the bond vectors, so that these stay in
// registers.
template <class View, bool uniform>
struct SmallNewton {
    static constexpr int N = View::bonds;
    BlockMasses<View> masses;
    const Block &block;
    vec w[N + 1], lengths[2 * N];

    SmallNewton(const Unit &unit, const Block &given, Newton &x) : masses(given), block(masses.block) {
        if constexpr (!View::irregular && W == 1) {
            set(unit.lanes, x);
        } else if constexpr (!View::irregular) {
            Lane lane[W];
            for (int i = 0; i < W; ++i) lane[i] = unit.lanes[0];
            set(lane, x);
        }
    }
    HOL_FORCED void take(const View &view, Newton &x) {
        if constexpr (View::irregular)
            if (masses.take(view)) set(view.lane, x);
    }
    HOL_FORCED void set(const Lane *lane, Newton &x) {
        Arena rest(reinterpret_cast<double *>(lengths), reinterpret_cast<double *>(lengths + 2 * N));
        const BondLengths found = bond_lengths(block, lane, rest, !uniform);
        x.a_min = found.a_min;  // one by one: x is shown to no function that is not known here, and stays in registers
        x.a_max = found.a_max;
        x.per_a_min = found.per_a_min;
        x.a2_uniform = found.a2_uniform;
        x.per_a2_uniform = found.per_a2_uniform;
        x.a2 = uniform ? nullptr : lengths;
        x.per_a2 = uniform ? nullptr : lengths + N;
        x.lengths = splat(N);
        for (int k = 0; k <= N; ++k) w[k] = block.uniform_w ? splat(1.0) : block.w[k];
        x.w = uniform ? nullptr : w;
    }
};

// Vectors of scratch that Newton's method takes.
template <int N>
constexpr int64_t small_scratch = vectors_per_bond *(N + 2 * W + 8);

// What is asked of a call for every block, found once.
template <class View>
struct SmallCall {
    typedef decltype(View::array(AtomArray{})) Array;
    const Box &box_ref, &box;
    const Array r_ref, r, v;
    double *const lambda;
    const double per_dt, per_dt2, factor;  // the last of multipliers, without the unit of masses
    explicit SmallCall(const PositionsCall &c)
        : box_ref(c.box_ref), box(c.box), r_ref(View::array(c.r_ref)), r(View::array(c.r)), v(View::array(c.v)),
          lambda(c.lambda), per_dt(1 / c.dt), per_dt2(1 / (c.dt * c.dt)), factor(0.5 / (c.dt * c.dt)) {}
};

// The bond vectors of a block, and its atoms as they come: in a row only where there is a box.
template <bool boxed, class View>
HOL_INLINE void load_positions(const SmallCall<View> &call, const View &view, const Newton &x, vec *atoms,
                               Carried &carried) {
    constexpr int N = View::bonds;
    view.fetch_next(call.r_ref);
    view.fetch_next(call.r);
    view.fetch_next(call.v);
    load_bonds<boxed, false>(call.box_ref, view, call.r_ref, atoms, x.b);
    load_bonds<boxed, boxed || !View::in_row>(call.box, view, call.r, atoms, x.D);
    if ((!boxed && View::packed) || (W == 1 && View::in_row && call.box.lattice == Box::none)) return;
    vec largest = {};  // in a box the lengths of bonds say nothing of coordinates
    HOL_UNROLL
    for (int e = 0; e < 3 * (N + 1); ++e) largest = max(largest, abs(atoms[e]));
    carried.know_largest(largest);
}

// Moves the atoms of a block. `some`: not in lanes that are `untouched`.
template <bool uniform, bool some, class View>
HOL_INLINE void move_molecules(const SmallCall<View> &call, const View &view, const Newton &x, const vec *atoms,
                               mask untouched) {
    constexpr int N = View::bonds;
    const auto r = call.r, v = call.v;
    vec move[vectors_of<N>] = {}, moved[vectors_of<N>];
    vec3 before = {};
    HOL_UNROLL
    for (int k = 0; k <= N; ++k) {
        const vec3 after = x.tau[k] * x.b[k], m = times_w<same_if(uniform)>(x, k, after - before);
        move[3 * k] = m.x;
        move[3 * k + 1] = m.y;
        move[3 * k + 2] = m.z;
        before = after;
    }
    // Not by zeros, which would take the sign from a number that is -0.
    if (some && any(untouched)) {
        HOL_UNROLL
        for (int e = 0; e < 3 * (N + 1); ++e) move[e] = select(untouched, splat(-0.0), move[e]);
    }
    if constexpr (View::in_row) {
        typedef typename View::Lanes Lanes;
        if (v)
            store_rows<3 * (N + 1)>(move, MoveSink<true, true, Lanes>{view.lanes_of(r), view.lanes_of(v), call.per_dt});
        else
            store_rows<3 * (N + 1)>(move, MoveSink<true, false, Lanes>{view.lanes_of(r), {}, call.per_dt});
    } else {
        HOL_UNROLL
        for (int e = 0; e < 3 * (N + 1); ++e) moved[e] = atoms[e] + move[e];
        store_molecules<write_>(view, moved, r);
        if (v) {
            load_molecules(view, v, moved);
            HOL_UNROLL
            for (int e = 0; e < 3 * (N + 1); ++e) moved[e] = mul_add(move[e], splat(call.per_dt), moved[e]);
            store_molecules<write_>(view, moved, v);
        }
    }
}

// The same, out of the way: it would take the registers of blocks that move as a whole.
template <bool uniform, class View>
HOL_NOINLINE void move_some_molecules(const SmallCall<View> &call, const View &view, const Newton &x, const vec *atoms,
                                      mask untouched) {
    move_molecules<uniform, true>(call, view, x, atoms, untouched);
}

// Moves the atoms of a block, but in lanes that are `untouched`, and writes its multipliers.
template <bool uniform, class View>
HOL_INLINE void write_positions(const SmallCall<View> &call, const View &view, const Block &block, const Newton &x,
                                const vec *atoms, mask untouched) {
    constexpr bool few = View::bonds <= 2 || !View::in_row;
    if (few || __builtin_expect(!any(untouched), 1)) {
        move_molecules<uniform, few>(call, view, x, atoms, untouched);
    } else if (bits(untouched) != all_lanes) {
        const Newton copy = x;
        move_some_molecules<uniform>(call, view, copy, atoms, untouched);
    }
    if (call.lambda) store_multipliers(view, x.tau, splat(call.factor) / block.unit, call.lambda);
}

// So many blocks in a row, all of whose molecules were right, say that the next ones may be, too. After a single one
// the guess would often be wrong where the tolerance is about as large as what a step leaves.
constexpr int enough_right = 2;

template <bool uniform, bool boxed, class View>
HOL_NOINLINE int64_t pass_over_right_ones(const PositionsCall &, const Unit &, const Block &, int64_t first,
                                          int64_t end);

// Columns are read once: their largest coordinate is known.
template <class View, class Array>
HOL_INLINE Source source_of(const View &view, const Array &r, const Box &box) {
    if constexpr (View::packed)
        return view.source(r, box);
    else
        return {&box};
}

// How many molecules the next block has; 0: none is left. A look at all irregular ones beforehand took a tenth of the
// time.
template <class View>
HOL_INLINE int64_t next_block(const Unit &unit, int64_t first, int64_t end) {
    const int64_t most = View::next(first, end);
    int64_t n = View::irregular ? 0 : most;
    while (n < most && unit.lanes[first + n].n_bonds == View::bonds) ++n;
    return n;
}

// How many of the first n lanes have been moved.
HOL_INLINE int n_moved(const NewtonOutcome &out, int64_t n) {
    return __builtin_popcount(bits(out.converged & first_lanes(static_cast<int>(n))));
}

// The first attempt at a block. False if that is not enough for one of its lanes. Molecules that are right as they came
// have no multipliers, and stay where they are: so does a dimer that turns freely under velocity Verlet, in which each
// step undoes what the one before it did to the length. `fewest`: two bonds by the fewest solves.
template <bool uniform, bool fewest, int N>
HOL_INLINE bool solve_molecules(const Block &block, Newton &x, const PositionsCall &call, Carried &carried,
                                NewtonOutcome &out) {
    constexpr Same all = same_if(uniform);
    const mask lanes = first_lanes(W);
    if (N == 1)
        out = solve_single_bonds<all>(x, carried, lanes);
    else if (N == 2)
        out = solve_two_bonds<all, all, fewest>(x, carried, lanes, call.max_iterations);
    else
        out = iterate<all, all, N>(block, x, call, carried, lanes, false, false);
    return !any(~(out.converged | out.untouched)) &&
           !any(coarse_moves<all, N>(block, x, carried, out.converged, coarse_part));
}

// Notes the worst bond of a block for the report. Few blocks have one that is worse than what was before.
template <class View>
HOL_INLINE void note_block(const PositionsCall &call, const View &view, Block &block, const Newton &x,
                           const NewtonOutcome &out, Tally &tally) {
    if (tally.worst_chain >= 0 && !any(~less(out.error, splat(tally.worst)))) return;
    for (int i = 0; i < W; ++i) block.chain[i] = view.chain_of(i);
    const Newton copy = x;  // neither x nor the view is shown to a function that is not known here
    note_worst(block, copy, call, first_lanes(W), out.error, tally);
}

// Single bonds, two blocks at a time: while one waits for its root and its quotient, the other is worked on. Ends
// before a pair of blocks of which one needs more than this.
template <class View, bool uniform, bool boxed>
HOL_NOINLINE int64_t pairs_of_single_bonds(const PositionsCall &call, const Unit &unit, const Block &given,
                                           int64_t first, Tally &tally) {
    const SmallCall<View> arrays(call);
    vec memory[2][small_scratch<1>];
    Arena arena_a(reinterpret_cast<double *>(memory[0]), 1), arena_b(reinterpret_cast<double *>(memory[1]), 1);
    Newton x_a(1, arena_a), x_b(1, arena_b);
    SmallNewton<View, uniform> a(unit, given, x_a), b(unit, given, x_b);
    const int64_t end = View::end(unit, first);
    int right = 0;
    for (; end - first >= 2 * W; first += 2 * W) {
        const View at_a(unit, first, W), at_b(unit, first + W, W);
        const Source r_a = at_a.source(arrays.r, call.box), r_b = at_b.source(arrays.r, call.box);
        Carried carried_a(a.block, x_a, call, r_a), carried_b(b.block, x_b, call, r_b);
        vec atoms_a[vectors_of<1>], atoms_b[vectors_of<1>];
        load_positions<boxed>(arrays, at_a, x_a, atoms_a, carried_a);
        load_positions<boxed>(arrays, at_b, x_b, atoms_b, carried_b);
        constexpr Same all = same_if(uniform);
        const NewtonOutcome out_a = solve_single_bonds<all>(x_a, carried_a, first_lanes(W)),
                            out_b = solve_single_bonds<all>(x_b, carried_b, first_lanes(W));
        if (any(~(out_a.converged | out_a.untouched) | ~(out_b.converged | out_b.untouched) |
                coarse_moves<all, 1>(a.block, x_a, carried_a, out_a.converged, coarse_part) |
                coarse_moves<all, 1>(b.block, x_b, carried_b, out_b.converged, coarse_part)))
            break;
        write_positions<uniform>(arrays, at_a, a.block, x_a, atoms_a, out_a.untouched);
        write_positions<uniform>(arrays, at_b, b.block, x_b, atoms_b, out_b.untouched);
        const int moved = n_moved(out_a, W) + n_moved(out_b, W);
        count_moved(tally, moved, 1);
        right = moved ? 0 : right + 1;
        if (__builtin_expect(right >= enough_right, 0))
            first = pass_over_right_ones<uniform, boxed, View>(call, unit, given, first + 2 * W, end) - 2 * W;
    }
    return first;
}

// Does molecules from `first` on. Returns the first one that is not done.
template <class View, bool uniform, bool boxed, bool virial, bool fewest>
HOL_NOINLINE int64_t positions_of_molecules(const PositionsCall &call, const Unit &unit, Block &given, int64_t first,
                                            Tally &tally) {
    constexpr int N = View::bonds;
    const SmallCall<View> arrays(call);
    vec memory[small_scratch<N>];
    Arena arena(reinterpret_cast<double *>(memory), N);
    Newton x(N, arena);
    SmallNewton<View, uniform> newton(unit, given, x);
    const Block &block = newton.block;
    const int64_t end = View::irregular ? unit.count : View::end(unit, first);
    int right = 0;
    for (int64_t n; (n = next_block<View>(unit, first, end)) > 0; first += n) {
        const View view(unit, first, n);
        newton.take(view, x);
        const Source r = source_of(view, arrays.r, call.box);
        Carried carried(block, x, call, r);
        vec atoms[vectors_of<N>];
        NewtonOutcome out;
        load_positions<boxed>(arrays, view, x, atoms, carried);
        if (!solve_molecules<uniform, fewest, N>(block, x, call, carried, out)) break;
        if (call.report) note_block(call, view, View::alike ? given : newton.masses.own, x, out, tally);
        write_positions<uniform>(arrays, view, block, x, atoms, out.untouched);
        if (virial || (N >= fewest_with_virial && __builtin_expect(call.virial, 0)))
            count_virial<N>(x.b, x.tau, n, splat(arrays.per_dt2) / block.unit, tally);
        const int moved = n_moved(out, n);
        count_moved(tally, moved, out.solves);
        right = moved ? 0 : right + 1;
        if (!View::irregular && __builtin_expect(right >= enough_right, 0) && !call.report)
            first = pass_over_right_ones<uniform, boxed, View>(call, unit, given, first + n, end) - n;
    }
    return first;
}

// Once all molecules of a block were right as they came, the next ones may be, too: then their lengths are all that is
// looked at. Returns the first molecule of a block in which one is not.
template <bool uniform, bool boxed, class View>
HOL_NOINLINE int64_t pass_over_right_ones(const PositionsCall &call, const Unit &unit, const Block &given,
                                          int64_t first, int64_t end) {
    constexpr int N = View::bonds;
    constexpr Same all = same_if(uniform);
    const SmallCall<View> arrays(call);
    vec memory[small_scratch<N>];
    Arena arena(reinterpret_cast<double *>(memory), N);
    Newton x(N, arena);
    SmallNewton<View, uniform> newton(unit, given, x);
    for (int64_t n; (n = View::next(first, end)) > 0; first += n) {
        const View view(unit, first, n);
        const Source r = source_of(view, arrays.r, call.box);
        Carried carried(newton.block, x, call, r);
        vec atoms[vectors_of<N>], worst = {}, sum = {};
        load_positions<boxed>(arrays, view, x, atoms, carried);
        HOL_UNROLL
        for (int k = 0; k < N; ++k) sum = sum + dot(x.D[k], x.b[k]) + length_error<all>(x, k, false, x.D[k], worst);
        // A reference that is no number is for the others to refuse.
        if (any(~carried.within(largest_error<all>(x, worst, sum), splat(1.0)))) break;
        if (!call.lambda) continue;
        HOL_UNROLL
        for (int k = 0; k < N; ++k) x.tau[k] = vec{};
        store_multipliers(view, x.tau, splat(1.0), call.lambda);
    }
    return first;
}

// Bonds of chains that are read from columns: of longer ones copies are a small part of the work.
constexpr int most_in_columns = 2;

static inline int64_t small_positions(const PositionsCall &call, const Unit &unit, Block &block, int64_t first,
                                      Tally &tally) {
    if (call.guess) return first;
    if (unit.lanes[unit.regular ? 0 : first].n_bonds == 2 && !tries_two_bonds(call)) return first;
    const bool packed = call.r.packed && call.r_ref.packed && (!call.v.x || call.v.packed);
    const bool has_box = call.box.lattice != Box::none || call.box_ref.lattice != Box::none;
    const bool one_length = !unit.lanes[0].length;
    const auto kernel = [&](auto view, auto uniform, auto boxed) {
        typedef typename decltype(view)::type View;
        if constexpr (View::in_row && View::bonds == 1 && W > 1)
            if (!call.report && !call.virial)
                first = pairs_of_single_bonds<View, uniform, boxed>(call, unit, block, first, tally);
        return with_virial_or_not<View, boxed>(call.virial, [&](auto virial, auto box) {
            // The loop for more solves takes registers of two bonds: 1.04 of the time. From the first block on that
            // needs them, all are thought to need them.
            if constexpr (View::bonds == 2 && View::packed && !virial && W > 1 && few_registers)
                first = positions_of_molecules<View, uniform, box, virial, true>(call, unit, block, first, tally);
            return positions_of_molecules<View, uniform, box, virial, false>(call, unit, block, first, tally);
        });
    };
    if (packed) return any_molecules(unit, block, first, has_box, one_length, kernel);
    return reads_columns(call) ? molecules_in_columns<most_in_columns>(unit, block, first, has_box, one_length, kernel)
                               : first;
}

static void positions_of_blocks(const PositionsCall &call, const Unit &unit, double *scratch, Tally &tally) {
    BondLengths lengths = {};
    const double *begin = nullptr;
    double *end = nullptr;
    for_each_block(
        call, unit, scratch, tally,
        [&](const Block &block, const Lane *lane, const PositionsCall &, Arena arena, Tally &) {
            if (unit.regular && begin == arena.next) {  // as the chains of the block before, and in place
                arena.next = end;
            } else {
                begin = arena.next;
                lengths = bond_lengths(block, lane, arena);
                end = arena.next;
            }
            if (!block.staged || !listed_positions(block, lane, call, lengths, arena, tally))
                Positions(block, lane, call, lengths, arena, tally).solve();
        },
        small_positions, false);
}

// Arrays that are not packed.
HOL_NOINLINE void positions_in_parts(const PositionsCall &call, const Unit &unit, double *scratch, Tally &tally) {
    const bool in_columns = reads_columns(call) && fit_columns<most_in_columns>(unit, false);
    const auto blocks = [=](const PositionsCall &c, const Unit &u, Tally &own) {
        positions_of_blocks(c, u, scratch, own);
    };
    if (in_columns || !in_packed_parts(call, unit, tally, blocks)) positions_of_blocks(call, unit, scratch, tally);
}

void positions(const PositionsCall &call, const Unit &unit, double *scratch, Tally &tally) {
    if (__builtin_expect(!call.r.packed, 0)) return positions_in_parts(call, unit, scratch, tally);
    positions_of_blocks(call, unit, scratch, tally);
}

}  // namespace holonomic::HOL_ISA
