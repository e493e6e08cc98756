// Lists of numbers, one per row, in one array.
#pragma once

#include <cstdint>
#include <vector>

#include "core/index.hpp"

namespace holonomic {

using Numbers = std::vector<std::int32_t>;

struct Lists {
    Numbers start, item;
    std::int32_t size(std::int32_t i) const { return start[at(i) + 1] - start[at(i)]; }
    const std::int32_t *begin(std::int32_t i) const { return item.data() + start[at(i)]; }
    const std::int32_t *end(std::int32_t i) const { return item.data() + start[at(i) + 1]; }
};

// Which of the pairs hold each number: calls each(k, row) for the two rows of pair k.
template <class Each>
void invert(std::int32_t n_rows, std::int32_t n_pairs, const Each &each, Lists &lists) {
    lists.start.assign(at(n_rows) + 1, 0);
    lists.item.resize(2 * at(n_pairs));
    for (std::int32_t k = 0; k < n_pairs; ++k)
        for (const std::int32_t i : {each(k, 0), each(k, 1)}) ++lists.start[at(i)];
    for (std::int32_t i = 0; i < n_rows; ++i) lists.start[at(i) + 1] += lists.start[at(i)];
    // Now they are where the rows end.
    for (std::int32_t k = n_pairs; k-- > 0;)
        for (const std::int32_t i : {each(k, 0), each(k, 1)}) lists.item[at(--lists.start[at(i)])] = k;
}
template <class Each>
Lists invert(std::int32_t n_rows, std::int32_t n_pairs, const Each &each) {
    Lists lists;
    invert(n_rows, n_pairs, each, lists);
    return lists;
}

}  // namespace holonomic
