// Positions of small molecules of one kind: the arithmetic of verbs/positions.cpp, with the
// number of bonds known to the compiler. Where a lane needs more than that, its W molecules are left to the general
// path.
#ifndef HOLONOMIC_KERNELS_VERBS_POSITIONS_SMALL_HPP
#define HOLONOMIC_KERNELS_VERBS_POSITIONS_SMALL_HPP

#include "core/kernels/memory/loose.hpp"
#include "core/kernels/memory/packed.hpp"
#include "core/kernels/newton/iterate.hpp"
#include "core/kernels/newton/outputs.hpp"
#include "core/kernels/newton/small_moves.hpp"
#include "core/kernels/verbs/small.hpp"

namespace holonomic {
namespace HOL_ISA {

// A call, for the molecules of a unit.
struct MoleculesCall {
    const PositionsCall &call;
    const Unit &unit;
    const Block &block;  // of a regular unit
    double *r_ref, *r, *v;
    double per_dt, factor;  // of multipliers, without the unit of masses

    MoleculesCall(const PositionsCall &c, const Unit &u, const Block &b)
        : call(c), unit(u), block(b), r_ref(base_of(c.r_ref)), r(base_of(c.r)), v(base_of(c.v)), per_dt(1 / c.dt),
          factor(0.5 / (c.dt * c.dt)) {}
};

// Inverse masses and lengths of molecules of N bonds, as verbs/positions.cpp has them of any block; `uniform`: of both
// there is only one.
template <int N, bool uniform, template <int> class PlaceOf>
struct Molecules {
    typedef PlaceOf<N> Place;
    BlockMasses<N, Place::loose> masses;
    const Block &block;
    vec w[N + 1], a2[N], per_a2[N];

    Molecules(const MoleculesCall &m, Newton &x) : masses(m.block), block(masses.block) {
        if (Place::loose) return;
        Lane lane[W];
        for (int i = 0; i < W; ++i) lane[i] = m.unit.lanes[0];
        set(lane, x);
    }
    Molecules(const Molecules &) = delete;
    Molecules &operator=(const Molecules &) = delete;

    HOL_FORCED void take(const Place &place, Newton &x) {
        if constexpr (Place::loose)
            if (masses.take(place)) set(place.lane, x);
    }
    void set(const Lane *lane, Newton &x) {
        x.lengths = splat(N);
        x.a_min = splat(1e300);
        x.a_max = vec{};
        for (int k = 0; k < N; ++k) {
            vec a;
            for (int i = 0; i < W; ++i) a[i] = lane[i].length ? lane[i].length[k] : lane[i].length_uniform;
            x.a_min = min(a, x.a_min);
            x.a_max = max(a, x.a_max);
            a2[k] = a * a;
            per_a2[k] = splat(1.0) / a2[k];
        }
        x.per_a_min = splat(1.0) / x.a_min;
        x.a2_uniform = x.a_min * x.a_min;
        x.per_a2_uniform = splat(1.0) / x.a2_uniform;
        for (int k = 0; k <= N; ++k) w[k] = block.uniform_w ? splat(1.0) : block.w[k];
        x.w = uniform ? nullptr : w;
        x.a2 = uniform ? nullptr : a2;
        x.per_a2 = uniform ? nullptr : per_a2;
    }
};

template <int N>
HOL_INLINE void load_molecules(const Block &block, const double *r, vec3 *D) {
    for (int k0 = 0; k0 < N; k0 += W) {
        LaneRows rows;
        vec3 d[W];
        for (int i = 0; i < W; ++i) rows.pr[i] = r + 3 * (N + 1) * i + 3 * k0;
        load_chunk<bonds_alone, true, false, false>(block, Box{}, k0, rows, d, nullptr, nullptr);
        for (int a = 0; a < W && k0 + a < N; ++a) D[k0 + a] = d[a];
    }
}

// Bond vectors, and the atoms with their largest coordinate where it is not looked for later.
template <int N, bool boxed, class Place>
HOL_INLINE void load_positions(const MoleculesCall &m, const Place &place, const Newton &x, vec *atoms,
                               Carried &carried) {
    if constexpr (boxed) {
        place.load(m.r_ref, atoms);
        take_bonds<N, true>(m.call.box_ref, atoms, x.b);
        place.load(m.r, atoms);
        take_bonds<N, true>(m.call.box, atoms, x.D);
        vec largest = {};
        HOL_UNROLL
        for (int e = 0; e < 3 * (N + 1); ++e) largest = max(largest, abs(atoms[e]));
        carried.know_largest(largest);
    } else {
        load_molecules<N>(m.block, m.r_ref + place.at, x.b);
        load_molecules<N>(m.block, m.r + place.at, x.D);
    }
}

// The worst bond of a block.
template <int N, bool uniform, class Place>
HOL_INLINE void note_molecules(const Newton &x, vec error, const Place &place, Tally &tally) {
    if (tally.worst_chain >= 0 && !any(~less(error, splat(tally.worst)))) return;
    int worst = -1;
    for (int i = 0; i < W; ++i) {
        if (!is_worse(tally, error[i], place.chain_of(i))) continue;
        tally.worst = error[i];
        tally.worst_chain = place.chain_of(i);
        worst = i;
    }
    if (worst < 0) return;
    Mover<uniform> mover(x);
    bool found = false;
    tally.worst_bond = 0;
    vec largest = {};
    for (int k = 0; k < N; ++k) {
        length_error<uniform>(x, k, false, mover.bond(x, k), largest);
        if (found || !(relative_error<uniform>(x, largest)[worst] >= error[worst])) continue;
        found = true;
        tally.worst_bond = k;
    }
}

// Whether no atom is pulled so far that its move needs more than this path.
template <int N, bool uniform>
HOL_INLINE bool moves_little(const Newton &x) {
    vec pull = {};
    for (int k = 0; k < N; ++k) pull = max(uniform ? abs(x.tau[k]) : max(x.w[k], x.w[k + 1]) * abs(x.tau[k]), pull);
    return !any(less(0.25 * x.a_min, pull * x.a_max));
}

// Moves the atoms of a block, and writes its multipliers.
template <int N, bool uniform, class Place>
HOL_INLINE void write_molecules(const MoleculesCall &m, const Block &block, const Newton &x, const Place &place,
                                const vec *atoms) {
    if constexpr (Place::listed)
        move_listed_molecules<N, uniform>(x, place, atoms, m.r, m.v, m.per_dt);
    else
        move_molecules<N, uniform>(x, m.r + place.at, m.v ? m.v + place.at : nullptr, m.per_dt);
    if (m.call.lambda) place.store_multipliers(x.tau, splat(m.factor) / block.unit, m.call.lambda);
}

// Single bonds, two blocks at a time: while one waits for its root and its quotient, the other is worked on. Ends
// before a pair of blocks of which one needs more than this.
template <bool uniform, bool boxed, template <int> class PlaceOf>
HOL_NOINLINE int64_t pairs_of_single_bonds(const MoleculesCall &m, int64_t first, Tally &tally) {
    typedef PlaceOf<1> Place;
    vec memory[2][vectors_per_bond * (2 * W + 9)];
    Arena arenas[2] = {Arena(&memory[0][0][0], 1), Arena(&memory[1][0][0], 1)};
    Newton a(1, arenas[0]), b(1, arenas[1]);
    Molecules<1, uniform, PlaceOf> of_a(m, a), of_b(m, b);
    const int64_t end = Place::end(m.unit, first);
    for (int64_t n; (n = Place::next(first + W, end)) > 0; first += W + n) {
        const Place at_a(m.unit, first, W), at_b(m.unit, first + W, n);
        of_a.take(at_a, a);
        of_b.take(at_b, b);
        const Packed r_a = at_a.first_atoms(m.r), r_b = at_b.first_atoms(m.r);
        Carried carried_a(of_a.block, a, m.call, r_a, at_a.lists()),
            carried_b(of_b.block, b, m.call, r_b, at_b.lists());
        vec atoms_a[vectors_of<1>], atoms_b[vectors_of<1>];
        load_positions<1, boxed>(m, at_a, a, atoms_a, carried_a);
        load_positions<1, boxed>(m, at_b, b, atoms_b, carried_b);
        const Outcome done_a = solve_single_bonds<uniform>(a, carried_a, first_lanes(W));
        const Outcome done_b = solve_single_bonds<uniform>(b, carried_b, first_lanes(W));
        if (any(~(done_a.converged & done_b.converged)) || !moves_little<1, uniform>(a) || !moves_little<1, uniform>(b))
            break;
        write_molecules<1, uniform>(m, of_a.block, a, at_a, atoms_a);
        write_molecules<1, uniform>(m, of_b.block, b, at_b, atoms_b);
        tally.n_corrected += W + n;
        if (tally.iterations < 1) tally.iterations = 1;
    }
    return first;
}

// From molecule `first` on; returns the first one that is not done.
template <int N, bool uniform, bool boxed, template <int> class PlaceOf>
HOL_NOINLINE int64_t positions_of_molecules(const MoleculesCall &m, int64_t first, Tally &tally) {
    typedef PlaceOf<N> Place;
    vec memory[vectors_per_bond * (N + 2 * W + 8)];
    Arena arena(reinterpret_cast<double *>(memory), N);
    Newton x(N, arena);
    Molecules<N, uniform, PlaceOf> molecules(m, x);
    const Block &block = molecules.block;
    const mask all = first_lanes(W);
    const int64_t end = Place::end(m.unit, first);
    for (int64_t n; (n = Place::next(first, end)) > 0; first += n) {
        const Place place(m.unit, first, n);
        molecules.take(place, x);
        if (fetches_next<Place>(m.unit, first)) {
            place.fetch_next(m.r_ref);
            place.fetch_next(m.r);
            place.fetch_next(m.v);
        }
        const Packed r = place.first_atoms(m.r);
        Carried carried(block, x, m.call, r, place.lists());
        vec atoms[vectors_of<N>];
        load_positions<N, boxed>(m, place, x, atoms, carried);
        Outcome out = {};
        if (N == 1) {
            out = solve_single_bonds<uniform>(x, carried, all);
            x.tau[0] = keep(all, x.tau[0]);
        } else if (N == 2 && tries_two_bonds(m.call)) {
            out = solve_two_bonds<uniform, uniform>(x, carried, all);
        } else {
            out = iterate<uniform, uniform, false, N>(block, x, m.call, carried, all, false);
        }
        if (any(~out.converged)) break;
        if (!moves_little<N, uniform>(x)) break;
        if (m.call.report) note_molecules<N, uniform>(x, out.error, place, tally);
        write_molecules<N, uniform>(m, block, x, place, atoms);
        tally.n_corrected += n;
        if (out.solves > tally.iterations) tally.iterations = out.solves;
    }
    return first;
}

template <int N, bool uniform, bool boxed, template <int> class PlaceOf>
struct PositionsOfMolecules {
    static int64_t run(const PositionsCall &call, const Unit &unit, const Block &block, int64_t first, Tally &tally) {
        const MoleculesCall m(call, unit, block);
        if constexpr (N == 1 && W > 1) {
            if (!call.report) first = pairs_of_single_bonds<uniform, boxed, PlaceOf>(m, first, tally);
        }
        return positions_of_molecules<N, uniform, boxed, PlaceOf>(m, first, tally);
    }
};

static inline int64_t small_positions(const PositionsCall &call, const Unit &unit, const Block &block, int64_t first,
                                      Tally &tally) {
    if (!call.r.packed || !call.r_ref.packed || (call.v.x && !call.v.packed) || call.virial || call.guess) return first;
    const bool boxed = call.box.shape != Box::none || call.box_ref.shape != Box::none;
    return any_molecules<PositionsOfMolecules>(call, unit, block, first, boxed, tally, !unit.lanes[0].length);
}

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
