// SPDX-License-Identifier: GPL-2.0-only
// Unit tests of the plan, without LAMMPS: to be run with any number of ranks.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <set>
#include <string>

#include "plan/packed.hpp"
#include "plan/route.hpp"
#include "scene_of_plan.hpp"

namespace {

void test_registry() {
    const World world(60);
    for (bool both : {false, true}) {
        const Registry registry = registry_of(world, both);
        CHECK(registry.n_molecules() == 60);
        CHECK(registry.n_bonds() == static_cast<std::int64_t>(world.bonds.size()));
        CHECK(registry.n_atoms() == world.n_atoms);
        const std::vector<Tag> tags = world.mine();
        const std::vector<Membership> members = registry.memberships(tags);
        for (std::size_t k = 0; k < tags.size(); ++k) {
            const int molecule = world.molecule_of[tags[k]];
            CHECK((molecule >= 0) == (members[k].molecule != 0));
            if (molecule < 0) continue;
            const auto first = std::find(world.molecule_of.begin(), world.molecule_of.end(), molecule);
            CHECK(members[k].molecule == first - world.molecule_of.begin());
            const auto has = [&](const RigidBond &b) { return b.from == tags[k] || b.to == tags[k]; };
            CHECK(2 * members[k].taken == std::count_if(world.bonds.begin(), world.bonds.end(), has));
        }
    }
}

/** A chain through all tags takes few rounds, and its places follow it. */
void test_long_chain() {
    constexpr int n = 5000;
    std::vector<RigidBond> bonds;
    for (Tag k = 0; k + 1 < n; ++k)
        if (k % n_ranks == me) bonds.push_back({1 + k * 1999 % n, 1 + (k + 1) * 1999 % n, 1.0});
    const Registry registry(MPI_COMM_WORLD, bonds);
    CHECK(registry.n_molecules() == 1);
    const Shape shape = registry.shapes({1})[0];
    CHECK(shape.linear && shape.n_atoms == n);
    const std::vector<Membership> members = registry.memberships({1, 1 + 1999 % n});
    CHECK(members[0].place == 0 && members[1].place == 1);
}

/** The plan's slots are each an atom of one rank, whose numbers come and go. */
void test_plan() {
    World world(80);
    const Registry registry = registry_of(world, false);
    Plan plan(MPI_COMM_WORLD);
    for (int round = 0; round < 6; ++round) {
        if (round != 3) world.deal();
        const std::vector<Tag> tags = world.mine();
        const std::vector<Membership> members = registry.memberships(tags);
        const bool changed = plan.renew(registry, members.data(), tags.data(), static_cast<int>(tags.size()));
        if (round == 3 || (round > 0 && n_ranks == 1)) CHECK(!changed);
        std::vector<double> at_home(plan.n_slots(), 0), back(tags.size(), 0);
        for (int slot = 0; slot < plan.n_slots(); ++slot)
            if (plan.atoms()[slot] >= 0) at_home[slot] = static_cast<double>(tags[plan.atoms()[slot]]);
        plan.exchange.to_homes<1>(
            MPI_COMM_WORLD, [&](int i, double *x) { *x = static_cast<double>(tags[i]); },
            [&](int slot, const double *x) { at_home[slot] = *x; });
        for (int slot = 0; slot < plan.n_slots(); ++slot)
            CHECK(at_home[slot] == static_cast<double>(plan.tags()[slot]));
        for (int slot = 0; slot < plan.n_slots(); ++slot)
            if (plan.atoms()[slot] >= 0) back[plan.atoms()[slot]] = at_home[slot];
        plan.exchange.to_owners<1>(
            MPI_COMM_WORLD, [&](int slot, double *x) { *x = at_home[slot]; },
            [&](int i, const double *x) { back[i] = *x; });
        for (std::size_t k = 0; k < tags.size(); ++k)
            if (members[k].molecule) CHECK(back[k] == static_cast<double>(tags[k]));
        check_bonds(world, plan);
    }
}

/** Molecules whose atoms are dealt evenly live on all ranks: none has more than twice its share. */
void test_balance() {
    std::vector<RigidBond> bonds;
    constexpr int n_chains = 400, n = 12;
    for (Tag c = 0; c < n_chains && me == 0; ++c)
        for (Tag k = 1; k < n; ++k) bonds.push_back({c * n + k, c * n + k + 1, 1.0});
    const Registry registry(MPI_COMM_WORLD, bonds);
    // Atom k of each chain is on rank k mod n_ranks: all ranks have equally many of each.
    std::vector<Tag> tags;
    for (Tag tag = 1; tag <= n_chains * n; ++tag)
        if ((tag - 1) % n % n_ranks == me) tags.push_back(tag);
    const std::vector<Membership> members = registry.memberships(tags);
    Plan plan(MPI_COMM_WORLD);
    plan.renew(registry, members.data(), tags.data(), static_cast<int>(tags.size()));
    CHECK(plan.n_slots() <= 2 * n_chains * n / n_ranks);
    CHECK(plan.n_slots() >= n_chains * n / n_ranks / 2);
    CHECK(!plan.renew(registry, members.data(), tags.data(), static_cast<int>(tags.size())));
}

/** Four atoms on a line by their distances, tied to a planar body that is given: one molecule, and no distance within.
 */
void test_bodies() {
    std::vector<RigidBond> bonds;
    std::vector<BodyAtom> bodies;
    if (me == 0) bonds = {{1, 2, 1.0}, {2, 3, 1.25}, {3, 4, 1.5}, {1, 3, 2.25}, {2, 4, 2.75}};
    if (me == n_ranks - 1) {
        bonds.push_back({12, 4, 1.0});
        bonds.push_back({10, 11, 7.0});
        bodies = {{10, 10, 10, {0, 0, 0}}, {10, 10, 12, {0, 2, 0}}, {10, 10, 11, {1, 0, 0}}};
    }
    const Registry registry(MPI_COMM_WORLD, bonds, bodies);
    CHECK(registry.n_molecules() == 1 && registry.n_atoms() == 7);
    CHECK(registry.n_bonds() == 1 && registry.n_bodies() == 2);
    const Shape shape = registry.shapes({1})[0];
    CHECK(shape.rigid && !shape.linear && shape.taken == 21 - (6 + 5 - 1));
    CHECK(shape.pairs.size() == 1 && shape.pairs[0][0] == 3 && shape.pairs[0][1] == 6);
    for (const Body &body : shape.bodies) {
        const bool line = body.places.size() == 4;
        CHECK(line ? body.places == std::vector<int>({0, 1, 2, 3}) : body.places.size() == 3);
        const double expected[4] = {0, 1, 2.25, 3.75};
        for (int k = 0; line && k < 4; ++k) CHECK(std::fabs(body.at[k][0] - body.at[0][0] - expected[k]) < 1e-15);
        for (std::size_t k = 0; !line && k < 3; ++k) CHECK(body.at[k][1] == (body.places[k] == 6 ? 2 : 0));
    }
    double taken = 0;
    for (const Membership &member : registry.memberships({1, 2, 3, 4, 10, 11, 12})) taken += member.taken;
    CHECK(std::fabs(taken - 11) < 1e-13);
    CHECK(walk(shape).size() == 6);
}

/** Two bodies that share an atom are one molecule, which has twelve freedoms less three; a bond within one of them is
 * dropped, one between them is not. */
void test_shared_atom() {
    std::vector<BodyAtom> bodies;
    std::vector<RigidBond> bonds;
    const double at[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    if (me == 0)
        for (int k = 0; k < 3; ++k) bodies.push_back({100, 1, k + 1, {at[k][0], at[k][1], at[k][2]}});
    if (me == n_ranks - 1) {
        for (int k = 0; k < 3; ++k) bodies.push_back({101, 1, k == 0 ? 1 : k + 3, {at[k][0], at[k][1], at[k][2]}});
        bonds = {{1, 4, 1.0}, {2, 4, 1.25}};
    }
    const Registry registry(MPI_COMM_WORLD, bonds, bodies);
    CHECK(registry.n_molecules() == 1 && registry.n_atoms() == 5);
    CHECK(registry.n_bonds() == 1 && registry.n_bodies() == 2);
    const Shape shape = registry.shapes({1})[0];
    CHECK(shape.rigid && shape.taken == 15 - (12 - 3 - 1));
    for (const Body &body : shape.bodies)
        CHECK(body.places == std::vector<int>({0, 1, 2}) || body.places == std::vector<int>({0, 3, 4}));
    CHECK(walk(shape).size() == 4);
}

/** Ethane by all bonds and angles, whose lengths do not quite fit: seven freedoms; what has been adjusted is told, and
 * the molecule is not divided. */
void test_dependent() {
    std::vector<RigidBond> bonds;
    const double third = std::acos(-1.0) * 2 / 3, h = 1.09;
    double r[8][3] = {{0, 0, 0}, {1.54, 0, 0}};
    for (int k = 0; k < 6; ++k) {
        double *x = r[2 + k];
        const double turn = third * k + (k < 3 ? 0 : 1);
        x[0] = k < 3 ? -h / 3 : 1.54 + h / 3, x[1] = h * std::sqrt(8.0) / 3 * std::cos(turn),
        x[2] = h * std::sqrt(8.0) / 3 * std::sin(turn);
    }
    const auto hold = [&](int i, int j, double factor) {
        double square = 0;
        for (int c = 0; c < 3; ++c) square += std::pow(r[i][c] - r[j][c], 2);
        bonds.push_back({i + 1, j + 1, factor * std::sqrt(square)});
    };
    for (int end = 0; end < 2 && me == 0; ++end)
        for (int k = 2 + 3 * end; k < 5 + 3 * end; ++k) {
            hold(end, k, 1), hold(1 - end, k, k == 2 ? 1.0003 : 1);
            for (int j = 2 + 3 * end; j < k; ++j) hold(j, k, 1);
        }
    if (me == 0) hold(0, 1, 1);
    const Registry registry(MPI_COMM_WORLD, bonds, {}, 3, 4);
    CHECK(registry.n_molecules() == 1 && registry.n_bonds() == 19 && registry.n_divided() == 0);
    const Registry::Adjusted &most = registry.most_adjusted();
    CHECK(most.part > 1e-5 && most.part < 3e-4 && most.from > 0 && most.to > most.from);
    const Shape shape = registry.shapes({1})[0];
    CHECK(shape.dependent() && shape.taken == 24 - 7);
    double taken = 0;
    for (const Membership &member : registry.memberships({1, 2, 3, 4, 5, 6, 7, 8})) taken += member.taken;
    CHECK(std::fabs(taken - 17) < 1e-13);
    // Nor is anything adjusted beyond the tolerance that is asked for.
    const Registry strict(MPI_COMM_WORLD, bonds, {}, 3, 0, 1e-6);
    CHECK(strict.most_adjusted().part == 0);
}

template <class Function>
void refuses(const char *words, Function function) {
    std::string said;
    try {
        function();
    } catch (const ErrorEverywhere &e) {
        said = e.what();
    }
    CHECK(said.find(words) != std::string::npos);
}

void test_errors() {
    std::vector<RigidBond> bonds;
    if (me == n_ranks - 1) bonds = {{7, 8, 1.0}, {8, 7, 1.25}};
    refuses("are to be at two distances", [&] { Registry(MPI_COMM_WORLD, bonds); });
    if (me == 0) bonds = {{5, 5, 1.0}};
    if (me != 0) bonds.clear();
    std::vector<BodyAtom> twice;
    if (me == 0) twice = {{1, 1, 1, {0, 0, 0}}, {1, 1, 2, {1, 0, 0}}, {1, 1, 2, {1, 0, 0}}};
    refuses("atom 2 is twice in a rigid body", [&] { Registry(MPI_COMM_WORLD, {}, twice); });
    refuses("atom 5 with itself", [&] { Registry(MPI_COMM_WORLD, bonds); });
    if (me == 0) bonds = {{3, 4, 1.0}, {4, 5, 1.0}};
    const Registry registry(MPI_COMM_WORLD, bonds);
    // Atom 4 is nowhere.
    std::vector<Tag> tags;
    if (me == 0) tags = {3};
    if (me == n_ranks - 1) tags.push_back(5);
    const std::vector<Membership> members = registry.memberships(tags);
    refuses("molecule of atom 3 has 3 atoms, of which 2 are there",
            [&] { Plan(MPI_COMM_WORLD).renew(registry, members.data(), tags.data(), static_cast<int>(tags.size())); });
}

/** Errors of the library name tags. */
void test_messages() {
    std::vector<RigidBond> bonds;
    if (me == 0) bonds = {{40, 30, 1.0}, {30, 20, 1.0}};
    const Registry registry(MPI_COMM_WORLD, bonds);
    std::vector<Tag> tags;
    if (me == 0) tags = {20, 30, 40};
    const std::vector<Membership> members = registry.memberships(tags);
    Plan plan(MPI_COMM_WORLD);
    plan.renew(registry, members.data(), tags.data(), static_cast<int>(tags.size()));
    if (me != 0) return;
    const std::vector<double> masses(3, 1.0);
    Packed packed(plan, masses.data(), 0, 1, 0);
    std::vector<double> before{0, 0, 0, 1, 0, 0, 2, 0, 0}, now{0, 0, 0, 1, 0, 0, 1, 20, 0};
    std::string said;
    try {
        packed.positions(before.data(), now.data(), 0.01);
    } catch (const std::runtime_error &e) {
        said = e.what();
    }
    CHECK(said.find("the molecule of atom 20") != std::string::npos);
    CHECK(now[7] == 20);
    // And it does what it should: the lengths are right, and the centre of mass rests.
    now = {0, 0.1, 0, 1.05, 0, 0, 2, 0, 0.1};
    packed.positions(before.data(), now.data(), 0.01);
    for (int k = 0; k < 2; ++k) {
        double square = 0;
        for (int c = 0; c < 3; ++c) square += std::pow(now[3 * k + 3 + c] - now[3 * k + c], 2);
        CHECK(std::fabs(square - 1) < 1e-15);
    }
    CHECK(std::fabs(now[0] + now[3] + now[6] - 3.05) < 1e-14);
}

}  // namespace

int main(int argc, char **argv) {
    MPI_Init(&argc, &argv);
    me = rank_of(MPI_COMM_WORLD);
    n_ranks = size_of(MPI_COMM_WORLD);
    test_registry();
    test_long_chain();
    test_plan();
    test_changes();
    test_balance();
    test_bodies();
    test_shared_atom();
    test_dependent();
    test_errors();
    test_messages();
    if (me == 0) std::printf("%d checks on rank 0 of %d\n", n_checks, n_ranks);
    MPI_Finalize();
    return 0;
}
