// A molecule as the extended-precision solver sees it: unrounded bond vectors, in units in which no product can
// overflow.
#pragma once

#include "core/kernels/atom.hpp"
#include "core/kernels/extended/image.hpp"
#include "core/kernels/extended/plan.hpp"

namespace holonomic::HOL_ISA::extended {

// Hands out scratch memory from front to back.
struct ByteArena {
    char *next;
    template <class T>
    T *take(int64_t n) {
        T *const p = reinterpret_cast<T *>(next);
        next += (n * static_cast<int64_t>(sizeof(T)) + 63) / 64 * 64;
        return p;
    }
};

HOL_INLINE Vector3<double> read(const AtomArray &array, const MoleculeLane &lane, int64_t i) {
    double x[3];
    read_atom(array, atom_of(lane, i), x);
    return {x[0], x[1], x[2]};
}

HOL_INLINE void write(const AtomArray &array, const MoleculeLane &lane, int64_t i, const Vector3<double> &value) {
    const double x[3] = {value.x, value.y, value.z};
    write_atom(array, atom_of(lane, i), x);
}

HOL_INLINE bool is_finite(double a) { return a - a == 0; }
HOL_INLINE bool is_finite(const Vector3<double> &a) { return is_finite(a.x) && is_finite(a.y) && is_finite(a.z); }

HOL_INLINE Wide3 difference(const Vector3<double> &from, const Vector3<double> &to) {
    return {two_difference(to.x, from.x), two_difference(to.y, from.y), two_difference(to.z, from.z)};
}

// Returns the largest power of two that is not above a.
HOL_INLINE double power_below(double a) {
    long long bits;
    __builtin_memcpy(&bits, &a, sizeof a);
    bits &= 0x7ff0000000000000LL;
    __builtin_memcpy(&a, &bits, sizeof a);
    return a;
}

struct ScaledMolecule {
    const ExtendedPlan &plan;
    const MoleculeLane &lane;
    Wide3 *d;          // [n_bonds] from atom i to atom j, over `unit` of the bond
    double *unit;      // [n_bonds] a power of two
    double *w;         // [n_atoms] over mass_unit
    double mass_unit;  // a power of two
    ScaledMolecule(const ExtendedPlan &p, const MoleculeLane &l, ByteArena &memory)
        : plan(p), lane(l), d(memory.take<Wide3>(p.n_bonds)), unit(memory.take<double>(p.n_bonds)),
          w(memory.take<double>(p.n_atoms)), mass_unit(1) {}

    // Returns the vector of bond k away from atom i.
    Wide3 outward(const Wide3 *v, int32_t k, int32_t i) const { return plan.atom_i[k] == i ? v[k] : -v[k]; }
    int32_t other(int32_t k, int32_t i) const { return plan.atom_i[k] + plan.atom_j[k] - i; }
};

// Whether its units are ordinary ones (call.hpp), up to the rounding of exponents there.
HOL_NOINLINE bool is_in_ordinary_units(const ScaledMolecule &m) {
    double longest = 0;
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) longest = m.unit[k] > longest ? m.unit[k] : longest;
    constexpr double most_length = 2.0 * (1LL << most_ordinary_length), most_mass = 0x1p94;
    static_assert(most_ordinary_mass == 92, "");
    return longest <= most_length && longest >= 1 / most_length && m.mass_unit <= most_mass &&
           m.mass_unit >= 1 / most_mass;
}

HOL_NOINLINE void load_masses(ScaledMolecule &m) {
    double largest = 0;
    for (int32_t i = 0; i < m.plan.n_atoms; ++i) largest = m.lane.w[i] > largest ? m.lane.w[i] : largest;
    m.mass_unit = largest > 0x1p-1000 ? power_below(largest) : 1;
    for (int32_t i = 0; i < m.plan.n_atoms; ++i) m.w[i] = m.lane.w[i] / m.mass_unit;
}

// Reads bond vectors from the caller's array. Returns false if one is zero or not finite.
HOL_NOINLINE bool load_vectors(const ScaledMolecule &m, const AtomArray &r, const Box &box, Wide3 *d) {
    bool good = true;
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        d[k] = difference(read(r, m.lane, m.plan.atom_i[k]), read(r, m.lane, m.plan.atom_j[k]));
        if (box.lattice != Box::none) wrap(box, d[k]);
        const double size = abs(d[k].x.hi) + abs(d[k].y.hi) + abs(d[k].z.hi);
        good = good && size > 0 && is_finite(size);
    }
    return good;
}

HOL_INLINE double largest_component(const Wide3 &a) {
    const double x = abs(a.x.hi), y = abs(a.y.hi), z = abs(a.z.hi), xy = x > y ? x : y;
    return xy > z ? xy : z;
}

// Loads the molecule. Returns false if a bond is zero or not finite.
HOL_NOINLINE bool load(ScaledMolecule &m, const AtomArray &r, const Box &box) {
    load_masses(m);
    if (!load_vectors(m, r, box, m.d)) return false;
    for (int32_t k = 0; k < m.plan.n_bonds; ++k) {
        const double size = largest_component(m.d[k]);
        if (!(size > 0x1p-960 && size < 0x1p960)) return false;
        m.unit[k] = power_below(size);
        m.d[k] = (1 / m.unit[k]) * m.d[k];
    }
    return true;
}

}  // namespace holonomic::HOL_ISA::extended
