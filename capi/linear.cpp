#include "boundary.hpp"

using holonomic::check_n_bonds;
using holonomic::guarded;
using holonomic::need;

namespace {

void need_relations(const int64_t *sizes, const int64_t *atoms, const double *coefficients, int64_t n_bonds,
                    const int64_t *pairs, const double *lengths) {
    need(sizes, "sizes");
    need(atoms, "atoms");
    need(coefficients, "coefficients");
    check_n_bonds(n_bonds);
    if (n_bonds > 0) {
        need(pairs, "pairs");
        need(lengths, "lengths");
    }
}

}  // namespace

int hol_chains_add_linear(hol_chains *chains, int64_t n_relations, const int64_t *sizes, const int64_t *atoms,
                          const double *coefficients, int64_t n_bonds, const int64_t *pairs, const double *lengths) {
    return guarded(__func__, chains, [&] {
        need_relations(sizes, atoms, coefficients, n_bonds, pairs, lengths);
        chains->chains.add_linear(n_relations, sizes, atoms, coefficients, n_bonds, pairs, lengths);
    });
}

int hol_chains_add_linear_molecules(hol_chains *chains, int64_t n_molecules, int64_t n_atoms, int64_t first_atom,
                                    int64_t n_relations, const int64_t *sizes, const int64_t *atoms,
                                    const double *coefficients, int64_t n_bonds, const int64_t *pairs,
                                    const double *lengths) {
    return guarded(__func__, chains, [&] {
        need_relations(sizes, atoms, coefficients, n_bonds, pairs, lengths);
        chains->chains.add_linear_molecules(n_molecules, n_atoms, first_atom, n_relations, sizes, atoms, coefficients,
                                            n_bonds, pairs, lengths);
    });
}
