#include "core/molecules/planned/ldl_order.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace holonomic {

namespace {

std::int32_t entries_of(const Fill &fill, std::int32_t k) {
    return fill.column_start[at(k) + 1] - fill.column_start[at(k)];
}

// The elimination's tree: the parent of a column is its first row; -1: a root. With the size of each column and all
// below it.
struct EliminationTree {
    Numbers parent, size;
    std::int32_t n() const { return static_cast<std::int32_t>(parent.size()); }
};

EliminationTree tree_of(const Fill &fill) {
    const std::int32_t n = static_cast<std::int32_t>(fill.column_start.size()) - 1;
    EliminationTree tree = {Numbers(at(n)), Numbers(at(n), 1)};
    for (std::int32_t k = 0; k < n; ++k) {
        const std::int32_t parent = entries_of(fill, k) > 0 ? fill.row[at(fill.column_start[at(k)])] : -1;
        if (parent >= 0) tree.size[at(parent)] += tree.size[at(k)];
        tree.parent[at(k)] = parent;
    }
    return tree;
}

// A post-order of the tree. Of what hangs below a column the largest part comes first, so that the rest stands next to
// it. Each part has as many places as columns, so that these are given from the largest part to the smallest.
Numbers post_order(const EliminationTree &tree) {
    const Numbers &size = tree.size, &parent = tree.parent;
    const std::int32_t n = tree.n();
    Numbers start(at(n) + 2), by_size(at(n)), next(at(n)), order(at(n));  // next: the first free place of a part
    for (const std::int32_t k : size) ++start[at(k) + 1];
    for (std::int32_t k = 0; k < n; ++k) start[at(k) + 1] += start[at(k)];
    std::int32_t used = 0;
    for (std::int32_t k = 0; k < n; ++k) {
        by_size[at(start[at(size[at(k)])]++)] = k;
        if (parent[at(k)] < 0) next[at(k)] = std::exchange(used, used + size[at(k)]);
    }
    for (std::int32_t i = n; i-- > 0;) {
        const std::int32_t k = by_size[at(i)], above = parent[at(k)];
        if (above >= 0) {
            next[at(k)] = next[at(above)];
            next[at(above)] += size[at(k)];
        }
        order[at(next[at(k)] + size[at(k)] - 1)] = k;
    }
    return order;
}

// Subtrees of at most `most` columns: of the tree what hangs from larger parts, which are the separator. Parts that
// follow each other share a subtree. Of a subtree that is no multiple of four the last columns go to the separator.
ListOrder cut(const EliminationTree &tree, const Numbers &order, std::int32_t most) {
    const Numbers &size = tree.size;
    ListOrder cut;
    cut.column.reserve(order.size());
    Numbers separator;
    std::int32_t first = 0;
    const auto end_subtree = [&](std::int32_t end) {
        const auto begin = cut.column.begin() + end - (end - first) % 4;
        separator.insert(separator.begin(), begin, cut.column.begin() + end);
        cut.column.erase(begin, cut.column.begin() + end);
        first = end - (end - first) % 4;
        cut.subtree_end.push_back(first);
    };
    for (const std::int32_t k : order) {
        if (size[at(k)] > most) {
            separator.push_back(k);
            continue;
        }
        cut.column.push_back(k);
        const std::int32_t parent = tree.parent[at(k)], n = static_cast<std::int32_t>(cut.column.size());
        if ((parent < 0 || size[at(parent)] > most) && n - first > most) end_subtree(n - size[at(k)]);
    }
    end_subtree(static_cast<std::int32_t>(cut.column.size()));
    cut.column.insert(cut.column.end(), separator.begin(), separator.end());
    return cut;
}

// As many subtrees as there can be while the separator is little, by the molecule alone; none of one that is too small
// for two threads. In a separator one column waits for the next: of a protein it takes tens of ns for each.
ListOrder in_subtrees(const EliminationTree &tree) {
    constexpr std::int32_t shortest = 8192, shortest_subtree = 2048;
    Numbers order = post_order(tree);
    const std::int32_t n = tree.n(), longest_separator = std::max(n / 256, 64);
    for (const double part : {1 / 16., 1 / 8., 1 / 4., 1 / 2., 2 / 3.}) {
        const std::int32_t most = std::max(shortest_subtree, static_cast<std::int32_t>(part * n));
        const auto separator =
            std::count_if(tree.size.begin(), tree.size.end(), [&](std::int32_t k) { return k > most; });
        if (n >= shortest && separator <= longest_separator) return cut(tree, order, most);
    }
    return {std::move(order), {}};
}

// A set of numbers below n, of which the least can be taken: bits, and for each 64 of them one that says whether any is
// there, and again.
class LeastFirst {
public:
    explicit LeastFirst(std::size_t n) {
        std::size_t words = 0;
        do {
            n = (n + 63) / 64;
            first_[n_levels_++] = words;
            words += n;
        } while (n > 1);
        word_.resize(words);
    }
    bool empty() const { return word_.back() == 0; }
    void insert(std::size_t i) {
        for (int level = 0; level < n_levels_; ++level, i /= 64) {
            std::uint64_t &word = word_[first_[level] + i / 64];
            if (std::exchange(word, word | std::uint64_t{1} << i % 64)) break;  // the levels above know of others there
        }
    }
    // The least ones, at most so many; ascending. Returns how many there were.
    std::size_t take(std::size_t *least, std::size_t most) {
        std::size_t n = 0;
        while (n < most && !empty()) {
            std::size_t i = 0;
            for (int level = n_levels_; level-- > 1;)
                i = 64 * i + static_cast<std::size_t>(__builtin_ctzll(word_[first_[level] + i]));
            std::uint64_t word = word_[i];
            for (; word && n < most; word &= word - 1)
                least[n++] = 64 * i + static_cast<std::size_t>(__builtin_ctzll(word));
            word_[i] = word;
            for (int level = 1; level < n_levels_ && word == 0; ++level, i /= 64)
                word = word_[first_[level] + i / 64] &= word_[first_[level] + i / 64] - 1;  // it was the least there
        }
        return n;
    }

private:
    std::size_t first_[11];  // word of each level; 64^11 are more than there can be
    int n_levels_ = 0;
    std::vector<std::uint64_t> word_;
};

// That order in rounds of columns that do not wait for each other, so that a processor can work on them at once: those
// farthest from the root among the next ones. Within a round by the number of entries. Each subtree by itself.
class Rounds {
public:
    Rounds(const Fill &fill, const EliminationTree &tree, const Numbers &order)
        : order_(order), column_(order.size() + 1), by_rank_(order.size()), ready_(order.size()) {
        Numbers place(order.size()), depth(order.size()), start;
        for (std::size_t p = 0; p < order.size(); ++p) place[at(order[p])] = static_cast<std::int32_t>(p);
        for (std::size_t p = order.size(); p-- > 0;) {
            const std::int32_t above = tree.parent[at(order[p])], parent = above < 0 ? -1 : place[at(above)];
            const std::int32_t d = parent < 0 ? 0 : depth[at(parent)] + 1;
            column_[p].parent = parent;
            column_[p].entries = entries_of(fill, order[p]);
            if (parent >= 0) ++column_[at(parent)].waits_for;
            depth[p] = d;
            if (start.size() <= at(d)) start.resize(at(d) + 1);
            ++start[at(d)];
        }
        std::int32_t n = 0;  // by depth, the deepest first, and of equally deep ones the first
        for (std::size_t d = start.size(); d-- > 0;) n += std::exchange(start[d], n);
        for (std::size_t p = 0; p < order.size(); ++p)
            by_rank_[at(column_[p].rank = start[at(depth[p])]++)] = static_cast<std::int32_t>(p);
    }

    // Of the columns up to `end`, after those before.
    void make(std::size_t end, Numbers &made) {
        std::size_t ranks[most_in_round];
        std::int32_t round[most_in_round];
        while (made.size() < end) {
            advance(end);
            const std::size_t n = ready_.take(ranks, most_in_round);
            for (std::size_t i = 0; i < n; ++i) {
                round[i] = by_rank_[ranks[i]];
                column_[at(round[i])].waits_for = done;
            }
            add_by_entries(round, n, made);
            for (std::size_t i = 0; i < n; ++i) release(column_[at(round[i])].parent);
        }
    }

private:
    static constexpr std::size_t most_in_round = 32, columns_ahead = 8192;
    static constexpr std::int32_t done = -1;

    // By its place in the order.
    struct Column {
        std::int32_t parent, entries;
        std::int32_t waits_for;  // so many columns, or `done`
        std::int32_t rank;       // which of those that are ready comes first
    };

    // Those with the fewest first, then those with the next number, as they stand: there are few numbers, and no branch
    // that a processor could not foresee.
    void add_by_entries(const std::int32_t *round, std::size_t n, Numbers &made) const {
        std::int32_t entries[most_in_round], sorted[most_in_round + 1];
        for (std::size_t i = 0; i < n; ++i) entries[i] = column_[at(round[i])].entries;
        std::size_t m = 0;
        for (std::int32_t least = *std::min_element(entries, entries + n), next; m < n; least = next) {
            next = std::numeric_limits<std::int32_t>::max();
            for (std::size_t i = 0; i < n; ++i) {
                sorted[m] = order_[at(round[i])];
                m += entries[i] == least;
                next = entries[i] > least ? std::min(next, entries[i]) : next;
            }
        }
        made.insert(made.end(), sorted, sorted + n);
    }
    // To the first column that is not done, and as far ahead of it as may be looked.
    void advance(std::size_t end) {
        while (column_[first_].waits_for == done) ++first_;
        for (; seen_ < std::min(end, first_ + columns_ahead); ++seen_)
            if (column_[seen_].waits_for == 0) ready_.insert(at(column_[seen_].rank));
    }
    void release(std::int32_t p) {
        if (p >= 0 && --column_[at(p)].waits_for == 0 && at(p) < seen_) ready_.insert(at(column_[at(p)].rank));
    }

    const Numbers &order_;
    std::vector<Column> column_;  // and one behind the last that is never done
    Numbers by_rank_;             // places
    std::size_t first_ = 0, seen_ = 0;
    LeastFirst ready_;  // ranks
};

}  // namespace

Numbers bonds_from_the_leaves(const EliminationPlan &s, const Lists &bonds) {
    Numbers order, leaves, left(at(s.n_atoms));
    order.reserve(at(s.n_bonds));
    leaves.reserve(at(s.n_atoms));
    std::vector<unsigned char> gone(at(s.n_bonds));
    for (std::int32_t i = 0; i < s.n_atoms; ++i)
        if ((left[at(i)] = bonds.size(i)) == 1) leaves.push_back(i);
    for (std::size_t next = 0; next < leaves.size(); ++next)
        for (const std::int32_t *k = bonds.begin(leaves[next]); k != bonds.end(leaves[next]); ++k) {
            if (gone[at(*k)]) continue;
            gone[at(*k)] = 1;
            order.push_back(*k);
            const std::int32_t other = s.atom_i[*k] ^ s.atom_j[*k] ^ leaves[next];
            if (--left[at(other)] == 1) leaves.push_back(other);
        }
    return order;
}

ListOrder order_of_list(const Fill &fill) {
    const EliminationTree tree = tree_of(fill);
    const ListOrder order = in_subtrees(tree);
    ListOrder made = {{}, order.subtree_end};
    made.column.reserve(order.column.size());
    Rounds rounds(fill, tree, order.column);
    for (const std::int32_t end : order.subtree_end) rounds.make(at(end), made.column);
    rounds.make(order.column.size(), made.column);
    return made;
}

}  // namespace holonomic
