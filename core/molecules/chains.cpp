#include "core/molecules/chains.hpp"

#include <algorithm>

namespace holonomic {

Chains::Chains(std::int64_t n_atoms, const double *masses)
    : n_atoms_(n_atoms), masses_(n_atoms, masses, 0), use_(n_atoms) {}

void Chains::set_active(const unsigned char *active) {
    if (active)
        active_.assign(active, active + n_chains());
    else
        active_.clear();
    changed();
}

void Chains::set_reference_box(const double *h) {
    reference_box_ = make_box(h);
    has_reference_box_ = h != nullptr;
}

void Chains::set_box_rate(const double *L) {
    box_rate_ = make_box_rate(L);
    has_box_rate_ = std::any_of(box_rate_.L, box_rate_.L + 9, [](double x) { return x != 0; });
}

}  // namespace holonomic
