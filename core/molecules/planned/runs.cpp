#include "core/molecules/planned/runs.hpp"

#include <algorithm>

#include "core/molecules/given/lists.hpp"

namespace holonomic {

namespace {

constexpr std::int32_t most_children = 4;

class RunMaker {
public:
    explicit RunMaker(const EliminationPlan &s)
        : s_(s), n_tiles_((s.n_tree + slots_of_tile - 1) / slots_of_tile), sort_(at(s.n_tree)) {
        for (std::int32_t slot = 0; slot < s.n_tree; ++slot)
            sort_[at(slot)] = static_cast<unsigned char>(std::min(children(slot), most_children));
    }

    TreeRuns make() {
        find_levels();
        runs_.tile_start.push_back(0);
        for (std::int32_t p = 0; p < n_tiles_; ++p)
            add_runs(p * slots_of_tile, std::min((p + 1) * slots_of_tile, s_.n_tree), false);
        add_runs(0, s_.n_tree, true);
        return std::move(runs_);
    }

private:
    std::int32_t children(std::int32_t slot) const { return s_.child_start[slot + 1] - s_.child_start[slot]; }

    // Of atoms with children: how many others of the same tile, or of the top, must come before.
    void find_levels() {
        level_.assign(at(s_.n_tree), 0);
        top_.assign(at(s_.n_tree), 0);
        for (std::int32_t slot = 0; slot < s_.n_tree; ++slot) {
            if (sort_[at(slot)] == 0) continue;
            const std::int32_t *const child = s_.child + s_.child_start[slot];
            const std::int32_t n = children(slot);
            for (std::int32_t c = 0; c < n; ++c)
                if (top_[at(child[c])] || child[c] / slots_of_tile != slot / slots_of_tile) top_[at(slot)] = 1;
            for (std::int32_t c = 0; c < n; ++c)
                if (sort_[at(child[c])] > 0 && top_[at(child[c])] == top_[at(slot)])
                    level_[at(slot)] = std::max(level_[at(slot)], level_[at(child[c])] + 1);
        }
    }

    // The atoms with children among these slots, by level and number of children.
    void add_runs(std::int32_t begin, std::int32_t end, bool top) {
        std::vector<std::int32_t> count;
        const auto row = [&](std::int32_t slot) { return at(most_children * level_[at(slot)] + sort_[at(slot)] - 1); };
        const auto for_each = [&](const auto &body) {
            for (std::int32_t slot = begin; slot < end; ++slot)
                if (sort_[at(slot)] > 0 && (top_[at(slot)] != 0) == top) body(slot);
        };
        for_each([&](std::int32_t slot) {
            if (row(slot) >= count.size()) count.resize(row(slot) + 1, 0);
            ++count[row(slot)];
        });
        std::int32_t next = static_cast<std::int32_t>(runs_.slot.size());
        for (std::size_t r = 0; r < count.size(); ++r) {
            if (count[r] == 0) continue;
            const std::int32_t i = static_cast<std::int32_t>(r);
            runs_.run.push_back({next, count[r], i % most_children + 1, i / most_children});
            next += count[r];
            count[r] = next - count[r];  // from now on where the next one goes
        }
        runs_.slot.resize(at(next));
        for_each([&](std::int32_t slot) { runs_.slot[at(count[row(slot)]++)] = slot; });
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
std::int64_t places_in_lanes(const TreeRuns &runs) {
    constexpr std::int64_t lanes = 8;
    std::int64_t places = 0;
    for (const EliminationPlan::AtomRun &run : runs.run)
        places += (run.count + lanes - 1) / lanes * lanes * run.children;
    return places;
}

}  // namespace holonomic
