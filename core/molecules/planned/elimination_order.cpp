#include "core/molecules/planned/elimination_order.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace holonomic {

namespace {

using Rows = std::vector<std::int32_t>;

// Rows by degree, in doubly linked lists: taking the first of the least degree and moving a row cost nothing.
class Degrees {
public:
    Degrees(std::size_t n, Ties ties)
        : ties_(ties), first_(n + 1, -1), last_(n + 1, -1), next_(n, -1), before_(n, -1), degree_(n, -1) {}

    void insert(std::int32_t i, std::size_t degree) {
        const bool front = ties_ == Ties::latest;
        const std::int32_t head = front ? first_[degree] : -1, tail = front ? -1 : last_[degree];
        degree_[at(i)] = static_cast<std::int32_t>(degree);
        before_[at(i)] = tail;
        next_[at(i)] = head;
        (tail < 0 ? first_[degree] : next_[at(tail)]) = i;
        (head < 0 ? last_[degree] : before_[at(head)]) = i;
        least_ = std::min(least_, degree);
    }
    void remove(std::int32_t i) {
        const std::int32_t b = before_[at(i)], n = next_[at(i)];
        if (b >= 0)
            next_[at(b)] = n;
        else
            first_[at(degree_[at(i)])] = n;
        if (n >= 0)
            before_[at(n)] = b;
        else
            last_[at(degree_[at(i)])] = b;
    }
    std::int32_t take_least() {
        while (first_[least_] < 0) ++least_;
        const std::int32_t i = first_[least_];
        remove(i);
        return i;
    }

private:
    static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }
    const Ties ties_;
    Rows first_, last_, next_, before_, degree_;
    std::size_t least_ = 0;
};

}  // namespace

std::vector<std::int32_t> minimum_degree(std::vector<Rows> neighbours, Ties ties, std::int64_t most_bytes) {
    const std::size_t n = neighbours.size();
    Degrees degrees(n, ties);
    for (std::size_t i = n; i-- > 0;) degrees.insert(static_cast<std::int32_t>(i), neighbours[i].size());
    Rows order, seen(n, -1);
    std::int64_t bytes = 0;
    order.reserve(n);
    for (std::size_t step = 0; step < n; ++step) {
        const std::int32_t k = degrees.take_least();
        order.push_back(k);
        const Rows front = std::move(neighbours[static_cast<std::size_t>(k)]);
        bytes += bytes_of_column(static_cast<std::int64_t>(front.size()));
        if (bytes > most_bytes) throw TooMuchMemory(bytes);
        for (const std::int32_t i : front) {
            // The neighbours of i without k, and all others of k.
            Rows &mine = neighbours[static_cast<std::size_t>(i)];
            mine.erase(std::remove(mine.begin(), mine.end(), k), mine.end());
            seen[static_cast<std::size_t>(i)] = i;
            for (const std::int32_t j : mine) seen[static_cast<std::size_t>(j)] = i;
            for (const std::int32_t j : front)
                if (seen[static_cast<std::size_t>(j)] != i) mine.push_back(j);
            degrees.remove(i);
            degrees.insert(i, mine.size());
        }
    }
    return order;
}

Fill fill_of(const std::vector<Rows> &neighbours) {
    const std::size_t n = neighbours.size();
    Fill fill;
    fill.column_start.assign(n + 1, 0);
    // A column has the rows of the matrix and those of the columns whose first row it is.
    std::vector<Rows> children(n);
    Rows seen(n, -1), column;
    for (std::size_t k = 0; k < n; ++k) {
        const std::int32_t self = static_cast<std::int32_t>(k);
        column.clear();
        const auto take = [&](std::int32_t i) {
            if (i <= self || seen[static_cast<std::size_t>(i)] == self) return;
            seen[static_cast<std::size_t>(i)] = self;
            column.push_back(i);
        };
        for (const std::int32_t i : neighbours[k]) take(i);
        for (const std::int32_t c : children[k])
            for (std::int32_t e = fill.column_start[static_cast<std::size_t>(c)];
                 e < fill.column_start[static_cast<std::size_t>(c) + 1]; ++e)
                take(fill.row[static_cast<std::size_t>(e)]);
        std::sort(column.begin(), column.end());
        if (fill.row.size() + column.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
            throw std::length_error("the elimination of a molecule fills its matrix");
        fill.row.insert(fill.row.end(), column.begin(), column.end());
        fill.column_start[k + 1] = static_cast<std::int32_t>(fill.row.size());
        if (!column.empty()) children[static_cast<std::size_t>(column[0])].push_back(self);
    }
    return fill;
}

}  // namespace holonomic
