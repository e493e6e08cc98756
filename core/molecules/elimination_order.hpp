// The order of elimination of a sparse symmetric matrix, and where its factor is filled.
#ifndef HOLONOMIC_ELIMINATION_ORDER_HPP
#define HOLONOMIC_ELIMINATION_ORDER_HPP

#include <cstdint>
#include <vector>

namespace holonomic {

// Minimum degree: the row with the fewest neighbours first, its neighbours then being coupled to each other.
// `neighbours` of each row without itself; they are used up. Of rows of equal degree the one that got it last is taken,
// so that the elimination goes along a chain of rows and not to and fro; or the first one, so that it goes on
// everywhere at once and few rows wait for many others.
enum class Ties { latest, first };
std::vector<std::int32_t> minimum_degree(std::vector<std::vector<std::int32_t>> neighbours, Ties ties = Ties::latest);

// The pattern of the factor below its diagonal for rows in the order of elimination, column by column, rows ascending.
// `neighbours` in the same numbers.
struct Fill {
    std::vector<std::int32_t> column_start, row;
};
Fill fill_of(const std::vector<std::vector<std::int32_t>> &neighbours);

}  // namespace holonomic
#endif
