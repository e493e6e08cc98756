#include "core/molecules/chains.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/rigid/bodies.hpp"

namespace holonomic {

Chains::Chains(std::int64_t n_atoms, const double *masses)
    : n_atoms_(n_atoms), masses_(n_atoms, masses, 0), use_(n_atoms) {}

Chains::Chains(const Chains &) = default;
Chains::~Chains() = default;

void Chains::set_base(int counted_from) {
    if (counted_from != base && n_bonds_ > 0)
        throw make_error(Status::state, "molecules have been added already, with numbers counted from %d", base);
    base = counted_from;
}

// Of a bond, or of what else is taken as a nearest image.
double Chains::longest() const { return bodies_ ? std::max(longest_, bodies_->longest()) : longest_; }

void Chains::set_active(const unsigned char *active) {
    if (bodies_) bodies_->set_active(active ? active + n_chains() : nullptr);
    if (active)
        active_.assign(active, active + n_chains());
    else
        active_.clear();
    changed();
}

// A barostat sets a box at every step: positions are looked at again once it has changed by so much of its size.
void Chains::box_changed(const Box &next, Box &seen) {
    constexpr double small = 0.02;
    double size = 0, change = 0;
    for (int i = 0; i < 9; ++i) {
        size = std::max(size, std::fabs(seen.h[i]));
        change = std::max(change, std::fabs(next.h[i] - seen.h[i]));
    }
    if (next.lattice == seen.lattice && !(change > small * size)) return;
    seen = next;
    fits_.set(false);
}

void Chains::check_width(const Box &next, double longest, const double *lengths) const {
    double width;
    if (narrow_side(next, longest, &width) < 0) return;
    char atoms[256] = "";
    for (std::int64_t c = n_chains(); c-- > 0;) {
        const Molecule m = molecule(c);
        for (std::int64_t k = m.n_bonds; k-- > 0;)
            if ((lengths ? lengths[m.bond(k)] : m.length(k)) == longest)
                std::snprintf(atoms, sizeof atoms, " (atoms %s and %s)", name_of_atom(m.atom(m.i(k))).text,
                              name_of_atom(m.atom(m.j(k))).text);
    }
    throw make_error(
        Status::value,
        "the box is %g wide from face to face, less than twice the longest bond, %g%s: images of its atoms "
        "can't be told apart; are box and lengths in the same unit?",
        width, longest, atoms);
}

void Chains::set_box(const double *h) {
    const Cell next = make_cell(h);
    check_width(next, longest(), nullptr);
    box = next;
    box_changed(box, seen_box_);
}

void Chains::set_reference_box(const double *h) {
    const Cell next = make_cell(h);
    check_width(next, longest(), nullptr);
    reference_box_ = next;
    has_reference_box_ = h != nullptr;
    box_changed(reference_box_, seen_reference_);
}

void Chains::set_box_rate(const double *L) {
    box_rate_ = make_box_rate(L);
    has_box_rate_ = std::any_of(box_rate_.L, box_rate_.L + 9, [](double x) { return x != 0; });
}

}  // namespace holonomic
