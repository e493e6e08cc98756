// Rings and strips of triangles, whose slots go along them: what their bonds pull, atom by atom, and the caller's
// arrays in that order, four atoms at a time where they stand one behind the other.
#ifndef HOLONOMIC_KERNELS_GRAPH_ALONG_HPP
#define HOLONOMIC_KERNELS_GRAPH_ALONG_HPP

#include "core/kernels/graph/atom_groups.hpp"
#include "core/kernels/graph/molecules.hpp"
#include "core/kernels/graph/strip.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// The atoms of these local numbers, which may follow each other.
template <Layout layout, int count, class V>
HOL_INLINE void read_few(const AtomArray &array, const Atoms<V> &at, const int32_t *atom, bool follow, Vector3<V> *a) {
    if (follow) return read_group<layout, count>(array, at, atom[0], a);
    HOL_UNROLL
    for (int j = 0; j < count; ++j) a[j] = read<layout>(array, at, atom[j]);
}

// The same in the lanes of `which`; `a` is used up.
template <Layout layout, int count, class V>
HOL_INLINE void write_few(const AtomArray &array, const Atoms<V> &at, const int32_t *atom, bool follow, Vector3<V> *a,
                          unsigned which) {
    if (follow) return write_group<layout, count>(array, at, atom[0], a, which);
    for (int j = 0; j < count; ++j) write<layout>(array, at, atom[j], a[j], which);
}

// Writes next(slot) of all atoms in the lanes of `which`; slots ascend.
template <Layout layout, class V, class Next>
HOL_INLINE void write_along(const Molecules<V> &x, const AtomArray &array, unsigned which, const Next &next) {
    for_groups(x.s.n_atoms, [&](int32_t slot, auto number) HOL_FORCED {
        constexpr int count = number;
        const int32_t *const atom = x.s.atom_of + slot;
        Vector3<V> a[count] = {};
        HOL_UNROLL
        for (int j = 0; j < count; ++j) a[j] = next(slot + j);
        write_few<layout, count>(array, x.at, atom, follow_each_other<count>(atom), a, which);
    });
}

// Moves the atoms of the lanes in `which` by next(slot), and their velocities with them; slots ascend.
template <Layout layout, class V, class Next>
HOL_INLINE void move_along(const Schedule &s, const PositionsCall &call, const Atoms<V> &at, unsigned which,
                           const Next &next) {
    const V per_dt = Width<V>::all(1 / call.dt);
    for_groups(s.n_atoms, [&](int32_t slot, auto number) HOL_FORCED {
        constexpr int count = number;
        const int32_t *const atom = s.atom_of + slot;
        const bool follow = follow_each_other<count>(atom);
        Vector3<V> move[count] = {}, a[count] = {};
        HOL_UNROLL
        for (int j = 0; j < count; ++j) move[j] = next(slot + j);
        read_few<layout, count>(call.r, at, atom, follow, a);
        HOL_UNROLL
        for (int j = 0; j < count; ++j) a[j] = a[j] + move[j];
        write_few<layout, count>(call.r, at, atom, follow, a, which);
        if (!call.v.x) return;
        read_few<layout, count>(call.v, at, atom, follow, a);
        HOL_UNROLL
        for (int j = 0; j < count; ++j) a[j] = add_times(a[j], per_dt, move[j]);
        write_few<layout, count>(call.v, at, atom, follow, a, which);
    });
}

// G of the atoms, one slot after the other.
template <class V>
struct RingPulls {
    const BondRow<V> *row;
    Vector3<V> last;
    HOL_FORCED explicit RingPulls(const Molecules<V> &x) : row(x.row), last(pull_of(x.s.n_bonds - 1)) {}
    HOL_FORCED Vector3<V> pull_of(int32_t place) const { return row[place].t * row[place].d; }
    HOL_FORCED Vector3<V> next(int32_t slot) {
        const Vector3<V> pull = pull_of(slot), sum = pull - last;
        last = pull;
        return sum;
    }
};

template <class V>
struct StripPulls {
    const BondRow<V> *row;
    StripSums<V> sums;
    HOL_FORCED explicit StripPulls(const Molecules<V> &x) : row(x.row), sums{} {}
    HOL_FORCED Vector3<V> pull_of(int32_t place) const { return row[place].t * row[place].d; }
    HOL_FORCED Vector3<V> next(int32_t slot) {
        const int32_t place = first_place_at(slot) + begin_short;
        return sums.next(pull_of(place), pull_of(place + 1));
    }
};

// Calls f with the pulls of a ring or strip; false: it is none.
template <class V, class F>
HOL_INLINE bool with_pulls_along(const Molecules<V> &x, const F &f) {
    if (x.s.type == Schedule::ring) {
        f(RingPulls<V>(x));
        return true;
    }
    if (x.s.is_strip) f(StripPulls<V>(x));
    return x.s.is_strip;
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
