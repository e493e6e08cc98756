// Molecules found in lists of bonds: their order, their shapes, and what counting refuses.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "core/molecules/given/find.hpp"

using holonomic::BondList;
using holonomic::Error;
using holonomic::find_molecules;
using holonomic::FoundMolecule;
using holonomic::FoundMolecules;
using holonomic::Masses;
using holonomic::Status;
using holonomic::Topology;
using Bonds = std::vector<std::pair<std::int64_t, std::int64_t>>;

namespace
{

const char *current = "";

void require(bool condition, const char *what)
{
    if (condition) return;
    std::printf("%s: %s\n", current, what);
    std::exit(1);
}

struct Input {
    std::vector<std::int64_t> pairs;
    std::vector<double> masses;
    Input(const Bonds &bonds, std::int64_t n_atoms, const std::vector<std::int64_t> &fixed)
        : masses(static_cast<std::size_t>(n_atoms), 1.0)
    {
        for (const auto &b : bonds) pairs.insert(pairs.end(), {b.first, b.second});
        for (const std::int64_t i : fixed) masses[static_cast<std::size_t>(i)] = 0;
    }
    FoundMolecules find() const
    {
        const std::int64_t n = static_cast<std::int64_t>(masses.size());
        const Masses w(n, masses.data(), 0);
        return find_molecules(w, n, BondList{static_cast<std::int64_t>(pairs.size()) / 2, pairs.data(), 0});
    }
};

FoundMolecules found_in(const Bonds &bonds, std::int64_t n_atoms, const std::vector<std::int64_t> &fixed = {})
{
    return Input(bonds, n_atoms, fixed).find();
}

Bonds chain(std::int64_t n, std::int64_t first = 0)
{
    Bonds bonds;
    for (std::int64_t k = 0; k < n; ++k) bonds.push_back({first + k, first + k + 1});
    return bonds;
}

Bonds ring(std::int64_t n)
{
    Bonds bonds = chain(n - 1);
    bonds.push_back({n - 1, 0});
    return bonds;
}

Bonds complete(std::int64_t n, std::int64_t first = 0)
{
    Bonds bonds;
    for (std::int64_t i = 0; i < n; ++i)
        for (std::int64_t j = i + 1; j < n; ++j) bonds.push_back({first + i, first + j});
    return bonds;
}

Bonds joined(Bonds a, const Bonds &b)
{
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

void forms_are_recognised()
{
    const struct {
        const char *name;
        Bonds bonds;
        std::int64_t n_atoms;
        std::vector<std::int64_t> fixed;
        Topology topology;
    } cases[] = {
        {"bond", {{1, 0}}, 2, {}, Topology::chain},
        {"bond to a fixed atom", {{1, 0}}, 2, {1}, Topology::chain},
        {"chain", chain(5), 6, {}, Topology::chain},
        {"chain out of order", {{3, 0}, {2, 1}, {1, 3}}, 4, {}, Topology::chain},
        {"star", {{0, 1}, {0, 2}, {0, 3}}, 4, {}, Topology::tree},
        {"star on fixed atoms", {{0, 1}, {0, 2}, {0, 3}}, 4, {1, 2, 3}, Topology::tree},
        {"triangle", ring(3), 3, {}, Topology::triangle},
        {"triangle through a fixed atom", ring(3), 3, {1}, Topology::chain},
        {"ring", ring(4), 4, {}, Topology::ring},
        {"large ring", ring(1000), 1000, {}, Topology::ring},
        {"ring through a fixed atom", ring(7), 7, {0}, Topology::chain},
        {"lasso", joined(ring(4), {{0, 4}}), 5, {}, Topology::other},
        {"ring with a fixed neighbour", joined(ring(4), {{0, 4}}), 5, {4}, Topology::other},
        {"two triangles on one atom", {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {3, 4}, {4, 0}}, 5, {}, Topology::other},
        {"tetrahedron", complete(4), 4, {}, Topology::other},
    };
    for (const auto &c : cases) {
        current = c.name;
        std::mt19937 random(1);
        Bonds bonds = c.bonds;
        for (int trial = 0; trial < 20; ++trial) {
            std::shuffle(bonds.begin(), bonds.end(), random);
            for (auto &b : bonds)
                if (random() % 2) std::swap(b.first, b.second);
            const FoundMolecules f = found_in(bonds, c.n_atoms, c.fixed);
            require(f.molecules.size() == 1 && f.molecules[0].topology == c.topology, "another topology");
            require(f.bonds.size() == bonds.size() && f.unconstrained.empty(), "bonds are missing");
        }
    }
}

// Whatever the order of the bonds: the same atoms, and the same bonds at the same places.
void order_of_the_list_does_not_matter()
{
    std::mt19937 random(7);
    for (int trial = 0; trial < 300; ++trial) {
        current = "random graph";
        const std::int64_t n = 2 + static_cast<std::int64_t>(random() % 60);
        Bonds bonds;
        std::vector<std::int64_t> fixed;
        for (std::int64_t i = 1; i < n; ++i)
            if (random() % 4) bonds.push_back({static_cast<std::int64_t>(random()) % i, i});
        for (std::int64_t i = 3; i < n; ++i)
            if (random() % 8 == 0) bonds.push_back({i - 3, i});
        for (std::int64_t i = 0; i < n; ++i)
            if (random() % 9 == 0) fixed.push_back(i);
        std::sort(bonds.begin(), bonds.end());
        bonds.erase(std::unique(bonds.begin(), bonds.end()), bonds.end());
        if (bonds.empty()) continue;
        FoundMolecules first;
        try {
            first = found_in(bonds, n, fixed);
        } catch (const Error &) {
            continue;  // too many on fixed atoms
        }
        std::vector<std::size_t> order(bonds.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::shuffle(order.begin(), order.end(), random);
        Bonds shuffled;
        for (const std::size_t k : order) {
            shuffled.push_back(bonds[k]);
            if (random() % 2) std::swap(shuffled.back().first, shuffled.back().second);
        }
        const FoundMolecules second = found_in(shuffled, n, fixed);
        require(first.atoms == second.atoms && first.pairs == second.pairs && first.fixed == second.fixed,
                "another order of atoms or bonds");
        require(first.molecules.size() == second.molecules.size(), "other molecules");
        require(first.unconstrained.size() == second.unconstrained.size(), "other bonds between fixed atoms");
        for (std::size_t k = 0; k < first.bonds.size(); ++k)
            require(order[static_cast<std::size_t>(second.bonds[k])] == static_cast<std::size_t>(first.bonds[k]),
                    "another bond at its place");
        for (const FoundMolecule &m : first.molecules)
            for (std::int64_t k = 0; k < m.n_bonds; ++k) {
                const std::size_t at = static_cast<std::size_t>(m.first_bond + k);
                const auto &bond = bonds[static_cast<std::size_t>(first.bonds[at])];
                std::int64_t ends[2];
                for (std::size_t e = 0; e < 2; ++e)
                    ends[e] = first.atoms[static_cast<std::size_t>(m.first_atom + first.pairs[2 * at + e])];
                require(std::minmax(bond.first, bond.second) == std::minmax(ends[0], ends[1]), "other atoms of a bond");
            }
    }
}

void numbers_of_large_lists_are_right()
{
    current = "a thousand chains among a million atoms, in random order";
    std::mt19937 random(5);
    std::vector<std::int64_t> atoms(1000000);
    std::iota(atoms.begin(), atoms.end(), std::int64_t{0});
    std::shuffle(atoms.begin(), atoms.end(), random);
    for (const std::size_t n_chains : {1000u, 90000u}) {  // few of the atoms, nearly all of them
        Bonds bonds;
        for (std::size_t c = 0; c < n_chains; ++c)
            for (std::size_t k = 0; k < 10; ++k) bonds.push_back({atoms[11 * c + k], atoms[11 * c + k + 1]});
        std::shuffle(bonds.begin(), bonds.end(), random);
        const FoundMolecules f = found_in(bonds, 1000000);
        require(f.molecules.size() == n_chains, "another number of chains");
        std::int64_t last = -1;
        for (const FoundMolecule &m : f.molecules) {
            const auto begin = f.atoms.begin() + m.first_atom, end = begin + m.n_atoms;
            require(m.topology == Topology::chain && m.n_bonds == 10, "not a chain of ten bonds");
            require(*begin < *(end - 1), "the higher end comes first");
            const std::int64_t lowest = *std::min_element(begin, end);
            require(lowest > last, "not in the order of their lowest atoms");
            last = lowest;
        }
    }
}

std::int64_t refused(const char *name, const Bonds &bonds, std::int64_t n_atoms,
                     const std::vector<std::int64_t> &fixed = {}, Status status = Status::degenerate)
{
    current = name;
    try {
        found_in(bonds, n_atoms, fixed);
    } catch (const Error &error) {
        require(error.status == status, "another status");
        return error.bond;
    }
    require(false, "not refused");
    return -1;
}

void accepted(const char *name, const Bonds &bonds, std::int64_t n_atoms, const std::vector<std::int64_t> &fixed = {})
{
    current = name;
    try {
        found_in(bonds, n_atoms, fixed);
    } catch (const Error &error) {
        require(false, error.message);
    }
}

void what_counting_finds_is_refused()
{
    require(refused("ten distances of five atoms", complete(5), 5) == 9, "not the last bond");
    refused("all distances of six", complete(6), 6);
    refused("five of them in a larger molecule", joined(chain(50), joined(complete(5, 50), chain(20, 54))), 75);
    refused("twice five on one atom", joined(complete(5), complete(5, 4)), 9);
    refused("an octahedron with a diagonal",
            {{0, 2}, {0, 3}, {0, 4}, {0, 5}, {1, 2}, {1, 3}, {1, 4}, {1, 5}, {2, 4}, {4, 3}, {3, 5}, {5, 2}, {0, 1}},
            6);
    refused("four bonds of one atom to fixed ones", {{0, 1}, {0, 2}, {0, 3}, {0, 4}}, 5, {1, 2, 3, 4});
    refused("the same bond twice", {{0, 1}, {1, 2}, {1, 0}}, 3);
    refused("the same bond to a fixed atom twice", {{0, 1}, {1, 2}, {1, 0}}, 3, {0});
    require(refused("the same bond twice in a long list", joined(chain(500), {{44, 43}}), 501) == 500, "another bond");
    refused("a bond of an atom with itself", {{0, 1}, {2, 2}}, 3, {}, Status::value);
    refused("a number past the end", {{0, 1}, {1, 3}}, 3, {}, Status::index);
    refused("a number before the first", {{0, 1}, {-1, 2}}, 3, {}, Status::index);

    accepted("a tetrahedron", complete(4), 4);
    accepted("an octahedron",
             {{0, 2}, {0, 3}, {0, 4}, {0, 5}, {1, 2}, {1, 3}, {1, 4}, {1, 5}, {2, 4}, {4, 3}, {3, 5}, {5, 2}}, 6);
    Bonds nine = complete(5);
    nine.pop_back();
    accepted("nine distances of five atoms", nine, 5);
    accepted("three bonds of one atom to fixed ones", {{0, 1}, {0, 2}, {0, 3}}, 4, {1, 2, 3});
    accepted("a bond between fixed atoms twice", {{0, 1}, {1, 0}, {1, 2}}, 3, {0, 1});
    // A path with rigid angles and torsions: 3 n - 6 bonds exactly, every atom bonded to the three before.
    Bonds rigid;
    for (std::int64_t i = 1; i < 300; ++i)
        for (std::int64_t j = std::max<std::int64_t>(0, i - 3); j < i; ++j) rigid.push_back({j, i});
    accepted("a rigid helix", rigid, 300);
    rigid.push_back({0, 299});
    refused("a rigid helix, closed", rigid, 300);
    rigid.pop_back();
    accepted("a rigid helix on a fixed atom", rigid, 300, {0});
    refused("a rigid helix between two fixed atoms", rigid, 300, {0, 299});  // whose distance it holds, too
}

}  // namespace

int main()
{
    forms_are_recognised();
    order_of_the_list_does_not_matter();
    numbers_of_large_lists_are_right();
    what_counting_finds_is_refused();
    return 0;
}
