#include "core/molecules/schedule_arms.hpp"

#include <algorithm>

namespace holonomic {

namespace {

class ArmMaker {
public:
    explicit ArmMaker(const Schedule &s) : s_(s) {}

    ScheduleArms make() {
        find_arms();
        if (x_.arm.empty()) return std::move(x_);
        list_stretches();
        sort();
        divide();
        x_.runs = runs_of(s_, x_.arm);
        return std::move(x_);
    }

private:
    // Whether the bond at a place goes on along the one below it: at an atom with that child alone, to the next atom
    // and the next bond in either direction.
    bool goes_on(std::int32_t place) const {
        if (s_.child_start[place + 1] - s_.child_start[place] != 1 || s_.child[s_.child_start[place]] != place - 1)
            return false;
        const std::int32_t step = s_.atom_of[place] - s_.atom_of[place - 1];
        return (step == 1 || step == -1) && s_.atom_of[s_.parent[place]] - s_.atom_of[place] == step &&
               s_.bond_of[place] - s_.bond_of[place - 1] == step;
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

    // The last bond of the chain that an arm is stays outside its segments: it ends at the highest atom, if the arm
    // ascends, or at the lowest one.
    void list_stretches() {
        const std::int32_t n_pieces = (s_.n_tree + slots_of_piece - 1) / slots_of_piece;
        x_.stretch_start.assign(1, 0);
        std::size_t a = 0;  // the next arm
        for (std::int32_t p = 0, slot = 0; p < n_pieces; ++p) {
            const std::int32_t end = std::min((p + 1) * slots_of_piece, s_.n_tree);
            while (slot < end) {
                const bool to_arm = a < x_.arm.size() && x_.arm[a].bottom < end;
                const bool ascends = to_arm && x_.arm[a].ascending;
                const bool behind_arm = a > 0 && x_.arm[a - 1].top() + 1 == slot && x_.arm[a - 1].ascending;
                const std::int32_t stop = to_arm ? x_.arm[a].bottom + 1 : end;
                x_.stretch.push_back({slot, stop, behind_arm ? slot - 1 : slot, ascends ? stop - 1 : stop});
                slot = to_arm ? x_.arm[a++].top() + 1 : end;
            }
            // The root has no slot among these.
            if (p + 1 == n_pieces && x_.arm.back().top() + 1 == end && x_.arm.back().ascending)
                x_.stretch.push_back({end, end, end - 1, end});
            x_.stretch_start.push_back(static_cast<std::int32_t>(x_.stretch.size()));
        }
    }

    // In the order of their atoms.
    void sort() {
        std::sort(x_.arm.begin(), x_.arm.end(),
                  [](const Schedule::Arm &a, const Schedule::Arm &b) { return a.first_atom < b.first_atom; });
        for (std::size_t a = 1; a < x_.arm.size(); ++a)
            x_.arm[a].inner_before = x_.arm[a - 1].inner_before + x_.arm[a - 1].n_bonds - 1;
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

    const Schedule &s_;
    ScheduleArms x_;
};

}  // namespace

ScheduleArms arms_of(const Schedule &s) { return ArmMaker(s).make(); }

}  // namespace holonomic
