// The order of elimination of a sparse symmetric matrix, and where its factor is filled.
#pragma once

#include <cstdint>
#include <limits>
#include <new>
#include <utility>

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
Numbers minimum_degree(Lists neighbours, Ties ties = Ties::latest, std::int64_t most_bytes = no_limit);

// Appends the bonds of `core`, which are those with a number, in the order of minimum degree: bonds meet at the atoms
// atom_i, atom_j, which have the lists `bonds`.
void order_bonds(const Lists &bonds, const std::int32_t *atom_i, const std::int32_t *atom_j, const Numbers &core,
                 const Numbers &number, Ties ties, std::int64_t most_bytes, Numbers &order);

// The pattern of the factor below its diagonal for rows in the order of elimination, column by column, rows ascending.
struct Fill {
    Numbers column_start, row;
};

// Makes it. For each column k, ascending: add(k, row) for the rows to which the matrix couples k, in any order and as
// often as one likes, those before k and k itself too; then end_column(k).
class FillMaker {
public:
    explicit FillMaker(std::int32_t n);
    void add(std::int32_t k, std::int32_t row) {
        if (row <= k || seen_[at(row)] == k) return;
        seen_[at(row)] = k;
        fill_.row.push_back(row);
    }
    void end_column(std::int32_t k);
    Fill made() { return std::move(fill_); }

private:
    Fill fill_;
    Numbers seen_, child_, next_child_;
};

// Where rows are coupled that meet somewhere: meeting.begin(i) .. end(i) are those that meet at i, and row k is at
// place(k, 0) and place(k, 1).
template <class Place>
Fill fill_of(const Lists &meeting, std::int32_t n, const Place &place) {
    FillMaker maker(n);
    for (std::int32_t k = 0; k < n; ++k) {
        for (int end = 0; end < 2; ++end) {
            const std::int32_t i = place(k, end);
            for (const std::int32_t *row = meeting.begin(i); row != meeting.end(i); ++row) maker.add(k, *row);
        }
        maker.end_column(k);
    }
    return maker.made();
}

// The same in another order that fills as much: its columns by their numbers here.
Fill in_order(const Fill &fill, const Numbers &order);

}  // namespace holonomic
