// SPDX-License-Identifier: GPL-2.0-only
// What the tests of the plan share. Every rank knows the whole scene and looks at what the plan says of its part.
#ifndef HOLONOMIC_LAMMPS_TESTS_SCENE_OF_PLAN_HPP
#define HOLONOMIC_LAMMPS_TESTS_SCENE_OF_PLAN_HPP

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <numeric>
#include <vector>

#include "plan/plan.hpp"

using namespace holonomic_lammps;

inline int me, n_ranks, n_checks;

inline void check(bool right, const char *what, int line) {
    ++n_checks;
    if (right) return;
    std::fprintf(stderr, "rank %d, line %d: %s\n", me, line, what);
    MPI_Abort(MPI_COMM_WORLD, 1);
}
#define CHECK(x) check((x), #x, __LINE__)

inline std::uint64_t state = 88172645463325252u;
inline int random_below(int n) {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return static_cast<int>(state % static_cast<std::uint64_t>(n));
}

/** Chains, trees and rings, with tags in no order. */
struct World {
    int n_atoms = 0;
    std::vector<RigidBond> bonds;
    std::vector<int> molecule_of;  // by tag
    std::vector<int> owner;        // by tag

    explicit World(int n_molecules) : molecule_of(1), owner(1) {
        std::vector<Tag> tags(n_molecules * 20);
        std::iota(tags.begin(), tags.end(), 1);
        for (std::size_t k = tags.size(); k > 1; --k) std::swap(tags[k - 1], tags[random_below(static_cast<int>(k))]);
        molecule_of.assign(tags.size() + 1, -1);
        owner.assign(tags.size() + 1, 0);
        for (int m = 0; m < n_molecules; ++m) {
            const int n = 2 + random_below(18), form = m % 3;
            const Tag *t = &tags[20 * m];
            for (int k = 1; k < n; ++k) {
                const int to = form == 1 ? random_below(k) : k - 1;
                bonds.push_back({t[k], t[to], 1.0 + 0.125 * (k % 3)});
            }
            if (form == 2 && n > 3) bonds.push_back({t[0], t[n - 1], 1.5});
            for (int k = 0; k < n; ++k) molecule_of[t[k]] = m;
            n_atoms += n;
        }
        deal();
    }

    void deal() {
        for (int &rank : owner) rank = random_below(n_ranks);
    }

    std::vector<Tag> mine() const {
        std::vector<Tag> tags;
        for (std::size_t tag = 1; tag < owner.size(); ++tag)
            if (owner[tag] == me) tags.push_back(static_cast<Tag>(tag));
        return tags;
    }
};

/** Bonds as the owners of their atoms tell them: both, or that of the first. */
inline std::vector<RigidBond> told(const World &world, bool both) {
    std::vector<RigidBond> bonds;
    for (const RigidBond &bond : world.bonds) {
        if (world.owner[bond.from] == me) bonds.push_back(bond);
        if (both && world.owner[bond.to] == me) bonds.push_back({bond.to, bond.from, bond.length});
    }
    return bonds;
}

inline Registry registry_of(const World &world, bool both) { return Registry(MPI_COMM_WORLD, told(world, both)); }

/** Bonds of the residents' shapes, with their lengths, are the world's. */
inline void check_bonds(const World &world, const Plan &plan) {
    std::map<std::pair<Tag, Tag>, double> known;
    for (const RigidBond &bond : world.bonds) known[std::minmax(bond.from, bond.to)] = bond.length;
    int n_bonds = 0;
    for (const Resident &resident : plan.residents()) {
        const Shape &shape = plan.shapes()[resident.shape];
        for (std::size_t k = 0; k < shape.pairs.size(); ++k) {
            const Tag a = plan.tags()[resident.first + shape.pairs[k][0]],
                      b = plan.tags()[resident.first + shape.pairs[k][1]];
            const auto bond = known.find(std::minmax(a, b));
            CHECK(bond != known.end() && bond->second == shape.lengths[k]);
            ++n_bonds;
        }
    }
    MPI_Allreduce(MPI_IN_PLACE, &n_bonds, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    CHECK(n_bonds == static_cast<int>(world.bonds.size()));
}

void test_changes();

#endif
