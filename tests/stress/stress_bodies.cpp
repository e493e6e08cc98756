/**
 * Hostile molecules with rigid bodies against the reference solution for a given time, with every set of kernels that
 * runs here or with that which HOLONOMIC_ISA names:
 *     stress_bodies SECONDS [FIRST [PROCESSES [PERCENT]]]
 *         molecules from number FIRST on. PERCENT of each class may exceed a bound, by a factor of three at most.
 *     stress_bodies --group FIRST
 *         the group that begins with number FIRST
 *     stress_bodies --seed NUMBER...
 *         these molecules, each alone and to its group, among those of a run from number 1 on.
 * Exit status 0: everything within its bounds; 1: something is not; 2: wrong usage.
 */
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "body_checks.hpp"
#include "harness.hpp"
#include "random.h"

using namespace stress;

namespace
{

using tally = tally_of<molecule_quantity>;

unsigned long long number(std::uint64_t n)
{
    return n;
}

/** Molecules that are computed together, and each of them alone; in half of the groups all are of one kind, side by
 * side in the kernels if they are lone bodies. */
struct group_of_bodies {
    std::uint64_t first;
    std::vector<hostile_body> molecules;
    std::vector<reference::rigid_solution> exact;

    explicit group_of_bodies(std::uint64_t from) : first(from)
    {
        random_stream stream = random_seed(first);
        const std::uint64_t size = static_cast<std::uint64_t>(random_integer(&stream, 1, group_size));
        const bool twins = random_uniform(&stream) < 0.5;
        const hostile_body one =
            make_one(first + static_cast<std::uint64_t>(random_integer(&stream, 0, N_BODY_CLASSES - 1)));
        for (std::uint64_t k = 0; k < size; ++k)
            molecules.push_back(twins ? make_twin(one, first + k) : make_one(first + k));
    }
    /** A quarter of the groups are of relations, another one of lists that depend. */
    hostile_body make_one(std::uint64_t seed) const
    {
        const std::uint64_t kind = first / group_size % 4;
        return kind == 1 ? make_related(seed) : kind == 3 ? make_listed(seed) : make_hostile_body(seed);
    }
    static group_of_bodies solved(std::uint64_t from)
    {
        group_of_bodies g(from);
        for (const hostile_body &m : g.molecules)
            g.exact.push_back(m.shape == LISTED ? reference::rigid_solution() : solution_of(m));
        return g;
    }
    /** With the kernels that are in use: lists, whose positions are the library's. */
    group_of_bodies completed() const
    {
        group_of_bodies g = *this;
        for (std::size_t k = 0; k < g.molecules.size(); ++k) {
            if (g.molecules[k].shape != LISTED) continue;
            complete_listed(g.molecules[k]);
            g.exact[k] = solution_of(g.molecules[k]);
        }
        return g;
    }
    static reference::rigid_solution solution_of(const hostile_body &m)
    {
        if (m.refused) return {};
        reference::rigid_solution s = reference::solve_rigid(m.p, m.right_hand_side(), m.drifted(), m.dt);
        if (s.regular && !s.agrees) {
            std::printf("stress: the two reference solutions of molecule %llu differ\n", number(m.seed));
            std::exit(2);
        }
        return s;
    }
};

void check(const group_of_bodies &given, tally &sum)
{
    const group_of_bodies g = given.completed();
    std::vector<molecule_verdict> verdicts(g.molecules.size());
    check_invariances(g.molecules, g.first + 1, verdicts);
    for (std::size_t k = 0; k < g.molecules.size(); ++k) {
        const hostile_body &m = g.molecules[k];
        molecule_facts facts;
        verdicts[k].add(check_alone(m, g.exact[k], facts));
        sum.add(m.shape, {m.n_bonds(), m.seed, facts.regular, facts.promised, facts.condition}, verdicts[k]);
        if (!verdicts[k].exceeded()) continue;
        std::printf(
            "molecule %llu (%s), %zu atoms, %lld bonds, least pivot %.1Le:%s repeat with HOLONOMIC_ISA=%s "
            "tests/stress/stress_bodies --group %llu\n",
            number(m.seed), m.words().c_str(), m.p.n_atoms(), static_cast<long long>(m.n_bonds()), facts.least_pivot,
            verdicts[k].words().c_str(), hol_instruction_set(), number(g.first));
    }
}

int check_seed(std::uint64_t seed)
{
    const std::uint64_t first = seed - (seed - 1) % group_size;  // groups begin with 1, 9, ...
    group_of_bodies g(first);
    const bool in_group = seed - first < g.molecules.size();
    if (!in_group) {
        g.molecules.push_back(g.make_one(seed));
    } else {
        const auto its = g.molecules.begin() + static_cast<std::ptrdiff_t>(seed - first);
        std::rotate(its, its + 1, g.molecules.end());
    }
    g.exact.resize(g.molecules.size());
    g = g.completed();
    std::vector<molecule_verdict> verdicts(g.molecules.size());
    check_invariances(g.molecules, first + 1, verdicts);
    const hostile_body &m = g.molecules.back();
    molecule_facts facts;
    molecule_verdict v = check_alone(m, group_of_bodies::solution_of(m), facts);
    v.add(verdicts.back());
    std::printf("%llu: %s; %zu atoms, %lld bonds, least pivot %.2Le\n", number(seed), m.words().c_str(), m.p.n_atoms(),
                static_cast<long long>(m.n_bonds()), facts.least_pivot);
    v.print();
    return v.exceeded();
}

}  // namespace

int main(int argc, char **argv)
{
    const harness<group_of_bodies, tally> bodies{
        "stress_bodies", "--group", {body_class_name, LISTED + 1, "molecule"}, group_of_bodies::solved, check, nullptr};
    return harness_main({argc, argv}, 2, "SECONDS [FIRST [PROCESSES [PERCENT]]] | --group FIRST | --seed NUMBER...",
                        bodies, check_seed);
}
