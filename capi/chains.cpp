#include <cmath>

#include "boundary.hpp"

using holonomic::guarded;
using holonomic::make_error;
using holonomic::need;
using holonomic::Status;

int hol_chains_create(int64_t n_atoms, const double *masses, hol_chains **chains) {
    return guarded([&] {
        need(chains, "chains");
        *chains = nullptr;
        if (n_atoms != 0) need(masses, "masses");
        *chains = new hol_chains(n_atoms, masses);
    });
}

void hol_chains_destroy(hol_chains *chains) { delete chains; }

int hol_chains_add(hol_chains *chains, int64_t n_bonds, const int64_t *atoms, const double *lengths) {
    return guarded([&] {
        need(chains, "chains");
        need(atoms, "atoms");
        need(lengths, "lengths");
        chains->chains.add(n_bonds, atoms, lengths);
    });
}

int hol_chains_add_block(hol_chains *chains, int64_t n_chains, int64_t n_bonds, int64_t first_atom,
                         const double *lengths) {
    return guarded([&] {
        need(chains, "chains");
        need(lengths, "lengths");
        chains->chains.add_block(n_chains, n_bonds, first_atom, lengths);
    });
}

int hol_chains_set_index_base(hol_chains *chains, int base) {
    return guarded([&] {
        need(chains, "chains");
        if (base != 0 && base != 1) throw make_error(Status::value, "the index base is %d; it must be 0 or 1", base);
        chains->chains.base = base;
    });
}

int hol_chains_set_box(hol_chains *chains, const double *box) {
    return guarded([&] {
        need(chains, "chains");
        chains->chains.set_box(box);
    });
}

int hol_chains_set_threads(hol_chains *chains, int n_threads) {
    return guarded([&] {
        need(chains, "chains");
        if (n_threads < 1) throw make_error(Status::value, "n_threads is %d; it must be at least 1", n_threads);
        chains->chains.n_threads = n_threads;
    });
}

int hol_chains_set_active(hol_chains *chains, const unsigned char *active) {
    return guarded([&] {
        need(chains, "chains");
        chains->chains.set_active(active);
    });
}

int hol_chains_set_tolerance(hol_chains *chains, double tolerance) {
    return guarded([&] {
        need(chains, "chains");
        if (!(tolerance >= 0) || !std::isfinite(tolerance))
            throw make_error(Status::value, "the tolerance is %g; it must be positive, or 0 for the default",
                             tolerance);
        chains->chains.tolerance = tolerance;
    });
}

int hol_chains_set_max_iterations(hol_chains *chains, int max_iterations) {
    return guarded([&] {
        need(chains, "chains");
        if (max_iterations < 1 || max_iterations > 1000)
            throw make_error(Status::value, "max_iterations is %d; it must be in 1 .. 1000", max_iterations);
        chains->chains.max_iterations = max_iterations;
    });
}

int64_t hol_chains_n_atoms(const hol_chains *chains) { return chains ? chains->chains.n_atoms() : 0; }
int64_t hol_chains_n_chains(const hol_chains *chains) { return chains ? chains->chains.n_chains() : 0; }
int64_t hol_chains_n_bonds(const hol_chains *chains) { return chains ? chains->chains.n_bonds() : 0; }

int hol_chains_offsets(const hol_chains *chains, int64_t *offsets) {
    return guarded([&] {
        need(chains, "chains");
        need(offsets, "offsets");
        chains->chains.offsets(offsets);
    });
}

int hol_chains_atoms(const hol_chains *chains, int64_t chain, int64_t *atoms) {
    return guarded([&] {
        need(chains, "chains");
        need(atoms, "atoms");
        const int base = chains->chains.base;
        const int64_t n = chains->chains.n_chains();
        if (chain < base || chain - base >= n)
            throw make_error(Status::index, "chain %lld is outside %d .. %lld", static_cast<long long>(chain), base,
                             static_cast<long long>(n - 1 + base));
        chains->chains.atoms(chain - base, atoms);
    });
}

int64_t hol_chains_degrees_of_freedom(const hol_chains *chains, int dimensions) {
    return chains && (dimensions == 2 || dimensions == 3) ? chains->chains.degrees_of_freedom(dimensions) : -1;
}

int64_t hol_chains_memory(const hol_chains *chains) { return chains ? chains->chains.memory() : 0; }
