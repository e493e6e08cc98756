#include "core/molecules/forests.hpp"

#include <algorithm>

#include "core/kernels/call.hpp"

namespace holonomic {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

std::int32_t children_of(const Schedule &s, std::int32_t slot) { return s.child_start[slot + 1] - s.child_start[slot]; }

// Atoms with 1, 2, 3, up to most_decomposed and more children.
constexpr int n_classes = 5;
int class_of(std::int32_t children) { return children > most_decomposed ? 4 : std::min(children, 4) - 1; }

// One tree: which of its atoms are ready, as all their children have been dealt with.
class Tree {
public:
    explicit Tree(const Schedule &s) : s_(s), left_(at(s.n_atoms)), depth_(at(s.n_atoms)), place_(at(s.n_atoms)) {
        for (std::int32_t slot = s.n_tree; slot-- > 0;) {
            depth_[at(slot)] = depth_[at(s.parent[slot])] + 1;
            if (children_of(s, slot) > 0) {
                ++left_[at(s.parent[slot])];
                ++n_left_;
            }
        }
        for (std::int32_t slot = 0; slot < s.n_tree; ++slot)
            if (children_of(s, slot) > 0 && left_[at(slot)] == 0) push(slot);
    }

    bool done() const { return n_left_ == 0; }

    // The atom to be taken in a step of a class, or -1: the one of most children, as deep as possible.
    std::int32_t best(int c) const {
        const int last = c > 2 ? c : 0;
        for (int i = c; i >= last; --i)
            if (!ready_[i].empty()) return ready_[i].front().slot;
        return -1;
    }
    std::int32_t children(std::int32_t slot) const { return children_of(s_, slot); }

    void take(std::int32_t slot) {
        std::vector<Ready> &heap = ready_[class_of(children(slot))];
        std::pop_heap(heap.begin(), heap.end());
        heap.pop_back();
        --n_left_;
        const std::int32_t parent = s_.parent[slot];
        if (--left_[at(parent)] == 0 && parent < s_.n_tree) push(parent);
    }

    const Schedule &schedule() const { return s_; }
    std::uint16_t &place(std::int32_t slot) { return place_[at(slot)]; }

private:
    struct Ready {
        std::int32_t children, depth, slot;
        friend bool operator<(const Ready &a, const Ready &b) {
            return std::tie(a.children, a.depth, a.slot) < std::tie(b.children, b.depth, b.slot);
        }
    };
    void push(std::int32_t slot) {
        std::vector<Ready> &heap = ready_[class_of(children(slot))];
        heap.push_back({children(slot), depth_[at(slot)], slot});
        std::push_heap(heap.begin(), heap.end());
    }

    const Schedule &s_;
    std::vector<std::int32_t> left_, depth_;
    std::vector<std::uint16_t> place_;
    std::vector<Ready> ready_[n_classes];  // heaps
    std::int32_t n_left_ = 0;
};

// What a step takes: one atom of each tree, or -1.
struct Choice {
    std::int32_t slot[most_lanes];
    std::int32_t children = 0;
    double worth = -1;
};

// The class in which the fewest places stay empty; a step by itself costs about as much as a third of a bond.
Choice choose(const std::vector<Tree> &trees) {
    Choice best;
    for (int c = 0; c < n_classes; ++c) {
        Choice one;
        double bonds = 0;
        for (std::size_t l = 0; l < trees.size(); ++l) {
            one.slot[l] = trees[l].best(c);
            if (one.slot[l] < 0) continue;
            const std::int32_t k = trees[l].children(one.slot[l]);
            one.children = std::max(one.children, k);
            bonds += k + 0.3;
        }
        one.worth = bonds / (one.children + 0.3);
        if (one.children > 0 && one.worth > best.worth) best = one;
    }
    return best;
}

}  // namespace

TreeProfile::TreeProfile(const Schedule &s) : n_bonds(s.n_bonds) {
    for (std::int32_t slot = 0; slot < s.n_tree; ++slot) {
        const std::int32_t k = children_of(s, slot);
        if (k > 1) ++(k > 3 ? many : k == 3 ? three : two);
    }
}

void Forests::add(int lanes, const Schedule *const *tree, int n_trees) {
    lanes_ = lanes;
    std::vector<Tree> trees;
    Forest f{};
    for (int l = 0; l < n_trees; ++l) {
        trees.emplace_back(*tree[l]);
        f.most_atoms = std::max<std::int64_t>(f.most_atoms, tree[l]->n_atoms);
    }
    std::vector<Forest::Step> steps;
    std::vector<std::int32_t> slots;  // [steps][lanes], or -1
    const auto add_step = [&](const std::int32_t *slot, std::int32_t children) {
        steps.push_back({f.n_places, children});
        for (int l = 0; l < lanes; ++l) {
            slots.push_back(l < n_trees ? slot[l] : -1);
            if (slots.back() < 0) continue;
            const Schedule &s = *tree[l];
            for (std::int32_t a = 0; a < children_of(s, slot[l]); ++a)
                trees[at(l)].place(s.child[s.child_start[slot[l]] + a]) = static_cast<std::uint16_t>(f.n_places + a);
        }
        f.n_places += children;
        f.n_pairs += values_of_joint(children);
        f.most_children = std::max(f.most_children, children);
    };
    while (!std::all_of(trees.begin(), trees.end(), [](const Tree &t) { return t.done(); })) {
        const Choice choice = choose(trees);
        add_step(choice.slot, choice.children);
        for (int l = 0; l < n_trees; ++l)
            if (choice.slot[l] >= 0) trees[at(l)].take(choice.slot[l]);
    }
    std::int32_t roots[most_lanes];
    for (int l = 0; l < n_trees; ++l) roots[l] = tree[l]->n_tree;
    add_step(roots, 1);
    f.n_trees = n_trees;
    f.n_steps = static_cast<std::int32_t>(steps.size());

    const std::size_t first = numbers_.size(), n_steps = at(f.n_steps) * at(lanes),
                      n_places = at(f.n_places) * at(lanes);
    offset_.push_back({step_.size(), first, held_.size(), schedule_.size()});
    forest_.push_back(f);
    step_.insert(step_.end(), steps.begin(), steps.end());
    numbers_.resize(first + 2 * n_steps + 2 * n_places);
    held_.resize(held_.size() + at(f.n_places));
    schedule_.insert(schedule_.end(), tree, tree + n_trees);
    std::uint16_t *const atom = &numbers_[first], *const above = atom + n_steps, *const lower = above + n_steps,
                         *const bond = lower + n_places, *const held = &held_[offset_.back().held];
    for (std::size_t i = 0; i < n_steps; ++i) {
        const std::size_t l = i % at(lanes);
        const std::int32_t slot = slots[i];
        above[i] = static_cast<std::uint16_t>(f.n_places + 1);
        if (slot < 0) continue;
        const Schedule &s = *tree[l];
        atom[i] = static_cast<std::uint16_t>(s.atom_of[slot]);
        above[i] = slot == s.n_tree ? static_cast<std::uint16_t>(f.n_places) : trees[l].place(slot);
    }
    for (std::size_t i = 0; i < at(f.n_steps); ++i)
        for (std::int32_t a = 0; a < steps[i].children; ++a)
            for (std::size_t l = 0; l < at(lanes); ++l) {
                const std::size_t step = i * at(lanes) + l, p = at(steps[i].first + a), place = p * at(lanes) + l;
                const std::int32_t slot = slots[step];
                lower[place] = atom[step];
                if (slot < 0 || a >= children_of(*tree[l], slot)) continue;
                const Schedule &s = *tree[l];
                const std::int32_t child = s.child[s.child_start[slot] + a];
                lower[place] = static_cast<std::uint16_t>(s.atom_of[child]);
                bond[place] = static_cast<std::uint16_t>(s.bond_of[child]);
                held[p] = static_cast<std::uint16_t>(held[p] | 1u << l);
            }
}

void Forests::finish() {
    step_.shrink_to_fit();
    numbers_.shrink_to_fit();
    held_.shrink_to_fit();
    for (std::size_t i = 0; i < forest_.size(); ++i) {
        Forest &f = forest_[i];
        const std::size_t n_steps = at(f.n_steps) * at(lanes_), n_places = at(f.n_places) * at(lanes_);
        f.step = &step_[offset_[i].step];
        f.atom = &numbers_[offset_[i].numbers];
        f.above = f.atom + n_steps;
        f.lower = f.above + n_steps;
        f.bond = f.lower + n_places;
        f.held = &held_[offset_[i].held];
        f.schedule = &schedule_[offset_[i].schedule];
    }
    offset_ = {};
}

std::size_t Forests::bytes() const {
    return forest_.capacity() * sizeof(Forest) + step_.capacity() * sizeof(Forest::Step) +
           (numbers_.capacity() + held_.capacity()) * sizeof(std::uint16_t) + schedule_.capacity() * sizeof(Schedule *);
}

}  // namespace holonomic
