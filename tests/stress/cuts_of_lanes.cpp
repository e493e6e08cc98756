// Compiled once per number of lanes, with HOL_LANES and HOL_ISA as a set of kernels is.
#include "core/kernels/memory/cut.hpp"
#include "cuts.hpp"

namespace stress
{
namespace HOL_ISA
{

using namespace holonomic::HOL_ISA;

namespace
{

std::vector<std::int64_t> starts(const Cut &cut)
{
    std::vector<std::int64_t> atoms;
    for (std::int64_t s = 1; s < cut.blocks * W; ++s) atoms.push_back(cut.first(s));
    return atoms;
}

}  // namespace

cuts of_chain(std::int64_t n_bonds)
{
    if (n_bonds <= holonomic::longest_lane) return {};
    const Cut of_windows = windows(n_bonds);
    return {starts(Cut(n_bonds)),
            of_windows.rows(0) < shortest_window ? std::vector<std::int64_t>() : starts(of_windows)};
}

// As cut_of() in core/kernels/molecules/armed_tree/arm_store.hpp says. The last bond is a separator.
std::vector<std::int64_t> of_arm(std::int64_t n_bonds)
{
    const Cut cut(n_bonds - 1, segment_bonds, true);
    std::vector<std::int64_t> atoms = starts(cut);
    atoms.push_back(cut.n_bonds);
    return atoms;
}

}  // namespace HOL_ISA
}  // namespace stress
