// What has been set of a set of molecules, by the functions of chains.cpp.
#include "boundary.hpp"

using holonomic::guarded;
using holonomic::need;

int hol_chains_index_base(const hol_chains *chains) { return chains ? chains->chains.base : 0; }

int hol_chains_bodies(const hol_chains *chains) {
    return !chains || chains->chains.finds_bodies ? HOL_BODIES_FOUND : HOL_BODIES_GIVEN;
}

int hol_chains_checks(const hol_chains *chains) {
    return chains ? static_cast<int>(chains->chains.checks()) : static_cast<int>(HOL_NEVER);
}

int hol_chains_threads(const hol_chains *chains) { return chains ? chains->chains.n_threads : 0; }

int hol_chains_outcomes(const hol_chains *chains) { return chains && chains->chains.keeps_outcomes ? 1 : 0; }

double hol_chains_tolerance(const hol_chains *chains) { return chains ? chains->chains.tolerance : 0; }

double hol_chains_length_tolerance(const hol_chains *chains) { return chains ? chains->chains.length_tolerance : 0; }

int hol_chains_max_iterations(const hol_chains *chains) { return chains ? chains->chains.max_iterations : 0; }

int64_t hol_chains_memory_limit(const hol_chains *chains) { return chains ? chains->chains.memory_limit : 0; }

int hol_chains_box_rate(const hol_chains *chains, double *L) {
    return guarded(__func__, chains, [&] {
        need(L, "L");
        const holonomic::BoxRate *const rate = chains->chains.box_rate();
        for (int k = 0; k < 9; ++k) L[k] = rate ? rate->L[k] : 0;
    });
}

int hol_chains_active(const hol_chains *chains, unsigned char *active) {
    return guarded(__func__, chains, [&] {
        need(chains->chains.n_molecules(), active, "active");
        chains->chains.active(active);
    });
}

int hol_chains_labels(const hol_chains *chains, int64_t *atoms, int64_t *molecules) {
    return guarded(__func__, chains, [&] {
        const holonomic::Chains &all = chains->chains;
        for (std::int64_t a = 0; atoms && a < all.n_atoms(); ++a) atoms[a] = all.labels().number_of_atom(a, all.base);
        for (std::int64_t m = 0; molecules && m < all.n_molecules(); ++m)
            molecules[m] = all.labels().number_of_molecule(m, all.base);
    });
}
