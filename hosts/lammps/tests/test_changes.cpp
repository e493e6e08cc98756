// SPDX-License-Identifier: GPL-2.0-only
// Unit tests of what is found and planned anew where bonds change, without LAMMPS.
#include <cstdint>
#include <set>

#include "plan/blocks.hpp"
#include "scene_of_plan.hpp"

namespace {

/** Cuts some bonds, makes others between molecules, and takes all bonds of one; gives the atoms concerned. */
std::set<Tag> change(World &world, int n_changes) {
    std::set<Tag> touched;
    for (int k = 0; k < n_changes; ++k) {
        RigidBond &bond = world.bonds[random_below(static_cast<int>(world.bonds.size()))];
        touched.insert({bond.from, bond.to});
        if (k % 3 == 0) {
            bond = world.bonds.back();
            world.bonds.pop_back();
        } else {
            const Tag other = 1 + random_below(static_cast<int>(world.owner.size()) - 1);
            const Tag from = bond.from;
            if (other == from) continue;
            const bool there = std::any_of(world.bonds.begin(), world.bonds.end(), [&](const RigidBond &b) {
                return std::minmax(b.from, b.to) == std::minmax(from, other);
            });
            if (there) continue;
            world.bonds.push_back({from, other, 1.25});
            touched.insert(other);
        }
    }
    return touched;
}

}  // namespace

/** What is renewed is what is found anew, and blocks far from what has changed keep their handles. */
void test_changes() {
    World world(4000);
    Registry registry = registry_of(world, false);
    Plan plan(MPI_COMM_WORLD);
    std::vector<Packed> blocks;
    for (int round = 0; round < 8; ++round) {
        const std::set<Tag> touched = round > 0 ? change(world, 12) : std::set<Tag>();
        const std::vector<Tag> tags = world.mine();
        std::vector<Membership> members = registry.memberships(tags);
        std::vector<Tag> names;
        for (std::size_t k = 0; k < tags.size(); ++k)
            if (members[k].molecule && touched.count(tags[k])) names.push_back(members[k].molecule);
        const std::unordered_set<Tag> gone = everywhere(MPI_COMM_WORLD, names);
        std::set<Tag> which;
        for (std::size_t k = 0; k < tags.size(); ++k)
            if (gone.count(members[k].molecule) || touched.count(tags[k])) which.insert(tags[k]);
        std::vector<RigidBond> bonds;
        for (const RigidBond &bond : told(world, false))
            if (which.count(bond.from)) bonds.push_back(bond);
        CHECK(!registry.replace(gone, Registry(MPI_COMM_WORLD, bonds)));
        const Registry anew = registry_of(world, true);
        CHECK(registry.n_molecules() == anew.n_molecules() && registry.n_atoms() == anew.n_atoms());
        CHECK(registry.n_bonds() == anew.n_bonds() && registry.n_bonds() == std::int64_t(world.bonds.size()));
        members = registry.memberships(tags);
        const std::vector<Membership> expected = anew.memberships(tags);
        for (std::size_t k = 0; k < tags.size(); ++k) {
            CHECK(members[k].molecule == expected[k].molecule && members[k].place == expected[k].place);
            CHECK(members[k].n_atoms == expected[k].n_atoms && members[k].taken == expected[k].taken);
        }
        plan.forget(gone);
        plan.renew(registry, members.data(), tags.data(), static_cast<int>(tags.size()));
        check_bonds(world, plan);
        std::set<const hol_chains *> before;
        for (const Packed &block : blocks) before.insert(block.handle());
        const std::vector<double> masses(plan.n_slots(), 1.0);
        blocks = cut_into_blocks(plan, masses.data(), std::move(blocks));
        int next = 0, next_slot = 0, n_kept = 0;
        for (const Packed &block : blocks) {
            CHECK(block.first_resident() == next && block.first_slot() == next_slot);
            CHECK(block.end_slot() - block.first_slot() < 4096);
            CHECK(block.holds(next, masses.data()));
            std::int64_t n_bonds = 0;
            for (; next < block.end_resident(); ++next)
                n_bonds += static_cast<std::int64_t>(plan.shapes()[plan.residents()[next].shape].pairs.size());
            CHECK(block.n_bonds() == n_bonds);
            next_slot = block.end_slot();
            n_kept += before.count(block.handle()) != 0;
        }
        CHECK(next == static_cast<int>(plan.residents().size()) && next_slot == plan.n_slots());
        if (round > 0 && n_ranks == 1) CHECK(n_kept >= 3);
    }
    // An atom that is no more takes its molecule along.
    Tag name = 0;
    std::vector<Tag> tags = world.mine();
    std::vector<Membership> members = registry.memberships(tags);
    CHECK(registry.incomplete(members).empty());
    if (me == 0) {
        std::size_t k = 0;
        while (members[k].molecule == 0) ++k;
        name = members[k].molecule;
        members.erase(members.begin() + static_cast<std::ptrdiff_t>(k));
    }
    const std::unordered_set<Tag> lost = everywhere(MPI_COMM_WORLD, registry.incomplete(members));
    CHECK(lost.size() == 1 && (me != 0 || lost.count(name) == 1));
}
