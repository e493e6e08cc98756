#include "core/molecules/planned/tree_batches.hpp"

#include <algorithm>

#include "core/index.hpp"
#include "core/kernels/call.hpp"

namespace holonomic {

namespace {

std::int32_t children_of(const EliminationPlan &s, std::int32_t index) {
    return s.child_start[index + 1] - s.child_start[index];
}

// Atoms with 1, 2, 3, up to most_decomposed and more children.
constexpr int n_classes = 5;
int class_of(std::int32_t children) { return children > most_decomposed ? 4 : std::min(children, 4) - 1; }

// One tree: which of its atoms are ready, as all their children have been dealt with.
class GrowingTree {
public:
    void open(const EliminationPlan &elimination) {
        s_ = &elimination;
        const EliminationPlan &s = elimination;
        left_.assign(at(s.n_atoms), 0);
        depth_.assign(at(s.n_atoms), 0);
        for (std::int32_t index = s.n_tree; index-- > 0;) {
            depth_[at(index)] = depth_[at(s.parent[index])] + 1;
            if (children_of(s, index) > 0) {
                ++left_[at(s.parent[index])];
                ++n_left_;
            }
        }
        for (std::int32_t index = 0; index < s.n_tree; ++index)
            if (children_of(s, index) > 0 && left_[at(index)] == 0) push(index);
    }

    bool done() const { return n_left_ == 0; }

    // The atom to be taken in a step of a class, or -1: the one of most children, as deep as possible.
    std::int32_t best(int c) const {
        const int last = c > 2 ? c : 0;
        for (int i = c; i >= last; --i)
            if (!ready_[i].empty()) return ready_[i].front().index;
        return -1;
    }
    std::int32_t children(std::int32_t index) const { return children_of(*s_, index); }

    void take(std::int32_t index) {
        std::vector<Ready> &heap = ready_[class_of(children(index))];
        std::pop_heap(heap.begin(), heap.end());
        heap.pop_back();
        --n_left_;
        const std::int32_t parent = s_->parent[index];
        if (--left_[at(parent)] == 0 && parent < s_->n_tree) push(parent);
    }

private:
    struct Ready {
        std::int32_t children, depth, index;
        friend bool operator<(const Ready &a, const Ready &b) {
            return std::tie(a.children, a.depth, a.index) < std::tie(b.children, b.depth, b.index);
        }
    };
    void push(std::int32_t index) {
        std::vector<Ready> &heap = ready_[class_of(children(index))];
        heap.push_back({children(index), depth_[at(index)], index});
        std::push_heap(heap.begin(), heap.end());
    }

    const EliminationPlan *s_ = nullptr;
    std::vector<std::int32_t> left_, depth_;
    std::vector<Ready> ready_[n_classes];  // heaps
    std::int32_t n_left_ = 0;
};

// What a step takes: one atom of each tree, or -1.
struct Choice {
    std::int32_t index[most_lanes];
    std::int32_t children = 0;
    double worth = -1;
};

// The class in which the fewest rows stay empty; a step by itself costs about as much as a third of a bond.
Choice choose(const GrowingTree *trees, std::size_t n_trees) {
    Choice best;
    for (int c = 0; c < n_classes; ++c) {
        Choice one;
        double bonds = 0;
        for (std::size_t l = 0; l < n_trees; ++l) {
            one.index[l] = trees[l].best(c);
            if (one.index[l] < 0) continue;
            const std::int32_t k = trees[l].children(one.index[l]);
            one.children = std::max(one.children, k);
            bonds += k + 0.3;
        }
        one.worth = bonds / (one.children + 0.3);
        if (one.children > 0 && one.worth > best.worth) best = one;
    }
    return best;
}

}  // namespace

TreeProfile::TreeProfile(const EliminationPlan &s) : n_bonds(s.n_bonds) {
    for (std::int32_t index = 0; index < s.n_tree; ++index) {
        const std::int32_t k = children_of(s, index);
        if (k > 1) ++(k > 3 ? many : k == 3 ? three : two);
    }
}

// A batch of trees in the making, one after the other: its steps, and which atom of which tree is in which lane.
class TreeBatches::Maker {
public:
    void open(int lanes, const EliminationPlan *const *tree, int n_trees) {
        lanes_ = lanes;
        tree_ = tree;
        n_trees_ = n_trees;
        f_ = {};
        f_.n_trees = n_trees;
        for (int l = 0; l < n_trees; ++l) {
            f_.most_atoms = std::max<std::int64_t>(f_.most_atoms, tree[l]->n_atoms);
            element_[l].resize(at(tree[l]->n_atoms));
        }
        steps_.clear();
        indices_.clear();
        tile_.clear();
    }
    // Takes the atoms of different trees.
    void add_steps() {
        for (int l = 0; l < n_trees_; ++l) trees_[l].open(*tree_[l]);
        const auto done = [](const GrowingTree &t) { return t.done(); };
        while (!std::all_of(trees_, trees_ + n_trees_, done)) {
            Choice choice = choose(trees_, at(n_trees_));
            std::fill(choice.index + n_trees_, choice.index + most_lanes, -1);
            add_step(choice.index, choice.children);
            for (int l = 0; l < n_trees_; ++l)
                if (choice.index[l] >= 0) trees_[l].take(choice.index[l]);
        }
    }

    const EliminationPlan &tree(std::size_t lane) const { return *tree_[n_trees_ == 1 ? 0 : lane]; }

    // index: of each lane, or -1.
    void add_step(const std::int32_t *index, std::int32_t children) {
        steps_.push_back({f_.n_bond_rows, children, f_.n_pairs});
        tile_.push_back(f_.n_tiles);
        for (std::size_t l = 0; l < at(lanes_); ++l) {
            indices_.push_back(index[l]);
            if (index[l] < 0) continue;
            const EliminationPlan &s = tree(l);
            for (std::int32_t a = 0; a < children_of(s, index[l]); ++a)
                element_of(l, s.child[s.child_start[index[l]] + a]) =
                    (f_.n_bond_rows + a) * lanes_ + static_cast<std::int32_t>(l);
        }
        f_.n_bond_rows += children;
        f_.n_pairs += values_of_joint(children);
        f_.most_children = std::max(f_.most_children, children);
    }
    void add_roots() {
        std::int32_t roots[most_lanes];
        for (int l = 0; l < most_lanes; ++l) roots[l] = l < n_trees_ ? tree_[l]->n_tree : -1;
        add_step(roots, 1);
    }
    std::int32_t n_steps() const { return static_cast<std::int32_t>(steps_.size()); }

    // Appends it to those that there are: in 16 bits, if all numbers fit.
    void append_to(TreeBatches &all) {
        f_.n_steps = n_steps();
        all.offset_.push_back({all.numbers_.size(), all.stored_.size(), all.held_.size(), all.elimination_.size(),
                               all.tile_start_.size()});
        all.batch_.push_back(f_);
        all.elimination_.insert(all.elimination_.end(), tree_, tree_ + n_trees_);
        all.held_.resize(all.held_.size() + at(f_.n_bond_rows));
        if (all.is_stored(f_)) return list(all.stored_, &all.held_[all.offset_.back().held]);
        list(all.numbers_, &all.held_[all.offset_.back().held]);
        if (f_.n_tiles > 0) all.numbers_.insert(all.numbers_.end(), element_[0].begin(), element_[0].end());
    }
    TreeBatch &batch() { return f_; }

private:
    // Appends the block of numbers.
    template <class Number>
    void list(std::vector<Number> &numbers, std::uint16_t *held) {
        const std::size_t lanes = at(lanes_), n_steps = steps_.size() * lanes, n_bond_rows = at(f_.n_bond_rows) * lanes;
        for (const TreeBatch::Step &step : steps_)
            for (const std::int32_t number : {step.first, step.children, step.pairs})
                numbers.push_back(static_cast<Number>(number));
        const std::size_t first = numbers.size();
        numbers.resize(first + 2 * (n_steps + n_bond_rows));
        Number *const atom = &numbers[first], *const above = atom + n_steps, *const lower = above + n_steps,
                      *const bond = lower + n_bond_rows;
        for (std::size_t i = 0; i < n_steps; ++i) {
            const std::int32_t index = indices_[i], lane = static_cast<std::int32_t>(i % lanes);
            const EliminationPlan &s = tree(at(lane));
            const TreeBatch::Step &step = steps_[i / lanes];
            std::int32_t element = (f_.n_bond_rows + 1 + tile_[i / lanes]) * lanes_ + lane;
            if (index >= 0) {
                atom[i] = static_cast<Number>(s.atom_of[index]);
                element = index == s.n_tree ? f_.n_bond_rows * lanes_ + lane : element_of(at(lane), index);
            }
            above[i] = static_cast<Number>(element);
            const std::int32_t children = index < 0 ? 0 : children_of(s, index);
            for (std::int32_t a = 0; a < step.children; ++a) {
                const std::size_t p = at(step.first + a), own = p * lanes + at(lane);
                lower[own] = atom[i];
                if (a >= children) continue;
                const std::int32_t child = s.child[s.child_start[index] + a];
                lower[own] = static_cast<Number>(s.atom_of[child]);
                bond[own] = static_cast<Number>(s.bond_of[child]);
                held[p] = static_cast<std::uint16_t>(held[p] | 1u << lane);
            }
        }
    }
    std::int32_t &element_of(std::size_t lane, std::int32_t index) {
        return element_[n_trees_ == 1 ? 0 : lane][at(index)];
    }

    int lanes_ = 0, n_trees_ = 0;
    const EliminationPlan *const *tree_ = nullptr;
    TreeBatch f_{};
    GrowingTree trees_[most_lanes];
    std::vector<std::int32_t> element_[most_lanes];  // by index
    std::vector<TreeBatch::Step> steps_;
    std::vector<std::int32_t> indices_;  // [steps][lanes], or -1
    std::vector<std::int32_t> tile_;     // [steps]
};

TreeBatches::TreeBatches() = default;
TreeBatches::~TreeBatches() = default;

TreeBatches::Maker &TreeBatches::open(int lanes, const EliminationPlan *const *tree, int n_trees) {
    lanes_ = lanes;
    if (!maker_) maker_ = std::make_unique<Maker>();
    maker_->open(lanes, tree, n_trees);
    return *maker_;
}

void TreeBatches::add(int lanes, const EliminationPlan *const *tree, int n_trees) {
    Maker &maker = open(lanes, tree, n_trees);
    maker.add_steps();
    maker.add_roots();
    maker.append_to(*this);
}

// Atoms that do not depend on each other share steps: those of a level, of similar numbers of children.
void TreeBatches::add_large(int lanes, const EliminationPlan *tree) {
    const EliminationPlan &s = *tree;
    Maker &maker = open(lanes, &tree, 1);
    std::vector<std::int32_t> ready;
    const auto add_level = [&] {
        std::stable_sort(ready.begin(), ready.end(), [&](std::int32_t a, std::int32_t b) {
            return std::make_pair(class_of(children_of(s, a)) > 2, children_of(s, b)) <
                   std::make_pair(class_of(children_of(s, b)) > 2, children_of(s, a));
        });
        std::int32_t index[most_lanes];
        for (std::size_t i = 0; i < ready.size();) {
            const std::int32_t most = children_of(s, ready[i]);
            const auto fits = [&](std::int32_t other) {
                const int c = class_of(children_of(s, other));
                return c == class_of(most) || (c < 3 && class_of(most) < 3);
            };
            std::fill(index, index + most_lanes, -1);
            for (int l = 0; l < lanes && i < ready.size() && fits(ready[i]); ++l) index[l] = ready[i++];
            maker.add_step(index, most);
        }
        ready.clear();
    };
    const std::size_t first_tile = tile_start_.size();
    for (std::int32_t p = 0; p <= s.n_tiles; ++p) {
        maker.batch().n_tiles = p;
        tile_start_.push_back(maker.n_steps());
        for (std::int32_t r = s.runs.tile_start[p]; r < s.runs.tile_start[p + 1]; ++r) {
            const EliminationPlan::AtomRun &run = s.runs.run[r];
            ready.insert(ready.end(), s.runs.index + run.first, s.runs.index + run.first + run.count);
            if (r + 1 == s.runs.tile_start[p + 1] || s.runs.run[r + 1].level != run.level) add_level();
        }
    }
    maker.add_roots();
    tile_start_.push_back(maker.n_steps());
    maker.append_to(*this);
    offset_.back().tile = first_tile;
}

void TreeBatches::finish() {
    maker_ = nullptr;
    numbers_.shrink_to_fit();
    stored_.shrink_to_fit();
    held_.shrink_to_fit();
    for (std::size_t i = 0; i < batch_.size(); ++i) {
        TreeBatch &f = batch_[i];
        const Offsets &offset = offset_[i];
        f.held = &held_[offset.held];
        f.elimination = &elimination_[offset.elimination];
        if (is_stored(f)) {
            f.stored = &stored_[offset.stored];
        } else {
            f.point_into(&numbers_[offset.numbers], lanes_);
            f.tile_start = f.n_tiles > 0 ? &tile_start_[offset.tile] : nullptr;
        }
    }
    offset_ = {};
}

std::size_t TreeBatches::bytes() const {
    return batch_.capacity() * sizeof(TreeBatch) +
           (numbers_.capacity() + tile_start_.capacity()) * sizeof(std::int32_t) +
           (stored_.capacity() + held_.capacity()) * sizeof(std::uint16_t) + elimination_.capacity() * sizeof(void *);
}

}  // namespace holonomic
