// The arms of large trees, and what is between them.
#include <algorithm>
#include <random>

#include "plan_checks.hpp"

using namespace plan_checks;

namespace
{

/** Every slot and place of a tree is in a stretch between arms or inside of one arm, whose atoms are consecutive. */
void arms_and_stretches_hold_everything(const EliminationPlan &s)
{
    std::vector<int> slots(static_cast<std::size_t>(s.n_tree), 0), places(slots);
    const auto count = [](std::vector<int> &of, int first, int end) {
        for (int i = first; i < end; ++i) ++of[static_cast<std::size_t>(i)];
    };
    for (int i = 0; i <= s.n_arms; ++i) {
        count(slots, s.stretch[i].first, s.stretch[i].end);
        count(places, s.stretch[i].first_place, s.stretch[i].end_place);
    }
    for (int a = 0; a < s.n_arms; ++a) {
        const EliminationPlan::Arm &arm = s.arm[a];
        count(slots, arm.bottom + 1, arm.top() + 1);
        const int first = arm.ascending ? arm.bottom : arm.bottom + 1;
        count(places, first, first + arm.n_bonds - 1);
        for (int k = 0; k < arm.n_bonds; ++k) {
            const int place = arm.ascending ? arm.bottom + k : arm.top() - k;
            const int lower = s.atom_of[arm.ascending ? place : s.parent[place]];
            const int upper = s.atom_of[arm.ascending ? s.parent[place] : place];
            require(s.bond_of[place] == arm.first_bond + k, "an arm's bonds are not consecutive");
            require(lower == arm.first_atom + k && upper == lower + 1, "an arm's atoms are not consecutive");
            require(k == 0 || s.parent[arm.bottom + k - 1] == arm.bottom + k, "an arm's slots are not consecutive");
        }
    }
    for (int i = 0; i < s.n_tree; ++i) {
        require(slots[static_cast<std::size_t>(i)] == 1, "a slot is not in one stretch or arm");
        require(places[static_cast<std::size_t>(i)] == 1, "a place is not in one stretch or arm");
    }
}

void arms_of_all_lengths()
{
    std::mt19937 random(5);
    for (int longest : {100, 3000, 40000}) {
        Bonds bonds;
        int n = 1;
        std::vector<int> ends{0};
        for (int length = 1; n < 20 * longest; length = 1 + (length + 16) % longest) {
            int last = ends[random() % ends.size()];
            const bool inwards = random() % 2;
            for (int k = 0; k < length; ++k) {
                const int i = n + (inwards ? length - 1 - k : k);
                bonds.emplace_back(std::min(last, i), std::max(last, i));
                last = i;
            }
            n += length;
            ends.push_back(last);
        }
        std::sort(bonds.begin(), bonds.end());
        const auto s = check("arms", bonds, n, EliminationPlan::tree);
        require(s->n_arms > 0, "there are no arms");
        arms_and_stretches_hold_everything(*s);
    }
}

}  // namespace

int main()
{
    arms_of_all_lengths();
    return 0;
}
