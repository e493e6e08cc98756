/**
 * Hostile molecules of any shape against the reference solution for a given time, with every set of kernels that runs
 * here or with that which HOLONOMIC_ISA names:
 *     stress_molecules SECONDS [DIRECTORY [FIRST [PROCESSES [PERCENT]]]]
 *         molecules from number FIRST on; those that exceed a bound go to DIRECTORY, as files for scripts/oracle.
 * PERCENT of each class may exceed one, by a factor of three at most: for a test that guards what docs/stability.md
 * says.
 *     stress_molecules --group FIRST
 *         the group that begins with number FIRST
 *     stress_molecules --seed NUMBER...
 *         these molecules, among those of a run from number 1 on.
 * Exit status 0: everything within its bounds; 1: something is not; 2: wrong usage.
 */
#include <cstdio>
#include <string>
#include <vector>

#include "harness.hpp"
#include "molecule_checks.hpp"
#include "molecule_text.hpp"
#include "random.h"

using namespace stress;

namespace
{

using tally = tally_of<molecule_quantity>;

unsigned long long number(std::uint64_t n)
{
    return n;
}

/** A file for scripts/oracle, unless there is one. */
void keep(const std::string &directory, const hostile_molecule &m, const std::string &words, bool regular)
{
    const std::string name = "molecule_" + std::to_string(m.seed);
    const std::vector<double> drifted = m.drifted();
    const std::string text = reference::molecule_text(
        m.problem(), {name, !regular, {drifted.data(), m.length.data(), m.dt > 0 ? m.dt : 1, nullptr}});
    if (text.empty()) {  // a number that is zero but for the rounding of any arithmetic
        std::printf("no file for number %llu, which --group repeats\n", number(m.seed));
        return;
    }
    std::FILE *const out = std::fopen((directory + "/" + name + ".txt").c_str(), "wx");
    if (!out) return;
    std::fprintf(out, "# exceeds:%s\n# seed %llu: %s\n%s", words.c_str(), number(m.seed), m.words().c_str(),
                 text.c_str());
    std::fclose(out);
    std::FILE *const index = std::fopen((directory + "/INDEX").c_str(), "a");
    if (!index) return;
    std::fprintf(index, "%s.txt\n", name.c_str());
    std::fclose(index);
}

/** Molecules that are computed together, and each of them alone; in half of the groups all are of one shape, to share a
 * block. */
struct group_of_molecules {
    std::uint64_t first;
    std::vector<hostile_molecule> molecules;
    std::vector<molecule_reference> exact;

    explicit group_of_molecules(std::uint64_t from) : first(from)
    {
        random_stream stream = random_seed(first);
        const std::uint64_t size = static_cast<std::uint64_t>(random_integer(&stream, 1, group_size));
        const bool siblings = random_uniform(&stream) < 0.5;
        const hostile_molecule one =
            make_hostile_molecule(first + static_cast<std::uint64_t>(random_integer(&stream, 0, N_CLASSES - 1)));
        for (std::uint64_t k = 0; k < size; ++k)
            molecules.push_back(siblings ? make_sibling(one, first + k) : make_hostile_molecule(first + k));
    }
    static group_of_molecules solved(std::uint64_t from)
    {
        group_of_molecules g(from);
        for (const hostile_molecule &m : g.molecules) g.exact.emplace_back(m);
        return g;
    }
};

void check(const group_of_molecules &g, const std::string &directory, tally &sum)
{
    std::vector<molecule_verdict> verdicts(g.molecules.size());
    check_invariances(g.molecules, g.first + 1, verdicts);
    for (std::size_t k = 0; k < g.molecules.size(); ++k) {
        const hostile_molecule &m = g.molecules[k];
        molecule_facts facts;
        verdicts[k].add(check_alone(m, g.exact[k], facts));
        sum.add(m.shape, {m.n_bonds(), m.seed, facts.regular, facts.promised, facts.condition}, verdicts[k]);
        if (!verdicts[k].exceeded()) continue;
        const std::string words = verdicts[k].words();
        std::printf(
            "molecule %llu, %lld bonds, condition number %.1Le, least pivot %.1Le:%s repeat with "
            "HOLONOMIC_ISA=%s tests/stress/stress_molecules --group %llu\n",
            number(m.seed), static_cast<long long>(m.n_bonds()), facts.condition, facts.least_pivot, words.c_str(),
            hol_instruction_set(), number(g.first));
        if (!directory.empty()) keep(directory, m, words, facts.regular);
    }
}

int check_seed(std::uint64_t seed)
{
    const std::uint64_t first = seed - (seed - 1) % group_size;  // groups begin with 1, 9, ...
    const group_of_molecules g(first);
    std::vector<molecule_verdict> verdicts(g.molecules.size());
    check_invariances(g.molecules, first + 1, verdicts);
    const bool in_group = seed - first < g.molecules.size();
    const hostile_molecule m = in_group ? g.molecules[seed - first] : make_hostile_molecule(seed);
    molecule_facts facts;
    molecule_verdict v = check_alone(m, molecule_reference(m), facts);
    if (in_group) v.add(verdicts[seed - first]);
    std::printf("%llu: %s; %lld atoms, %lld bonds, condition number %.2Le, least pivot %.2Le\n", number(seed),
                m.words().c_str(), static_cast<long long>(m.n_atoms()), static_cast<long long>(m.n_bonds()),
                facts.condition, facts.least_pivot);
    v.print();
    return v.exceeded();
}

}  // namespace

int main(int argc, char **argv)
{
    const arguments given{argc, argv};
    const std::string directory = given.is(1, "--group") ? "" : given.text(2);
    const harness<group_of_molecules, tally> molecules{
        "stress_molecules",
        "--group",
        {class_name, N_CLASSES, "molecule"},
        group_of_molecules::solved,
        [&](const group_of_molecules &g, tally &sum) { check(g, directory, sum); },
        nullptr};
    return harness_main(given, 3,
                        "SECONDS [DIRECTORY [FIRST [PROCESSES [PERCENT]]]] | --group FIRST | --seed NUMBER...",
                        molecules, check_seed);
}
