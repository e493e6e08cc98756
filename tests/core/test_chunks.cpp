// How molecules are cut into chunks of work: large ones are chunks of their own, so that threads share them; small ones
// of a kind stand together.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/molecules/chains.hpp"

namespace
{

// Copies of a chain of n_bonds with a side atom at its second atom, and a bond between its first and third if `cyclic`.
std::size_t chunks_of(std::int64_t copies, std::int64_t n_bonds, bool cyclic)
{
    std::vector<std::int64_t> pairs;
    for (std::int64_t k = 0; k < n_bonds; ++k) pairs.insert(pairs.end(), {k, k + 1});
    pairs.insert(pairs.end(), {1, n_bonds + 1});
    if (cyclic) pairs.insert(pairs.end(), {0, 2});
    const std::int64_t n_atoms = n_bonds + 2, all_bonds = static_cast<std::int64_t>(pairs.size() / 2);
    const std::vector<double> lengths(static_cast<std::size_t>(all_bonds), 1.0);
    const std::vector<double> masses(static_cast<std::size_t>(copies * n_atoms), 1.0);
    holonomic::Chains chains(copies * n_atoms, masses.data());
    chains.add_molecules(copies, n_atoms, 0, all_bonds, pairs.data(), lengths.data());
    return chains.plan().chunks.size();
}

void require(const char *what, std::size_t chunks, std::size_t expected)
{
    if (chunks == expected) return;
    std::printf("%s: %zu chunks instead of %zu\n", what, chunks, expected);
    std::exit(1);
}

}  // namespace

int main()
{
    for (std::int64_t copies : {1, 2, 7, 8, 9, 20}) {
        const auto n = static_cast<std::size_t>(copies);
        require("trees of 3000 bonds", chunks_of(copies, 3000, false), n);
        require("graphs of 3000 bonds", chunks_of(copies, 3000, true), n);
        require("graphs of 300 bonds", chunks_of(copies, 300, true), n);
    }
    require("trees of 20 bonds", chunks_of(16, 20, false), 1);
    require("graphs of 20 bonds", chunks_of(16, 20, true), 1);
    return 0;
}
