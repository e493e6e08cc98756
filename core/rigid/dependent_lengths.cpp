// Whether lengths of a shape depend on each other: asked once for each kind of molecule.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/index.hpp"
#include "core/molecules/given/lists.hpp"
#include "core/rigid/cliques.hpp"
#include "core/rigid/fit.hpp"
#include "core/rigid/planar_ring.hpp"

namespace holonomic::rigid {

namespace {

// Bonds of a molecule between atoms that can move.
class Partners {
public:
    using Atom = std::int32_t;
    using Partner = std::pair<Atom, std::int32_t>;  // and the bond
    struct List {
        const Partner *first, *last;
        const Partner *begin() const { return first; }
        const Partner *end() const { return last; }
        std::ptrdiff_t size() const { return last - first; }
    };

    Partners(const holonomic::Shape &shape, const double *w, const double *lengths) : lengths_(lengths) {
        Lists bonds = group(shape.n_atoms, [&](const auto &give) {
            for (std::int32_t k = 0; k < shape.n_bonds; ++k)
                if (const std::int32_t i = shape.i(k), j = shape.j(k); w[i] > 0 && w[j] > 0) give(i, k), give(j, k);
        });
        partner_.reserve(bonds.item.size());
        for (std::int32_t i = 0; i < shape.n_atoms; ++i) {
            for (const std::int32_t *k = bonds.begin(i); k != bonds.end(i); ++k)
                partner_.emplace_back(shape.i(*k) == i ? shape.j(*k) : shape.i(*k), *k);
            std::sort(partner_.end() - bonds.size(i), partner_.end());
        }
        start_ = std::move(bonds.start);
    }
    template <class Each>
    void for_partners(Atom atom, const Each &each) const {
        for (const Partner &partner : of(atom)) each(partner.first);
    }
    Atom with_fewer(Atom i, Atom j) const { return of(i).size() < of(j).size() ? i : j; }
    double square(Atom i, Atom j) const {
        const List list = of(i);
        const Partner *const found = std::lower_bound(list.begin(), list.end(), Partner{j, 0});
        if (found == list.end() || found->first != j) return -1;
        return lengths_[found->second] * lengths_[found->second];
    }
    List of(Atom atom) const { return {partner_.data() + start_[at(atom)], partner_.data() + start_[at(atom) + 1]}; }
    std::vector<double> lengths_around(Atom) const {
        std::vector<double> all;
        for (const Partner &partner : partner_) all.push_back(lengths_[partner.second]);
        return each_once(all);
    }

private:
    const double *const lengths_;
    Numbers start_;                 // by atom
    std::vector<Partner> partner_;  // of each atom in ascending order
};

// Calls each(atom) for partners of both, which come after `after`. The one with fewer partners is looked through: the
// other may have thousands.
template <class Each>
void for_common(const Partners &partners, std::int32_t i, std::int32_t j, std::int32_t after, const Each &each) {
    const std::int32_t looked_through = partners.with_fewer(i, j), other = i + j - looked_through;
    for (const auto &partner : partners.of(looked_through))
        if (partner.first > after && partners.square(other, partner.first) >= 0) each(partner.first);
}

bool may_be_straight(double a, double b, double c) {
    const double longest = std::max(a, std::max(b, c));
    return 2 * longest >= 0.9 * (a + b + c);
}

// Whether all distances of these atoms depend on each other, or fit no place in space.
template <std::size_t n>
bool depend(const Partners &partners, const std::int32_t (&atoms)[n], double tolerance) {
    Distances wanted(n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            if (i != j)
                wanted.at(static_cast<std::int64_t>(i), static_cast<std::int64_t>(j)) =
                    std::sqrt(partners.square(atoms[i], atoms[j]));
    return look_at(wanted, tolerance, [&] { return partners.lengths_around(atoms[0]); }).kind !=
           FittedGroup::independent;
}

// Three or four atoms, of which i is the lowest.
bool is_lowest_of_flat(const Partners &partners, std::int32_t i, double tolerance) {
    bool found = false;
    const auto square = [&](std::int32_t a, std::int32_t b) { return partners.square(a, b); };
    for (const auto &partner : partners.of(i)) {
        const std::int32_t j = partner.first;
        if (j < i) continue;
        for_common(partners, i, j, j, [&](std::int32_t k) {
            if (found) return;
            found = may_be_straight(std::sqrt(square(i, j)), std::sqrt(square(i, k)), std::sqrt(square(j, k))) &&
                    depend(partners, {i, j, k}, tolerance);
            if (found) return;
            for_common(partners, j, k, k, [&](std::int32_t l) {
                found = found || (square(i, l) > 0 && depend(partners, {i, j, k, l}, tolerance));
            });
        });
        if (found) return true;
    }
    return false;
}

}  // namespace

bool has_dependent_lengths(const holonomic::Shape &shape, const double *w, const double *lengths, double tolerance) {
    if (!shape.has_triangles) return false;  // of which groups and rings that are held in a plane consist
    const Partners partners(shape, w, lengths);
    std::int64_t steps = steps_for_rings(shape.n_bonds);
    for (std::int32_t i = 0; i < shape.n_atoms; ++i) {
        if (is_lowest_of_flat(partners, i, tolerance)) return true;
        for (const auto &partner : partners.of(i))
            if (i < partner.first && partners.of(i).size() > 3 &&
                PlanarRing<Partners>(partners, i, partner.first, tolerance, steps).find())
                return true;
    }
    return false;
}

}  // namespace holonomic::rigid
