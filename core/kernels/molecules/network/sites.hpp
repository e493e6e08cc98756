// The caller's arrays per atom, read and written by the sites of a network.
#pragma once

#include "core/kernels/molecules/atoms/atoms.hpp"
#include "core/kernels/molecules/network/network_plan.hpp"
#include "core/kernels/molecules/network/parts.hpp"

namespace holonomic::HOL_ISA::graph {

// An array per atom that is read by sites; times inverse masses if `weighed`.
struct NetReading {
    const AtomArray *from;
    Net3 to;
    bool weighed;
};

struct NetSites {
    const NetworkPlan &s;
    const MoleculeLane &lane;
    const Atoms<double> at;
    double *w;  // by site

    NetSites(const NetworkPlan &plan, const MoleculeLane &l, bool packed) : s(plan), lane(l), at(&l, 1, packed) {}

    // Reads masses, and n arrays per atom, one after the other of so many atoms that what is fetched ahead follows few
    // strands.
    __attribute__((noinline)) void read_sites(int32_t first, int32_t end, const NetReading *all, int n) const {
        constexpr int32_t step = 2048;
        int64_t row[step + rows_ahead];
        for (int32_t i = first; i < end; i += step) {
            const int32_t behind = end - i < step ? end : i + step;
            find_rows(i, behind, row);
            for (int a = 0; a < n; ++a) read_some(i, behind, all[a], row);
        }
    }
    // Where atoms stand in packed arrays.
    HOL_FORCED void find_rows(int32_t first, int32_t end, int64_t *row) const {
        const int32_t *const atom = s.atom_of + first, m = end - first;
        const int64_t *const list = at.list[0], first_atom = at.first[0];
        const double *const masses = lane.w;
        double *const of_sites = w + first;
        for (int32_t i = 0; i < m; ++i) of_sites[i] = masses[atom[i]];
        if (list)
            for (int32_t i = 0; i < m; ++i) row[i] = 3 * list[atom[i]];
        else
            for (int32_t i = 0; i < m; ++i) row[i] = 3 * (first_atom + atom[i]);
        for (int32_t i = 0; i < rows_ahead; ++i) row[m + i] = row[0];
    }
    HOL_FORCED void read_some(int32_t first, int32_t end, const NetReading &all,
                              [[maybe_unused]] const int64_t *row) const {
        int32_t i = first;
#if HOL_LANES > 1
        const double *const x = reinterpret_cast<const double *>(all.from->x);
        for (; i + W <= end && at.layout != elements; i += W) {
            const double *p[W];
            for (int j = 0; j < W; ++j) {
                p[j] = x + row[i - first + j];
                __builtin_prefetch(x + row[i - first + j + rows_ahead]);
            }
            vec3 a;
            read_rows(p, a);
            all.to.set(i, all.weighed ? holonomic::HOL_ISA::load(w + i) * a : a);
        }
#endif
        for (; i < end; ++i) {
            const Vector3<double> a = read(*all.from, at, s.atom_of[i]);
            all.to.set(i, all.weighed ? w[i] * a : a);
        }
    }
    // Writes value(width, site) of a part to an array per atom, or adds it, but for atoms that are `left` as they are.
    template <class Value>
    HOL_FORCED void write_sites(const NetPart &part, const AtomArray &to, const unsigned char *left, bool add,
                                const Value &value) const {
        int32_t i = part.first_site;
#if HOL_LANES > 1
        for (; i + W <= part.end_site && at.layout != elements; i += W) {
            double *p[W];
            bool some_left = false;
            for (int j = 0; j < W; ++j) {
                const int32_t atom = s.atom_of[i + j];
                some_left |= left && left[atom];
                p[j] = reinterpret_cast<double *>(to.x) + 3 * at.number(0, atom);
            }
            if (some_left) {
                for (int j = 0; j < W; ++j) write_site(i + j, to, left, add, value);
                continue;
            }
            vec3 a = value(vec{}, i);
            if (add) {
                vec3 before;
                read_rows(p, before);
                a = before + a;
            }
            write_rows(p, a);
        }
#endif
        for (; i < part.end_site; ++i) write_site(i, to, left, add, value);
    }
    template <class Value>
    HOL_FORCED void write_site(int32_t i, const AtomArray &to, const unsigned char *left, bool add,
                               const Value &value) const {
        const int32_t atom = s.atom_of[i];
        if (left && left[atom]) return;
        const Vector3<double> a = value(double{}, i);
        write(to, at, atom, add ? read(to, at, atom) + a : a, 1);
    }
};

}  // namespace holonomic::HOL_ISA::graph
