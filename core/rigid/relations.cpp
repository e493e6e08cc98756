#include "core/rigid/relations.hpp"
#include "core/index.hpp"

#include <algorithm>
#include <cmath>

namespace holonomic::rigid {

namespace {

class RelationElimination {
public:
    explicit RelationElimination(const Relations &relations)
        : n_(relations.n_atoms), n_fixed_(relations.n_fixed), rows_(at(relations.count())), row_of_(at(n_), -1) {
        for (std::int32_t k = 0; k < relations.count(); ++k) {
            std::vector<double> c(relations.row(k), relations.row(k) + n_);
            for (std::int32_t j = 0; j < n_fixed_; ++j) c.push_back(relations.fixed(k, j));
            take(c, rows_[at(k)]);
        }
    }

    Leaders run(double least) {
        Leaders found;
        std::vector<bool> done(rows_.size(), false);
        for (std::size_t step = 0; step < rows_.size(); ++step) {
            std::size_t row = 0, column = 0;
            double largest = 0;
            for (std::size_t k = 0; k < rows_.size(); ++k)
                for (std::size_t i = 0; i < at(n_) && !done[k]; ++i)
                    if (std::fabs(rows_[k][i].hi) > largest) {
                        largest = std::fabs(rows_[k][i].hi);
                        row = k;
                        column = i;
                    }
            if (!(largest > least)) break;
            done[row] = true;
            row_of_[column] = static_cast<std::int32_t>(row);
            eliminate(row, column);
        }
        for (std::size_t k = 0; k < rows_.size(); ++k)
            if (!done[k]) found.left_out.push_back(static_cast<std::int32_t>(k));
        for (std::int32_t i = 0; i < n_; ++i)
            if (row_of_[at(i)] < 0) found.atoms.push_back(i);
        for (std::int32_t i = 0; i < n_; ++i)
            for (const std::int32_t leader : found.atoms)
                found.of.push_back(row_of_[at(i)] < 0 ? as_pair(i == leader) : -rows_[at(row_of_[at(i)])][at(leader)]);
        for (std::int32_t i = 0; i < n_; ++i)
            for (std::size_t j = at(n_); j < at(n_ + n_fixed_); ++j)
                found.of_fixed.push_back(row_of_[at(i)] < 0 ? as_pair(0) : -rows_[at(row_of_[at(i)])][j]);
        return found;
    }

private:
    using Row = std::vector<DoublePair>;

    // The largest coefficient 1, and a sum that is 0 to the last digit of pairs.
    static void take(const std::vector<double> &c, Row &row) {
        std::size_t largest = 0;
        for (std::size_t i = 0; i < c.size(); ++i)
            if (std::fabs(c[i]) > std::fabs(c[largest])) largest = i;
        DoublePair sum = as_pair(0);
        for (std::size_t i = 0; i < c.size(); ++i) {
            row.push_back(as_pair(c[i]) / as_pair(c[largest]));
            sum = sum + row.back();
        }
        row[largest] = row[largest] - sum;
    }

    void eliminate(std::size_t row, std::size_t column) {
        const DoublePair pivot = rows_[row][column];
        for (DoublePair &x : rows_[row]) x = x / pivot;
        for (std::size_t k = 0; k < rows_.size(); ++k) {
            const DoublePair factor = rows_[k][column];
            if (k == row || factor.hi == 0) continue;
            for (std::size_t i = 0; i < rows_[k].size(); ++i) rows_[k][i] = rows_[k][i] - factor * rows_[row][i];
            rows_[k][column] = as_pair(0);
        }
    }

    const std::int32_t n_, n_fixed_;
    std::vector<Row> rows_;
    std::vector<std::int32_t> row_of_;  // of an atom that follows
};

}  // namespace

Leaders leaders_of(const Relations &relations, double least) { return RelationElimination(relations).run(least); }

}  // namespace holonomic::rigid
