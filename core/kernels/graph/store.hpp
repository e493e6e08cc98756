// What the multipliers of a block of molecules do, written to the caller's arrays: values per bond, pulls on atoms,
// virial.
#ifndef HOLONOMIC_KERNELS_GRAPH_STORE_HPP
#define HOLONOMIC_KERNELS_GRAPH_STORE_HPP

#include "core/kernels/graph/atom_groups.hpp"
#include "core/kernels/graph/molecules.hpp"
#include "core/kernels/graph/virial.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// G of the atom at a slot: t d of the bonds that point away from it, less t d of those that point to it.
template <class V>
HOL_INLINE Vector3<V> pull_on(const Molecules<V> &x, int32_t slot) {
    const Schedule &s = x.s;
    Vector3<V> g = {};
    for (int32_t c = s.child_start[slot]; c < s.child_start[slot + 1]; ++c) {
        const BondRow<V> &row = x.row[s.child[c]];
        g = add_times(g, row.t, row.d);
    }
    if (slot < s.n_tree) return add_times(g, -x.row[slot].t, x.row[slot].d);
    if (s.n_core_atoms == 0) return g;
    const int32_t *const meet = s.meet + s.meet_start[slot - s.n_tree];
    const int n = s.meet_start[slot - s.n_tree + 1] - s.meet_start[slot - s.n_tree];
    const V sign[2] = {Width<V>::all(1), Width<V>::all(-1)};
    choose_count(n, [&](auto number) HOL_FORCED {
        constexpr int known = decltype(number)::count;
        HOL_UNROLL
        for (int e = 0; e < (known > 0 ? known : n); ++e) {
            const BondRow<V> &row = x.row[s.n_tree + meet[e] / 2];
            g = add_times(g, sign[meet[e] & 1] * row.t, row.d);
        }
    });
    return g;
}

#if HOL_LANES >= 4 && defined(__AVX2__)
// The same of a single molecule: rows begin with d, so that x, y and z are done at once.
HOL_INLINE Vector3<double> pull_on(const Molecules<double> &x, int32_t slot) {
    if (slot >= x.s.n_tree) return pull_on<double>(x, slot);
    const Schedule &s = x.s;
    quad g = {};
    for (int32_t c = s.child_start[slot]; c < s.child_start[slot + 1]; ++c) {
        const BondRow<double> &row = x.row[s.child[c]];
        g = _mm256_fmadd_pd(_mm256_set1_pd(row.t), _mm256_loadu_pd(&row.d.x), g);
    }
    const BondRow<double> &row = x.row[slot];
    g = _mm256_fnmadd_pd(_mm256_set1_pd(row.t), _mm256_loadu_pd(&row.d.x), g);
    return {g[0], g[1], g[2]};
}
#endif

// The lanes of `which` in which this local atom may be written: not those where it is a fixed one of other molecules,
// too.
template <class V>
HOL_INLINE unsigned writable(const Molecules<V> &x, int32_t atom, unsigned which) {
    for (int i = 0; i < Width<V>::lanes; ++i)
        if (x.lane[i].shared && x.lane[i].shared[atom]) which &= ~(1u << i);
    return which;
}

template <class V>
HOL_INLINE bool any_shared(const Molecules<V> &x) {
    bool shared = false;
    for (int i = 0; i < Width<V>::lanes; ++i) shared = shared || x.lane[i].shared;
    return shared;
}

// Where the results of a linear solve go.
struct Outputs {
    const AtomArray *g;
    double *lambda, *tension;
    bool add, virial;
};

// Writes value(slot) of the atoms in these slots in the lanes of `which`.
template <Layout layout, class V, class Value>
HOL_INLINE void write_slots(const Molecules<V> &x, const AtomArray &array, unsigned which, int32_t first, int32_t end,
                            const Value &value) {
    const bool shared = any_shared(x);
    for (int32_t slot = end; slot-- > first;) {
        const int32_t atom = x.s.atom_of[slot];
        write<layout>(array, x.at, atom, value(slot), shared ? writable(x, atom, which) : which);
    }
}

// Writes value(slot) of all atoms but those of arms in the lanes of `which`, in the order of the atoms where the
// molecule is small.
template <Layout layout, class V, class Value>
HOL_INLINE void write_atoms(const Molecules<V> &x, const AtomArray &array, unsigned which, const Value &value) {
    if (x.pieces || any_shared(x))
        return for_slots(x.s, x.pieces,
                         [&](int32_t first, int32_t end) { write_slots<layout>(x, array, which, first, end, value); });
    for_groups(x.s.n_atoms, [&](int32_t first, auto number) HOL_FORCED {
        constexpr int count = decltype(number)::count;
        Vector3<V> a[count] = {};
        HOL_UNROLL
        for (int j = 0; j < count; ++j) a[j] = value(x.s.slot_of[first + j]);
        write_group<layout, count>(array, x.at, first, a, which);
    });
}

// G of all atoms but those of arms in the lanes of `which`, written or added.
template <Layout layout, class V>
HOL_NOINLINE void write_pulls(const Molecules<V> &x, const AtomArray &g, bool add, unsigned which) {
    if (!add) return write_atoms<layout>(x, g, which, [&](int32_t slot) HOL_FORCED { return pull_on(x, slot); });
    write_atoms<layout>(x, g, which,
                        [&](int32_t slot) { return read<layout>(g, x.at, x.s.atom_of[slot]) + pull_on(x, slot); });
}

// factor t of the bonds at these places, zeros as +0; with_length: times |d|.
template <bool with_length, class V>
HOL_INLINE void write_bonds(const Molecules<V> &x, double factor, double *out, unsigned which, int32_t first,
                            int32_t end) {
    double *p[Width<V>::lanes];
    for (int i = 0; i < Width<V>::lanes; ++i) p[i] = out + x.lane[i].first_bond;
    const bool all = which == (1u << Width<V>::lanes) - 1;
    for (int32_t k = first; k < end; ++k) {
        const BondRow<V> &row = x.row[k];
        V value = mul_add(Width<V>::all(factor), row.t, V{});
        if (with_length) value = mul_add(row.t, sqrt(row.q), V{});
        const int32_t bond = x.s.bond_of[k];
        if (all) {
            HOL_UNROLL
            for (int i = 0; i < Width<V>::lanes; ++i) p[i][bond] = Width<V>::get(value, i);
        } else {
            for (int i = 0; i < Width<V>::lanes; ++i)
                if (which >> i & 1) p[i][bond] = Width<V>::get(value, i);
        }
    }
}
// Of all but those of arms.
template <bool with_length, class V>
HOL_NOINLINE void write_bonds(const Molecules<V> &x, double factor, double *out, unsigned which) {
    for_places(x.s, x.pieces,
               [&](int32_t first, int32_t end) { write_bonds<with_length>(x, factor, out, which, first, end); });
}

// The virial of the lanes of `which`, of all bonds but those of arms.
template <class V>
HOL_NOINLINE void add_pulls_to_virial(const Molecules<V> &x, unsigned which, Tally &tally) {
    MoleculesVirial<V> virial;
    for_places_in_order(x.s, x.pieces, [&](int32_t first, int32_t end) {
        for (int32_t k = first; k < end; ++k) virial.add(x.row[k].d, x.row[k].t * x.row[k].d);
    });
    virial.count(which, 1, tally);
}

// Lanes in which all multipliers are finite, but for those of arms.
template <class V>
HOL_INLINE MaskOf<V> finite_solution(const Molecules<V> &x) {
    V sum = {};
    for_places_in_order(x.s, x.pieces, [&](int32_t first, int32_t end) {
        for (int32_t k = first; k < end; ++k) sum = sum + abs(x.row[k].t);
    });
    return finite(sum);
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
