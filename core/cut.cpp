// Whether bonds that a face of the box cuts fit worse than those inside: then the box is not that of the positions. One
// that is a hundredth off leaves each of them within the tenth that a reference may be off.
#include <algorithm>
#include <cmath>

#include "core/caller/box.hpp"
#include "core/caller/packed_array.hpp"
#include "core/check.hpp"
#include "core/run/bond_words.hpp"

namespace holonomic {

namespace {

// Of a length: coordinates of three decimals are off by as much.
constexpr double least_of_interest = 1e-3;
// So many times worse than the worst one inside. The worst of a few rounded lengths may be right by chance; not to so
// many digits as of coordinates that are whole.
constexpr double worse = 3, worse_than_few = 100;
constexpr std::int64_t few = 12, least_inside = 3;

struct WorstFit {
    double off = 0, length = 0;
    std::int64_t molecule = -1, bond = -1, n = 0;
    void take(const Molecule &m, std::int64_t k, double length_now) {
        ++n;
        const double its = std::fabs(length_now / m.length(k) - 1);
        if (!(its > off)) return;
        off = its;
        length = length_now;
        molecule = m.number;
        bond = k;
    }
};

}  // namespace

bool is_of_another_box(double cut, double inside, std::int64_t n_inside) {
    if (n_inside < least_inside) return false;
    return cut > std::max(least_of_interest, (n_inside < few ? worse_than_few : worse) * inside);
}

void check_cut(const Chains &chains, const AtomArray &r, const Box &box, const char *what) {
    if (box.lattice == Box::none) return;
    WorstFit cut, inside;
    chains.for_active([&](const Molecule &m) {
        for (std::int64_t k = 0; k < m.n_bonds; ++k) {
            double from[3], to[3], d[3];
            read_atom(r, m.atom(m.i(k)), from);
            read_atom(r, m.atom(m.j(k)), to);
            bond_vector(box, from, to, d);
            double straight = 0, moved = 0;
            for (int c = 0; c < 3; ++c) {
                straight = std::max(straight, std::fabs(to[c] - from[c]));
                moved = std::max(moved, std::fabs(to[c] - from[c] - d[c]));
            }
            (moved > 0.25 * straight ? cut : inside).take(m, k, std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
        }
        return true;
    });
    if (!is_of_another_box(cut.off, inside.off, inside.n)) return;
    const Molecule m = chains.molecule(cut.molecule);
    Error error = make_error(Status::lengths,
                             "molecule %s, %s: %.6g long %s, it should be %.6g; a face of the box cuts it, others fit "
                             "to %.0e: hardly the box of these positions",
                             chains.name_of_molecule(m.number).text, name_of_bond(chains, m, cut.bond).text, cut.length,
                             what, m.length(cut.bond), inside.off);
    error.chain = cut.molecule;
    error.bond = cut.bond;
    error.n_bad = 1;
    error.base = chains.base;
    throw error;
}

}  // namespace holonomic
