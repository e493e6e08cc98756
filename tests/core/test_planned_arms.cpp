// The arms of large trees, and what is between them.
#include <algorithm>
#include <random>

#include "plan_checks.hpp"

using namespace plan_checks;

namespace
{

/** Every index and bond_index of a tree is in a stretch between arms or inside of one arm, whose atoms are consecutive.
 */
void arms_and_stretches_hold_everything(const EliminationPlan &s)
{
    std::vector<int> indices(static_cast<std::size_t>(s.n_tree), 0), places(indices);
    const auto count = [](std::vector<int> &of, int first, int end) {
        for (int i = first; i < end; ++i) ++of[static_cast<std::size_t>(i)];
    };
    for (int i = 0; i <= s.n_arms; ++i) {
        count(indices, s.stretch[i].first, s.stretch[i].end);
        count(places, s.stretch[i].first_index, s.stretch[i].end_index);
    }
    for (int a = 0; a < s.n_arms; ++a) {
        const EliminationPlan::Arm &arm = s.arm[a];
        count(indices, arm.bottom + 1, arm.top() + 1);
        const int first = arm.ascending ? arm.bottom : arm.bottom + 1;
        count(places, first, first + arm.n_bonds - 1);
        for (int k = 0; k < arm.n_bonds; ++k) {
            const int bond_index = arm.ascending ? arm.bottom + k : arm.top() - k;
            const int lower = s.atom_of[arm.ascending ? bond_index : s.parent[bond_index]];
            const int upper = s.atom_of[arm.ascending ? s.parent[bond_index] : bond_index];
            require(s.bond_of[bond_index] == arm.first_bond + k, "an arm's bonds are not consecutive");
            require(lower == arm.first_atom + k && upper == lower + 1, "an arm's atoms are not consecutive");
            require(k == 0 || s.parent[arm.bottom + k - 1] == arm.bottom + k, "an arm's indices are not consecutive");
        }
    }
    for (int i = 0; i < s.n_tree; ++i) {
        require(indices[static_cast<std::size_t>(i)] == 1, "an index is not in one stretch or arm");
        require(places[static_cast<std::size_t>(i)] == 1, "a bond_index is not in one stretch or arm");
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
