// Where the constrained atoms stand in arrays of our own.
#include "arrangement.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

using namespace holonomic;

namespace {

void expect(bool holds, const char *what) {
    if (holds) return;
    std::fprintf(stderr, "not so: %s\n", what);
    std::exit(1);
}

Bond bond(int i, int j, double a = 1) { return {i, j, a, a}; }

// All bonds once, between places of their atoms; each atom but a molecule's first is bonded to its parent, before it.
void expect_sound(const Arrangement &arrangement, const std::vector<Bond> &list) {
    std::vector<int> sorted = arrangement.order;
    std::sort(sorted.begin(), sorted.end());
    expect(sorted.size() == list.size(), "each bond has a place");
    for (size_t k = 0; k < sorted.size(); k++) expect(sorted[k] == static_cast<int>(k), "each bond has one place");
    for (size_t k = 0; k < list.size(); k++) {
        const Bond &placed = arrangement.bonds[k], &given = list[arrangement.order[k]];
        expect(arrangement.atoms[placed.first] == given.first && arrangement.atoms[placed.second] == given.second,
               "a bond joins the places of its atoms");
    }
    for (size_t m = 0; m + 1 < arrangement.starts.size(); m++)
        for (int k = arrangement.starts[m]; k < arrangement.starts[m + 1]; k++) {
            const int parent = arrangement.parents[k];
            if (k == arrangement.starts[m]) {
                expect(parent == k, "the first atom is its own parent");
                continue;
            }
            expect(arrangement.starts[m] <= parent && parent < k, "a parent is before its atom, in its molecule");
            expect(std::any_of(arrangement.bonds.begin(), arrangement.bonds.end(),
                               [&](const Bond &b) { return std::minmax(b.first, b.second) == std::minmax(parent, k); }),
                   "an atom is bonded to its parent");
        }
}

void chains_stand_along_themselves() {
    const std::vector<Bond> list = {bond(3, 1), bond(1, 4), bond(4, 0)};
    const Arrangement arrangement = arrange(list, std::vector<double>(6, 1));
    expect_sound(arrangement, list);
    expect(arrangement.atoms == std::vector<int>({0, 4, 1, 3}), "a chain begins at its lower end");
}

void equal_molecules_stand_together() {
    // two waters with a chain between them, and one of other lengths
    const std::vector<Bond> list = {bond(0, 1), bond(0, 2), bond(1, 2),    bond(3, 4),     bond(5, 6),
                                    bond(5, 7), bond(6, 7), bond(8, 9, 2), bond(8, 10, 2), bond(9, 10, 2)};
    std::vector<double> masses(11, 1);
    Arrangement arrangement = arrange(list, masses);
    expect_sound(arrangement, list);
    expect(arrangement.kinds.size() == 3, "three kinds");
    expect(std::any_of(arrangement.kinds.begin(), arrangement.kinds.end(),
                       [](const Kind &kind) { return kind.count == 2 && kind.n_bonds == 3; }),
           "two waters are one kind");
    masses[6] = 5;
    arrangement = arrange(list, masses);
    expect(arrangement.kinds.size() == 4, "masses tell kinds apart");
}

void trees_keep_the_order_of_the_topology_where_that_is_one() {
    const std::vector<Bond> list = {bond(4, 7), bond(4, 5), bond(4, 6), bond(7, 8)};
    const Arrangement arrangement = arrange(list, std::vector<double>(9, 1));
    expect_sound(arrangement, list);
    expect(arrangement.atoms == std::vector<int>({4, 5, 6, 7, 8}), "ascending");
    // a hydrogen before what it is bonded to: from one neighbour to the next
    const std::vector<Bond> other = {bond(0, 2), bond(1, 2), bond(2, 3)};
    expect_sound(arrange(other, std::vector<double>(4, 1)), other);
}

void rings_and_atoms_without_bonds() {
    const std::vector<Bond> list = {bond(2, 5), bond(5, 3), bond(3, 2)};
    const Arrangement arrangement = arrange(list, std::vector<double>(9, 1));
    expect_sound(arrangement, list);
    expect(arrangement.atoms == std::vector<int>({2, 3, 5}), "atoms of no bond have no place");
    expect(arrange({}, {}).starts.size() == 1, "nothing at all");
}

}  // namespace

int main() {
    chains_stand_along_themselves();
    equal_molecules_stand_together();
    trees_keep_the_order_of_the_topology_where_that_is_one();
    rings_and_atoms_without_bonds();
    return 0;
}
