// The atoms of stars in the caller's arrays, and units of stars.
#pragma once

#include "core/kernels/molecules/atoms/consecutive.hpp"
#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/image.hpp"
#include "core/kernels/molecules/small/twin.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic::HOL_ISA::graph {

// Moves the centre to the front, or back to its place.
template <class V>
HOL_NOINLINE void move_centre(Vector3<V> *atoms, int from, int to) {
    const Vector3<V> c = atoms[from];
    for (; from > to; --from) atoms[from] = atoms[from - 1];
    for (; from < to; ++from) atoms[from] = atoms[from + 1];
    atoms[to] = c;
}

// Atoms of the lanes, the centre first.
template <Inlined where, int N, class V>
struct StarAtoms {
    const Atoms<V> &at;
    const int centre;

    inline HOL_FORCED void read(const AtomArray &array, Vector3<V> *r) const {
        read_all<where, N + 1>(array, at, r);
        if (__builtin_expect(centre == 0, 1)) return;
        Vector3<V> atoms[N + 1];
        copy(r, atoms);
        move_centre(atoms, centre, 0);
        copy(atoms, r);
    }
    inline HOL_FORCED void write(const AtomArray &array, Vector3<V> *r, unsigned which) const {
        to_callers_order(r);
        write_all<where, N + 1>(array, at, r, which);
    }
    inline HOL_FORCED void move(const PositionsCall &call, Vector3<V> *r, unsigned which) const {
        to_callers_order(r);
        move_all<where, N + 1>(call, at, r, which);
    }
    inline HOL_FORCED void to_callers_order(Vector3<V> *r) const {
        if (__builtin_expect(centre == 0, 1)) return;
        Vector3<V> atoms[N + 1];
        copy(r, atoms);
        move_centre(atoms, 0, centre);
        copy(atoms, r);
    }
    HOL_STATIC void copy(const Vector3<V> *from, Vector3<V> *to) {
        HOL_UNROLL
        for (int k = 0; k <= N; ++k) to[k] = from[k];
    }
    HOL_STATIC void take_bonds(const Vector3<V> *r, const Box &box, Vector3<V> *d) {
        HOL_UNROLL
        for (int k = 0; k < N; ++k) d[k] = r[k + 1] - r[0];
        take_images<N>(box, d);
    }

    // Values per bond.
    inline HOL_FORCED void write_bonds(double *out, const V *value, unsigned which) const {
        if (N == 3) return write_three<where>(out, at, {value[0], value[1], value[2]}, which);
        for (int i = 0; i < at.lanes; ++i)
            for (int k = 0; k < N; ++k)
                if (which >> i & 1) out[at.bond[i] + k] = Width<V>::get(value[k], i);
    }
    inline HOL_FORCED void read_bonds(const double *in, double factor, V *value) const {
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            HOL_UNROLL
            for (int i = 0; i < at.lanes; ++i) Width<V>::set(value[k], i, in[at.bond[i] + k]);
            value[k] = Width<V>::all(factor) * value[k];
        }
    }
};

// Masses; atoms of a star are counted from its centre, 0.
template <int N, class V>
struct StarMasses {
    V w[N + 1] = {};
    V share[N == 4 ? N : 1] = {};  // w_k / (w_k + w_0)
    // The atom `centre` of a molecule is the centre.
    void set(const MoleculeLane *lane, int used, int centre) {
        for (int k = 0; k <= N; ++k)
            for (int i = 0; i < Width<V>::lanes; ++i)
                Width<V>::set(w[k], i, lane[i < used ? i : 0].w[k == 0 ? centre : k <= centre ? k - 1 : k]);
        if constexpr (N == 4)
            for (int k = 0; k < N; ++k) share[k] = w[k + 1] / (w[k + 1] + w[0]);
    }
};

// Stars of N bonds. verb.solve(atoms, lane, kind, lanes in use) does a block and returns the lanes that are done;
// `general` does any molecule. verb.in_steps: each step waits for the one before, so two blocks go side by side.
template <int N, class Verb, class General>
struct StarWork {
    const Verb &verb;
    const General &general;
    const int centre;
    static constexpr bool in_twins = twins && Verb::in_steps;
    typename Verb::template Kind<N, vec> known;
    typename Verb::template Kind<N, double> known_one;
    typename Verb::template Kind<N, vec> &kind_for(vec *) { return known; }
    typename Verb::template Kind<N, double> &kind_for(double *) { return known_one; }
    typename Verb::template Kind<N, Twin> known_twin;
    typename Verb::template Kind<N, Twin> &kind_for(Twin *) { return known_twin; }

    StarWork(const Verb &v, const General &g, int c) : verb(v), general(g), centre(c) {}

    void in_halves(const MoleculeLane *lane, double *scratch) {
        block<vec>(lane, W, false, scratch);
        block<vec>(lane + W, W, false, scratch);
    }

    template <class V>
    void block(const MoleculeLane *lane, int used, bool same, double *scratch) {
        auto &kind = kind_for(static_cast<V *>(nullptr));
        if (!same) kind.set(lane, used, centre);
        const Atoms<V> at(lane, Width<V>::lanes, general.packed);
        const MaskOf<V> in_use = Width<V>::first(used);
        const auto solve = [&](auto where) {
            return verb.solve(StarAtoms<decltype(where)::value, N, V>{at, centre}, lane, kind, in_use);
        };
        unsigned good;
        if constexpr (!in_twins)
            good = where_atoms_are(at, solve);
        else if constexpr (Width<V>::lanes <= W)
            good = solve(Constant<Inlined, anywhere>{});  // what twins have left
        else if (at.layout == rows_in_order)
            good = solve(Constant<Inlined, in_order>{});
        else if (N == 3 && at.layout == rows_listed)
            good = solve(Constant < Inlined, N == 3 ? listed : in_order > {});
        else
            return in_halves(lane, scratch);
        for (unsigned rest = bits(in_use) & ~good; __builtin_expect(rest != 0, 0); rest &= rest - 1)
            general.template block<double>(lane + __builtin_ctz(rest), 1, false, scratch);
    }
};

// Does as many as fill two blocks at a time. Returns how many.
template <class Work>
static inline int64_t do_twins(const MoleculeUnit &unit, double *scratch, Work &work) {
    constexpr int lanes = Width<Twin>::lanes;
    MoleculeLane next[lanes];
    KnownMasses<Twin> known;
    int64_t done = 0;
    for (; unit.count - done >= lanes; done += lanes) {
        const MoleculeLane *const lane = unit.regular ? next : unit.lanes + done;
        for (int i = 0; unit.regular && i < lanes; ++i) next[i] = molecule_of(unit, done + i);
        work.template block<Twin>(lane, lanes, (unit.regular && done > 0) || known.same(lane, lanes), scratch);
    }
    return done;
}

// Does a unit of stars, if they have N bonds.
template <int N, class Verb, class General>
static inline bool do_stars(const Verb &verb, const General &general, const MoleculeUnit &unit, double *scratch) {
    if constexpr (small_set) return false;  // they are trees, too
    if (unit.elimination->n_bonds != N) return false;
    StarWork<N, Verb, General> work(verb, general, unit.elimination->star_centre);
    int64_t done = 0;
    if constexpr (StarWork<N, Verb, General>::in_twins) done = do_twins(unit, scratch, work);
    if (done == unit.count) return true;
    const MoleculeLane next = molecule_of(unit, done);
    for_each_block(MoleculeUnit{unit.elimination, unit.regular ? &next : unit.lanes + done, unit.count - done,
                                unit.regular, unit.large},
                   scratch, general.ahead, work);
    return true;
}

}  // namespace holonomic::HOL_ISA::graph
