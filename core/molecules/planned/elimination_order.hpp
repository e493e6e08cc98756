// The order of elimination of a sparse symmetric matrix, and where its factor is filled.
#pragma once

#include <cstdint>
#include <limits>
#include <new>
#include <vector>

#include "core/molecules/given/lists.hpp"

namespace holonomic {

// Thrown before memory is taken that is more than may be.
struct TooMuchMemory : std::bad_alloc {
    std::int64_t bytes;  // at least
    explicit TooMuchMemory(std::int64_t n) : bytes(n) {}
};
constexpr std::int64_t no_limit = std::numeric_limits<std::int64_t>::max();

// What a column with so many entries takes: the products that it gives to others, in two lists, and its entries there
// and in the scratch of the solvers.
constexpr std::int64_t bytes_of_column(std::int64_t entries) { return 4 * entries * (entries - 1) + 128 * entries; }

// Minimum degree: the row with the fewest neighbours first, its neighbours then being coupled to each other.
// `neighbours` of each row without itself; they are used up. Of rows of equal degree the one that got it last is taken,
// so that the elimination goes along a chain of rows and not to and fro; or the first one, so that it goes on
// everywhere at once and few rows wait for many others.
// Counts meanwhile what the elimination fills, so that nothing has to be stored to know it.
enum class Ties { latest, first };
std::vector<std::int32_t> minimum_degree(std::vector<std::vector<std::int32_t>> neighbours, Ties ties = Ties::latest,
                                         std::int64_t most_bytes = no_limit);

// Appends the bonds of `core`, which are those with a number, in the order of minimum degree: bonds meet at the atoms
// atom_i, atom_j, which have the lists `bonds`.
void order_bonds(const Lists &bonds, const std::int32_t *atom_i, const std::int32_t *atom_j, const Numbers &core,
                 const Numbers &number, Ties ties, std::int64_t most_bytes, Numbers &order);

// Of each of n rows the others that it meets somewhere, as often as they meet, where meeting.begin(i) .. end(i) are
// those that meet at i.
Lists neighbours_of(const Lists &meeting, std::int32_t n);

// The pattern of the factor below its diagonal for rows in the order of elimination, column by column, rows ascending.
// `neighbours` in the same numbers.
struct Fill {
    std::vector<std::int32_t> column_start, row;
};
Fill fill_of(const Lists &neighbours);

// The same in another order that fills as much: its columns by their numbers here.
Fill in_order(const Fill &fill, const Numbers &order);

}  // namespace holonomic
