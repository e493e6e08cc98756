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

void order_bonds(const Lists &bonds, const std::int32_t *atom_i, const std::int32_t *atom_j, const Numbers &core,
                 const Numbers &number, Ties ties, std::int64_t most_bytes, Numbers &order) {
    std::vector<Rows> neighbours(core.size());
    for (std::size_t p = 0; p < core.size(); ++p)
        for (const std::int32_t i : {atom_i[core[p]], atom_j[core[p]]})
            for (const std::int32_t *l = bonds.begin(i); l != bonds.end(i); ++l)
                if (*l != core[p] && number[at(*l)] >= 0) neighbours[p].push_back(number[at(*l)]);
    for (const std::int32_t p : minimum_degree(std::move(neighbours), ties, most_bytes)) order.push_back(core[at(p)]);
}

namespace {

void check_count(std::int64_t n) {
    if (n > std::numeric_limits<std::int32_t>::max())
        throw std::length_error("the elimination of a molecule fills its matrix");
}

}  // namespace

Lists neighbours_of(const Lists &meeting, std::int32_t n) {
    const std::int32_t n_lists = static_cast<std::int32_t>(meeting.start.size()) - 1;
    std::int64_t pairs = 0;
    for (std::int32_t i = 0; i < n_lists; ++i) pairs += std::int64_t{meeting.size(i)} * (meeting.size(i) - 1);
    check_count(pairs);
    return group(n, [&](const auto &give) {
        for (std::int32_t i = 0; i < n_lists; ++i)
            for (const std::int32_t *p = meeting.begin(i); p != meeting.end(i); ++p)
                for (const std::int32_t *q = meeting.begin(i); q != meeting.end(i); ++q)
                    if (p != q) give(*p, *q);
    });
}

Fill fill_of(const Lists &neighbours) {
    const std::int32_t n = static_cast<std::int32_t>(neighbours.start.size()) - 1;
    Fill fill;
    fill.column_start.assign(at(n) + 1, 0);
    // A column has the rows of the matrix and those of the columns whose first row it is, its children.
    Rows seen(at(n), -1), column, child(at(n), -1), next_child(at(n), -1);
    for (std::int32_t k = 0; k < n; ++k) {
        column.clear();
        const auto take = [&](const std::int32_t *i, const std::int32_t *end) {
            for (; i != end; ++i) {
                if (*i <= k || seen[at(*i)] == k) continue;
                seen[at(*i)] = k;
                column.push_back(*i);
            }
        };
        take(neighbours.begin(k), neighbours.end(k));
        for (std::int32_t c = child[at(k)]; c >= 0; c = next_child[at(c)])
            take(fill.row.data() + fill.column_start[at(c)], fill.row.data() + fill.column_start[at(c) + 1]);
        std::sort(column.begin(), column.end());
        check_count(static_cast<std::int64_t>(fill.row.size() + column.size()));
        fill.row.insert(fill.row.end(), column.begin(), column.end());
        fill.column_start[at(k) + 1] = static_cast<std::int32_t>(fill.row.size());
        if (column.empty()) continue;
        next_child[at(k)] = child[at(column[0])];
        child[at(column[0])] = k;
    }
    return fill;
}

Fill in_order(const Fill &fill, const Numbers &order) {
    Fill made;
    made.column_start.assign(1, 0);
    made.column_start.reserve(order.size() + 1);
    made.row.reserve(fill.row.size());
    Numbers number(order.size());
    for (std::size_t p = 0; p < order.size(); ++p) number[at(order[p])] = static_cast<std::int32_t>(p);
    for (const std::int32_t k : order) {
        for (std::int32_t e = fill.column_start[at(k)]; e < fill.column_start[at(k) + 1]; ++e)
            made.row.push_back(number[at(fill.row[at(e)])]);
        std::sort(made.row.begin() + made.column_start.back(), made.row.end());
        made.column_start.push_back(static_cast<std::int32_t>(made.row.size()));
    }
    return made;
}

}  // namespace holonomic
