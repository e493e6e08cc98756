#include "core/molecules/planned/arms.hpp"

#include <algorithm>
#include <numeric>

#include "core/molecules/given/lists.hpp"
#include "core/molecules/planned/way.hpp"

namespace holonomic {

namespace {

class ArmMaker {
public:
    explicit ArmMaker(const EliminationPlan &s) : s_(s) {}

    TreeArms make() {
        find_arms();
        if (!is_mostly_arms(s_, bonds_in_arms())) return {};
        list_stretches();
        sort();
        divide();
        return std::move(x_);
    }

private:
    // Whether the bond at an index goes on along the one below it: at an atom with that child alone, to the next atom
    // and the next bond in either direction.
    bool goes_on(std::int32_t bond_index) const {
        if (s_.child_start[bond_index + 1] - s_.child_start[bond_index] != 1 ||
            s_.child[s_.child_start[bond_index]] != bond_index - 1)
            return false;
        const std::int32_t step = s_.atom_of[bond_index] - s_.atom_of[bond_index - 1];
        return (step == 1 || step == -1) && s_.atom_of[s_.parent[bond_index]] - s_.atom_of[bond_index] == step &&
               s_.bond_of[bond_index] - s_.bond_of[bond_index - 1] == step;
    }

    // Longer ones are cut into equal parts. What is left of each stays outside, at its upper end.
    void find_arms() {
        for (std::int32_t bottom = 0, end; bottom < s_.n_tree; bottom = end) {
            for (end = bottom + 1; end < s_.n_tree && goes_on(end); ++end) continue;
            const std::int32_t n = end - bottom, parts = (n + longest_arm - 1) / longest_arm;
            if (n < shortest_arm) continue;
            for (std::int32_t i = 0; i < parts; ++i) {
                const std::int32_t first = bottom + (n / parts) * i + std::min(i, n % parts);
                const std::int32_t part = n / parts + (i < n % parts ? 1 : 0);
                const std::int32_t n_bonds = (part - 1) / arm_step * arm_step + 1, last = first + n_bonds - 1;
                const bool ascending = s_.atom_of[first] < s_.atom_of[s_.parent[first]];
                x_.arm.push_back({first, n_bonds, s_.atom_of[ascending ? first : s_.parent[last]],
                                  s_.bond_of[ascending ? first : last], ascending, 0});
            }
        }
    }

    std::int32_t bonds_in_arms() const {
        std::int32_t n = 0;
        for (const EliminationPlan::Arm &arm : x_.arm) n += arm.n_bonds;
        return n;
    }

    // The last bond of the chain that an arm is stays outside its segments: it ends at the highest atom, if the arm
    // ascends, or at the lowest one.
    void list_stretches() {
        std::int32_t index = 0, bond_index = 0;
        for (std::size_t a = 0; a < x_.arm.size(); ++a) {
            const EliminationPlan::Arm &arm = x_.arm[a];
            const std::int32_t stop = arm.bottom + 1;
            x_.stretch.push_back(
                {index, stop, bond_index, arm.ascending ? stop - 1 : stop, static_cast<std::int32_t>(a)});
            index = arm.top() + 1;
            bond_index = arm.ascending ? index - 1 : index;
        }
        x_.stretch.push_back({index, s_.n_tree, bond_index, s_.n_tree, -1});
    }

    // In the order of their atoms.
    void sort() {
        Numbers order(x_.arm.size());
        std::iota(order.begin(), order.end(), 0);
        std::sort(order.begin(), order.end(),
                  [&](std::int32_t a, std::int32_t b) { return x_.arm[at(a)].first_atom < x_.arm[at(b)].first_atom; });
        const std::vector<EliminationPlan::Arm> by_index = x_.arm;
        for (std::size_t a = 0; a < order.size(); ++a) {
            x_.arm[a] = by_index[at(order[a])];
            x_.stretch[at(order[a])].arm = static_cast<std::int32_t>(a);
            if (a > 0) x_.arm[a].inner_before = x_.arm[a - 1].inner_before + x_.arm[a - 1].n_bonds - 1;
        }
    }

    // Into shares of about the longest arm.
    void divide() {
        std::int32_t bonds = 0;
        for (std::size_t a = 0; a < x_.arm.size(); ++a) {
            if (bonds == 0 || bonds + x_.arm[a].n_bonds > longest_arm) {
                x_.share_start.push_back(static_cast<std::int32_t>(a));
                bonds = 0;
            }
            bonds += x_.arm[a].n_bonds;
        }
        x_.share_start.push_back(static_cast<std::int32_t>(x_.arm.size()));
    }

    const EliminationPlan &s_;
    TreeArms x_;
};

}  // namespace

TreeArms arms_of(const EliminationPlan &s) { return ArmMaker(s).make(); }

}  // namespace holonomic
