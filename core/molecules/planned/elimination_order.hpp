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
// Of columns with 0 .. n - 1 entries.
constexpr std::int64_t bytes_of_columns_below(std::int64_t n) {
    return n * (n - 1) * (n - 2) / 3 * 4 + 64 * n * (n - 1);
}

// Minimum degree: the row with the fewest neighbours first, its neighbours then being coupled to each other.
// `neighbours` of each row without itself; they are used up. Of rows of equal degree the one that got it last is taken,
// so that the elimination goes along a chain of rows and not to and fro; or the first one, so that it goes on
// everywhere at once and few rows wait for many others.
// Counts meanwhile what the elimination fills, so that nothing has to be stored to know it.
enum class Ties { latest, first };
Numbers minimum_degree(Lists neighbours, Ties ties = Ties::latest, std::int64_t most_bytes = no_limit);

// The neighbours of the bonds of `core`, which are those with a number: all that meet at the atoms atom_i, atom_j,
// which have the lists `bonds`. By their numbers.
Lists neighbours_of(const Lists &bonds, const std::int32_t *atom_i, const std::int32_t *atom_j, const Numbers &core,
                    const Numbers &number);

// The pattern of the factor below its diagonal for rows in the order of elimination, column by column, the least row of
// each column first.
struct Fill {
    Numbers column_start, row;
};

// Makes it. For each column k, ascending: add(k, row) for the rows to which the matrix couples k, in any order and as
// often as one likes, those before k and k itself too; then end_column(k).
class FillMaker {
public:
    explicit FillMaker(std::int32_t n);
    void add(std::int32_t k, std::int32_t row) {
        if (row > k && seen_[at(row)] != k) add_new(k, row);
    }
    // One behind k that column k does not have yet.
    void add_new(std::int32_t k, std::int32_t row) {
        seen_[at(row)] = k;
        if (n_ == fill_.row.size()) fill_.row.resize(n_ + 1024);
        fill_.row[n_++] = row;
    }
    void end_column(std::int32_t k);
    // Of one whose least row was added first and couples all others already.
    void end_full_column();
    Fill made();

private:
    Fill fill_;
    std::size_t n_ = 0;  // entries so far
    Numbers seen_, child_, next_child_;
};

// Where rows are coupled that meet somewhere, no two of them twice: meeting.begin(i) .. end(i), ascending, are those
// that meet at i, and row k is at place(k, 0) and place(k, 1). The first n_free fill nothing: all that are behind one
// of them meet at one place.
template <class Place>
Fill fill_of(const Lists &meeting, std::int32_t n, std::int32_t n_free, const Place &place) {
    FillMaker maker(n);
    Numbers next = meeting.start;  // of each list the first row that is not eliminated
    for (std::int32_t k = 0; k < n; ++k) {
        for (int end = 0; end < 2; ++end) {
            const std::int32_t i = place(k, end), behind = meeting.start[at(i) + 1];
            for (std::int32_t e = ++next[at(i)]; e < behind; ++e) maker.add_new(k, meeting.item[at(e)]);
        }
        k < n_free ? maker.end_full_column() : maker.end_column(k);
    }
    return maker.made();
}

// The same with all rows of each column ascending.
Fill sorted(Fill fill);
// And in another order that fills as much: its columns by their numbers here, and where each of these stands there.
Fill in_order(const Fill &fill, const Numbers &order, const Numbers &place);

}  // namespace holonomic
