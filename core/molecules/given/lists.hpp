// Lists of numbers, one per row, in one array.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "core/index.hpp"

namespace holonomic {

using Numbers = std::vector<std::int32_t>;

template <class T>
std::int32_t size_of(const std::vector<T> &list) {
    return static_cast<std::int32_t>(list.size());
}

// So many that are -1: of what has no number yet. Its bytes are set, which is faster than number by number.
inline Numbers minus_ones(std::int32_t n) {
    Numbers numbers(at(n));
    if (n > 0) std::memset(numbers.data(), 0xff, numbers.size() * sizeof numbers[0]);
    return numbers;
}

struct Lists {
    Numbers start, item;
    std::int32_t size(std::int32_t i) const { return start[at(i) + 1] - start[at(i)]; }
    const std::int32_t *begin(std::int32_t i) const { return item.data() + start[at(i)]; }
    const std::int32_t *end(std::int32_t i) const { return item.data() + start[at(i) + 1]; }
};

// The lists of what for_each(give) gives by give(row, item), which is done twice. A list has its items in that order.
template <class ForEach>
void group(std::int32_t n_rows, const ForEach &for_each, Lists &lists) {
    Numbers &start = lists.start;
    start.assign(at(n_rows) + 2, 0);
    for_each([&](std::int32_t row, std::int32_t) { ++start[at(row) + 2]; });
    for (std::int32_t i = 0; i < n_rows; ++i) start[at(i) + 2] += start[at(i) + 1];
    lists.item.resize(at(start.back()));
    for_each([&](std::int32_t row, std::int32_t item) { lists.item[at(start[at(row) + 1]++)] = item; });
    start.pop_back();  // a row begins where the one before has ended
}
template <class ForEach>
Lists group(std::int32_t n_rows, const ForEach &for_each) {
    Lists lists;
    group(n_rows, for_each, lists);
    return lists;
}

// Which of the pairs hold each number: calls each(k, row) for the two rows of pair k.
template <class Each>
void invert(std::int32_t n_rows, std::int32_t n_pairs, const Each &each, Lists &lists) {
    group(
        n_rows,
        [&](const auto &give) {
            for (std::int32_t k = 0; k < n_pairs; ++k) give(each(k, 0), k), give(each(k, 1), k);
        },
        lists);
}
template <class Each>
Lists invert(std::int32_t n_rows, std::int32_t n_pairs, const Each &each) {
    Lists lists;
    invert(n_rows, n_pairs, each, lists);
    return lists;
}

}  // namespace holonomic
