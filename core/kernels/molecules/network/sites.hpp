// The caller's arrays per atom, read and written by the sites of a network.
#pragma once

#include "core/kernels/molecules/atoms/layout.hpp"
#include "core/kernels/molecules/network/parts.hpp"
#include "core/plan/network.hpp"

namespace holonomic::HOL_ISA::graph {

struct NetSites {
    const NetworkPlan &s;
    const MoleculeLane &lane;
    const Atoms<double> at;
    double *w;       // by site
    const bool far;  // it does not stay in the nearer caches, and is fetched ahead

    NetSites(const NetworkPlan &plan, const MoleculeLane &l, bool packed)
        : s(plan), lane(l), at(&l, 1, packed), far(plan.n_bonds > 16384) {}

    // Of arrays that are gone through together there are more than a processor follows by itself: what stands so far
    // ahead in each is that of a bond, or an atom, after some 10 others in lanes, where a loop goes upwards.
    template <class... Arrays>
    HOL_FORCED void fetch_ahead(int32_t bond_index, const Arrays *...array) const {
        constexpr int32_t ahead = 80;
        if (far) (__builtin_prefetch(array + bond_index + ahead), ...);
    }
    // Where the bond of an index stands in arrays per bond, and values from there.
    HOL_FORCED int64_t number_of_bond(int32_t bond_index) const {
        const int32_t k = s.bond_of[bond_index];
        return lane.bonds ? lane.bonds[k] : lane.first_bond + k;
    }
    template <class V>
    HOL_FORCED V of_bonds(const double *values, int32_t bond_index) const {
        V all = {};
        for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(all, i, values[number_of_bond(bond_index + i)]);
        return all;
    }
    // Where atoms of lanes from this site on stand in packed arrays.
    template <class V>
    struct SiteRows {
        int64_t element[Width<V>::lanes];
    };
    template <class V>
    HOL_FORCED SiteRows<V> rows_of(int32_t site) const {
        const int32_t *const atom = s.atom_of + site;
        const int64_t *const list = at.list[0], first = at.first[0];
        SiteRows<V> rows;
        HOL_UNROLL
        for (int i = 0; i < Width<V>::lanes; ++i) rows.element[i] = 3 * (list ? list[atom[i]] : first + atom[i]);
        return rows;
    }
    // What reads a site's atoms: from several arrays, with what is fetched ahead for those of later sites.
    template <class V>
    struct SiteReader {
        const NetSites &of;
        const int32_t site;
        const SiteRows<V> here, ahead;
        HOL_FORCED Vector3<V> operator()(const AtomArray &from) const {
            if (__builtin_expect(of.at.layout == elements, 0)) return of.read_elements<V>(from, site);
            const double *const x = reinterpret_cast<const double *>(from.x), *p[Width<V>::lanes];
            HOL_UNROLL
            for (int i = 0; i < Width<V>::lanes; ++i) {
                p[i] = x + here.element[i];
                if (of.far) __builtin_prefetch(x + ahead.element[i]);
            }
            Vector3<V> a;
            read_rows(p, a);
            return a;
        }
    };
    template <class V>
    HOL_FORCED SiteReader<V> reader(int32_t site) const {
        return {*this, site, rows_of<V>(site), far ? rows_of<V>(site + s.fetched_ahead) : SiteRows<V>{}};
    }
    HOL_FORCED void fetch(const AtomArray &array, int32_t site) const {
        if (at.layout != elements)
            __builtin_prefetch(reinterpret_cast<const double *>(array.x) + rows_of<double>(site).element[0]);
    }
    // Where speed is no matter.
    template <class V>
    __attribute__((noinline)) Vector3<V> read_at(const AtomArray &from, int32_t site) const {
        return reader<V>(site)(from);
    }
    template <class V>
    __attribute__((noinline)) Vector3<V> read_elements(const AtomArray &from, int32_t site) const {
        Vector3<V> all = {};
        for (int i = 0; i < Width<V>::lanes; ++i) {
            const Vector3<double> one = read(from, at, s.atom_of[site + i]);
            Width<V>::set(all.x, i, one.x);
            Width<V>::set(all.y, i, one.y);
            Width<V>::set(all.z, i, one.z);
        }
        return all;
    }
    // Inverse masses, which are kept.
    template <class V>
    HOL_FORCED V read_masses(int32_t site) const {
        const V masses = gather<V>(lane.w, s.atom_of + site);
        store_any(w + site, masses);
        return masses;
    }
    // Writes a vector for each lane to an array per atom, or adds it, but for atoms that are `left` as they are.
    template <class V>
    HOL_FORCED void write_at(const AtomArray &to, int32_t site, const unsigned char *left, bool add,
                             const Vector3<V> &a) const {
        bool some_left = at.layout == elements;
        for (int i = 0; i < Width<V>::lanes && left; ++i) some_left |= left[s.atom_of[site + i]] != 0;
        if (__builtin_expect(some_left, 0)) {
            const Vector3<V> copy = a;
            return write_elements(to, site, left, add, copy);
        }
        const SiteRows<V> here = rows_of<V>(site), ahead = far ? rows_of<V>(site + s.fetched_ahead) : SiteRows<V>{};
        double *const x = reinterpret_cast<double *>(to.x), *p[Width<V>::lanes];
        HOL_UNROLL
        for (int i = 0; i < Width<V>::lanes; ++i) {
            p[i] = x + here.element[i];
            if (far) __builtin_prefetch(x + ahead.element[i], 1);
        }
        if (!add) return write_rows(p, a);
        Vector3<V> before;
        read_rows(p, before);
        write_rows(p, before + a);
    }
    template <class V>
    __attribute__((noinline)) void write_elements(const AtomArray &to, int32_t site, const unsigned char *left,
                                                  bool add, const Vector3<V> &a) const {
        for (int i = 0; i < Width<V>::lanes; ++i) {
            const int32_t atom = s.atom_of[site + i];
            if (left && left[atom]) continue;
            const Vector3<double> one = {Width<V>::get(a.x, i), Width<V>::get(a.y, i), Width<V>::get(a.z, i)};
            write(to, at, atom, add ? read(to, at, atom) + one : one, 1);
        }
    }
};

}  // namespace holonomic::HOL_ISA::graph
