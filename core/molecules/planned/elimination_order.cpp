#include "core/molecules/planned/elimination_order.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace holonomic {

namespace {

using Rows = Numbers;

void check_count(std::int64_t n) {
    if (n > std::numeric_limits<std::int32_t>::max())
        throw std::length_error("the elimination of a molecule fills its matrix");
}

// Sorts numbers that are mostly a few: std::sort calls memmove for each.
void sort_short(std::int32_t *first, std::int32_t *end) {
    if (end - first > 32) return std::sort(first, end);
    for (std::int32_t *i = first; i < end; ++i) {
        const std::int32_t x = *i;
        std::int32_t *to = i;
        for (; to > first && to[-1] > x; --to) *to = to[-1];
        *to = x;
    }
}

// Rows by degree, in doubly linked lists: taking the first of the least degree and moving a row cost nothing.
class Degrees {
public:
    Degrees(std::int32_t n, Ties ties)
        : ties_(ties), first_(minus_ones(n + 1)), last_(minus_ones(n + 1)), next_(at(n)), before_(at(n)),
          degree_(at(n)) {}

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

// Rows that lose and gain neighbours, in one array: a row that has no room left moves to its end.
class GrowingRows {
public:
    explicit GrowingRows(Lists &&lists) : item_(std::move(lists.item)), row_(lists.start.size() - 1) {
        for (std::size_t i = 0; i < row_.size(); ++i) {
            const std::int32_t size = lists.size(static_cast<std::int32_t>(i));
            row_[i] = {at(lists.start[i]), size, size};
        }
        item_.reserve(item_.size() + item_.size() / 2);
    }
    std::int32_t count() const { return static_cast<std::int32_t>(row_.size()); }
    std::int32_t size(std::int32_t i) const { return row_[at(i)].size; }
    std::int32_t *begin(std::int32_t i) { return item_.data() + row_[at(i)].first; }
    void set_size(std::int32_t i, std::int32_t size) { row_[at(i)].size = size; }
    void add(std::int32_t i, std::int32_t item) {
        Row &row = row_[at(i)];
        if (row.size == row.room) move(row);
        item_[row.first + at(row.size++)] = item;
    }

private:
    struct Row {
        std::size_t first;
        std::int32_t size, room;
    };
    void move(Row &row) {
        const std::size_t first = item_.size();
        item_.resize(first + at(row.room = 2 * row.size + 2));
        std::copy_n(item_.data() + row.first, row.size, item_.data() + first);
        row.first = first;
    }

    Rows item_;
    std::vector<Row> row_;
};

}  // namespace

Numbers minimum_degree(Lists neighbours, Ties ties, std::int64_t most_bytes) {
    GrowingRows rows(std::move(neighbours));
    const std::int32_t n = rows.count();
    Degrees degrees(n, ties);
    for (std::int32_t i = n; i-- > 0;) degrees.insert(i, at(rows.size(i)));
    Rows order(at(n)), seen = minus_ones(n), front;
    std::int64_t bytes = 0;
    for (std::int32_t &place : order) {
        const std::int32_t k = place = degrees.take_least();
        front.resize(at(rows.size(k)));
        std::copy(rows.begin(k), rows.begin(k) + rows.size(k), front.begin());
        bytes += bytes_of_column(rows.size(k));
        if (bytes > most_bytes) throw TooMuchMemory(bytes);
        for (const std::int32_t i : front) {
            // The neighbours of i without k, and all others of k.
            std::int32_t *const mine = rows.begin(i);
            const std::int32_t size = rows.size(i);
            std::int32_t left = 0;
            seen[at(i)] = i;
            for (std::int32_t l = 0; l < size; ++l) {
                const std::int32_t j = mine[l];
                seen[at(j)] = i;
                mine[left] = j;
                left += j != k;
            }
            rows.set_size(i, left);
            for (const std::int32_t j : front)
                if (seen[at(j)] != i) rows.add(i, j);
            degrees.remove(i);
            degrees.insert(i, at(rows.size(i)));
        }
    }
    return order;
}

Lists neighbours_of(const Lists &bonds, const std::int32_t *atom_i, const std::int32_t *atom_j, const Numbers &core,
                    const Numbers &number) {
    Lists neighbours;
    neighbours.start.assign(1, 0);
    neighbours.start.reserve(core.size() + 1);
    neighbours.item.reserve(4 * core.size());
    std::size_t n = 0;
    for (const std::int32_t k : core) {
        for (const std::int32_t i : {atom_i[k], atom_j[k]}) {
            if (n + at(bonds.size(i)) > neighbours.item.size()) neighbours.item.resize(n + at(bonds.size(i)) + 1024);
            for (const std::int32_t *l = bonds.begin(i), *const end = bonds.end(i); l != end; ++l) {
                const std::int32_t other = number[at(*l)];
                neighbours.item[n] = other;
                n += (*l != k) & (other >= 0);
            }
        }
        check_count(static_cast<std::int64_t>(n));
        neighbours.start.push_back(static_cast<std::int32_t>(n));
    }
    neighbours.item.resize(n);
    return neighbours;
}

FillMaker::FillMaker(std::int32_t n) : seen_(minus_ones(n)), child_(minus_ones(n)), next_child_(at(n)) {
    fill_.column_start.reserve(at(n) + 1);
    fill_.column_start.push_back(0);
    fill_.row.reserve(4 * at(n));
}

void FillMaker::end_column(std::int32_t k) {
    // A column has those of the columns whose first row it is, its children.
    for (std::int32_t c = child_[at(k)]; c >= 0; c = next_child_[at(c)]) {
        const std::size_t first = at(fill_.column_start[at(c)]), end = at(fill_.column_start[at(c) + 1]);
        for (std::size_t e = first + 1; e < end; ++e) add(k, fill_.row[e]);
    }
    std::int32_t *const first = fill_.row.data() + fill_.column_start.back(), *const end = fill_.row.data() + n_;
    end_full_column();
    if (first == end) return;
    std::int32_t *least = first;
    for (std::int32_t *e = first + 1; e < end; ++e) least = *e < *least ? e : least;
    std::swap(*first, *least);
    next_child_[at(k)] = child_[at(*first)];
    child_[at(*first)] = k;
}

void FillMaker::end_full_column() {
    check_count(static_cast<std::int64_t>(n_));
    fill_.column_start.push_back(static_cast<std::int32_t>(n_));
}

Fill FillMaker::made() {
    fill_.row.resize(n_);
    return std::move(fill_);
}

Fill sorted(Fill fill) {
    for (std::size_t k = 0; k + 1 < fill.column_start.size(); ++k)
        sort_short(fill.row.data() + fill.column_start[k], fill.row.data() + fill.column_start[k + 1]);
    return fill;
}

Fill in_order(const Fill &fill, const Numbers &order, const Numbers &place) {
    Fill made;
    made.column_start.assign(1, 0);
    made.column_start.reserve(order.size() + 1);
    made.row.resize(fill.row.size());
    std::int32_t *end = made.row.data();
    for (const std::int32_t k : order) {
        std::int32_t *const first = end;
        for (std::int32_t e = fill.column_start[at(k)]; e < fill.column_start[at(k) + 1]; ++e)
            *end++ = place[at(fill.row[at(e)])];
        sort_short(first, end);
        made.column_start.push_back(static_cast<std::int32_t>(end - made.row.data()));
    }
    return made;
}

}  // namespace holonomic
