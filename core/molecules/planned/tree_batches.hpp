// Trees whose shapes differ, put side by side so that they share the lanes of a vector (kernels/molecules/tree_batch/).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <tuple>
#include <vector>

#include "core/plan/tree_batch.hpp"

namespace holonomic {

class TreeBatches {
public:
    TreeBatches();
    ~TreeBatches();
    // Appends one of these trees, as many as there are lanes at most. Throws std::bad_alloc.
    void add(int lanes, const EliminationPlan *const *tree, int n_trees);
    // Or one large tree, all lanes of which are atoms of it.
    void add_large(int lanes, const EliminationPlan *tree);
    // To be called once, when all have been added.
    void finish();

    const TreeBatch *operator[](std::int64_t i) const { return &batch_[static_cast<std::size_t>(i)]; }
    std::int64_t size() const { return static_cast<std::int64_t>(batch_.size()); }
    std::size_t bytes() const;

private:
    class Maker;
    Maker &open(int lanes, const EliminationPlan *const *tree, int n_trees);
    std::unique_ptr<Maker> maker_;  // until it is finished
    struct Offsets {
        std::size_t numbers, stored, held, elimination, tile;
    };
    // Whether all its numbers fit into 16 bits. Of one large tree they are read tile by tile.
    bool is_stored(const TreeBatch &f) const {
        return f.n_tiles == 0 && f.n_rows() <= 0x10000 / lanes_ && f.n_pairs < 0x10000;
    }
    int lanes_ = 0;
    std::vector<TreeBatch> batch_;
    std::vector<Offsets> offset_;
    std::vector<std::int32_t> numbers_;  // of one batch of trees after the other
    std::vector<std::uint16_t> stored_, held_;
    std::vector<std::int32_t> tile_start_;
    std::vector<const EliminationPlan *> elimination_;
};

// Trees with nearly the same profile leave few rows empty: how many atoms have four children and more, three, two.
struct TreeProfile {
    std::int32_t n_bonds = 0, many = 0, three = 0, two = 0;
    TreeProfile() = default;
    explicit TreeProfile(const EliminationPlan &s);
    friend bool operator<(const TreeProfile &a, const TreeProfile &b) {
        return std::tie(a.n_bonds, a.many, a.three, a.two) < std::tie(b.n_bonds, b.many, b.three, b.two);
    }
};

}  // namespace holonomic
