// OpenMM's constraints on molecules of any shape: it finds rigid water by itself and gives it to SETTLE, the rest to
// CCMA, which is told the angles as they are, its best case.
#include "../molecules/elimination.hpp"
#include "graph_methods.hpp"
#include "openmm_constraints.hpp"

namespace bench {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

bool is_water(const Kind &kind) { return kind.n_atoms() == 3 && kind.n_bonds() == 3; }

/// The three atoms of two coupled bonds, the shared one in the middle.
std::array<int, 3> angle_of(const Kind &kind, int k, int l) {
    const int i = kind.first[at(k)], j = kind.second[at(k)], m = kind.first[at(l)], n = kind.second[at(l)];
    const int middle = i == m || i == n ? i : j;
    return {i + j - middle, middle, m + n - middle};
}

}  // namespace

std::size_t openmm_ccma_bonds(const Molecules &m) {
    std::size_t bonds = 0;
    for (const Molecules::Place &place : m.places)
        if (!is_water(m.kind_of(place))) bonds += m.kind_of(place).n_bonds();
    return bonds;
}

Methods openmm(Level level, const Molecules &m, const std::vector<double> &tolerances) {
    OpenmmInput input;
    input.molecules_done = m.n_chains();
    input.mass = m.mass;
    std::vector<std::vector<std::pair<int, int>>> coupled;
    for (const Kind &kind : m.kinds) coupled.push_back(coupled_bonds(kind));
    for (const Molecules::Place &place : m.places) {
        const Kind &kind = m.kind_of(place);
        const int base = static_cast<int>(place.atom);
        for (std::size_t k = 0; k < kind.n_bonds(); ++k) {
            input.pairs.push_back({base + kind.first[k], base + kind.second[k]});
            input.length.push_back(kind.length[k]);
        }
        if (is_water(kind)) continue;
        for (const auto &pair : coupled[place.kind]) {
            const std::array<int, 3> a = angle_of(kind, pair.first, pair.second);
            const double *r = &m.r[3 * place.atom];
            input.angles.push_back({base + a[0], base + a[1], base + a[2]});
            input.angle.push_back(angle_between(r + 3 * a[0], r + 3 * a[1], r + 3 * a[2]));
        }
    }
    return openmm_methods("openmm", level, m, input, tolerances, input.angles.empty() ? "" : " exact angles");
}

}  // namespace bench
