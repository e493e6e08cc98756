#include "core/run/dependent_bond.hpp"

#include <cmath>
#include <vector>

#include "core/caller/box.hpp"
#include "core/caller/view.hpp"
#include "core/inverse/careful_molecule.hpp"

namespace holonomic {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

void vector_of(const Molecule &m, std::int64_t k, const AtomArray &r, const Box &box, double *d) {
    double a[3], b[3];
    read_atom(r, m.atom(m.i(k)), a);
    read_atom(r, m.atom(m.j(k)), b);
    bond_vector(box, a, b, d);
}

}  // namespace

std::int64_t dependent_bond(const Molecule &molecule, const AtomArray &r, const Box &box) {
    const CarefulMolecule solver(molecule, r, box);
    if (solver.good()) return -1;
    return solver.dependent_bond() < 0 ? -2 : solver.dependent_bond();
}

std::int64_t open_cycle(const Molecule &m, const AtomArray &r, const Box &box) {
    if (box.shape == Box::none || m.n_bonds < m.n_atoms) return -1;
    std::vector<std::vector<std::int64_t>> arms(at(m.n_atoms));
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        arms[at(m.i(k))].push_back(k);
        arms[at(m.j(k))].push_back(k);
    }
    std::vector<double> place(at(3 * m.n_atoms));
    std::vector<unsigned char> reached(at(m.n_atoms), 0);
    std::vector<std::int64_t> stack{0};
    reached[0] = 1;
    std::int64_t open = -1;
    while (!stack.empty()) {
        const std::int64_t i = stack.back();
        stack.pop_back();
        for (const std::int64_t k : arms[at(i)]) {
            double d[3];
            vector_of(m, k, r, box, d);
            const std::int64_t j = m.i(k) == i ? m.j(k) : m.i(k);
            const double sign = m.i(k) == i ? 1 : -1;
            double size = 0, gap = 0;
            for (int c = 0; c < 3; ++c) {
                const double x = place[at(3 * i + c)] + sign * d[c];
                if (!reached[at(j)]) place[at(3 * j + c)] = x;
                gap = std::fmax(gap, std::fabs(x - place[at(3 * j + c)]));
                size = std::fmax(size, std::fabs(d[c]));
            }
            if (gap > 1e-3 * size && (open < 0 || k < open)) open = k;
            if (!reached[at(j)]) stack.push_back(j);
            reached[at(j)] = 1;
        }
    }
    return open;
}

}  // namespace holonomic
