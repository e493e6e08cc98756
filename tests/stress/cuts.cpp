#include "cuts.hpp"

namespace stress
{

#define STRESS_CUTS(lanes)                                      \
    namespace cuts##lanes                                       \
    {                                                           \
        cuts of_chain(std::int64_t n_bonds);                    \
        std::vector<std::int64_t> of_arm(std::int64_t n_bonds); \
    }
STRESS_CUTS(1)
STRESS_CUTS(2)
STRESS_CUTS(4)
STRESS_CUTS(8)
STRESS_CUTS(16)
#undef STRESS_CUTS

cuts cuts_of_chain(int lanes, std::int64_t n_bonds)
{
    switch (lanes) {
        case 1:
            return cuts1::of_chain(n_bonds);
        case 2:
            return cuts2::of_chain(n_bonds);
        case 4:
            return cuts4::of_chain(n_bonds);
        case 8:
            return cuts8::of_chain(n_bonds);
        default:
            return cuts16::of_chain(n_bonds);
    }
}

std::vector<std::int64_t> segments_of_arm(int lanes, std::int64_t n_bonds)
{
    switch (lanes) {
        case 1:
            return cuts1::of_arm(n_bonds);
        case 2:
            return cuts2::of_arm(n_bonds);
        case 4:
            return cuts4::of_arm(n_bonds);
        case 8:
            return cuts8::of_arm(n_bonds);
        default:
            return cuts16::of_arm(n_bonds);
    }
}

}  // namespace stress
