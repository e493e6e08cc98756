#include "core/molecules/planned/runs.hpp"

#include <algorithm>

#include "core/molecules/given/lists.hpp"

namespace holonomic {

namespace {

constexpr std::int32_t most_children = 4;

class RunMaker {
public:
    explicit RunMaker(const EliminationPlan &s)
        : s_(s), n_tiles_((s.n_tree + indices_of_tile - 1) / indices_of_tile), sort_(at(s.n_tree)) {
        for (std::int32_t index = 0; index < s.n_tree; ++index)
            sort_[at(index)] = static_cast<unsigned char>(std::min(children(index), most_children));
    }

    TreeRuns make() {
        find_levels();
        runs_.tile_start.push_back(0);
        for (std::int32_t p = 0; p < n_tiles_; ++p)
            add_runs(p * indices_of_tile, std::min((p + 1) * indices_of_tile, s_.n_tree), false);
        add_runs(0, s_.n_tree, true);
        return std::move(runs_);
    }

private:
    std::int32_t children(std::int32_t index) const { return s_.child_start[index + 1] - s_.child_start[index]; }

    // Of atoms with children: how many others of the same tile, or of the top, must come before.
    void find_levels() {
        level_.assign(at(s_.n_tree), 0);
        top_.assign(at(s_.n_tree), 0);
        for (std::int32_t index = 0; index < s_.n_tree; ++index) {
            if (sort_[at(index)] == 0) continue;
            const std::int32_t *const child = s_.child + s_.child_start[index];
            const std::int32_t n = children(index);
            for (std::int32_t c = 0; c < n; ++c)
                if (top_[at(child[c])] || child[c] / indices_of_tile != index / indices_of_tile) top_[at(index)] = 1;
            for (std::int32_t c = 0; c < n; ++c)
                if (sort_[at(child[c])] > 0 && top_[at(child[c])] == top_[at(index)])
                    level_[at(index)] = std::max(level_[at(index)], level_[at(child[c])] + 1);
        }
    }

    // The atoms with children among these indices, by level and number of children.
    void add_runs(std::int32_t begin, std::int32_t end, bool top) {
        std::vector<std::int32_t> count;
        const auto row = [&](std::int32_t index) {
            return at(most_children * level_[at(index)] + sort_[at(index)] - 1);
        };
        const auto for_each = [&](const auto &body) {
            for (std::int32_t index = begin; index < end; ++index)
                if (sort_[at(index)] > 0 && (top_[at(index)] != 0) == top) body(index);
        };
        for_each([&](std::int32_t index) {
            if (row(index) >= count.size()) count.resize(row(index) + 1, 0);
            ++count[row(index)];
        });
        std::int32_t next = static_cast<std::int32_t>(runs_.index.size());
        for (std::size_t r = 0; r < count.size(); ++r) {
            if (count[r] == 0) continue;
            const std::int32_t i = static_cast<std::int32_t>(r);
            runs_.run.push_back({next, count[r], i % most_children + 1, i / most_children});
            next += count[r];
            count[r] = next - count[r];  // from now on where the next one goes
        }
        runs_.index.resize(at(next));
        for_each([&](std::int32_t index) { runs_.index[at(count[row(index)]++)] = index; });
        runs_.tile_start.push_back(static_cast<std::int32_t>(runs_.run.size()));
    }

    const EliminationPlan &s_;
    const std::int32_t n_tiles_;
    std::vector<unsigned char> sort_;  // number of children, at most most_children
    std::vector<std::int32_t> level_;
    std::vector<unsigned char> top_;
    TreeRuns runs_;
};

}  // namespace

TreeRuns runs_of(const EliminationPlan &s) { return RunMaker(s).make(); }

// Counted for lanes that are as many as most have, whatever those of the kernels are.
std::int64_t elements_in_lanes(const TreeRuns &runs) {
    constexpr std::int64_t lanes = 8;
    std::int64_t elements = 0;
    for (const EliminationPlan::AtomRun &run : runs.run)
        elements += (run.count + lanes - 1) / lanes * lanes * run.children;
    return elements;
}

}  // namespace holonomic
