#include <cmath>

#include "boundary.hpp"

using holonomic::check_n_bonds;
using holonomic::Checks;
using holonomic::guarded;
using holonomic::LongDoubleEnvironment;
using holonomic::make_error;
using holonomic::need;
using holonomic::Status;

namespace {

void need_bodies(int64_t n_bodies, const int64_t *sizes, const int64_t *atoms, const double *places) {
    need(n_bodies, sizes, "sizes");
    need(n_bodies, atoms, "atoms");
    need(n_bodies, places, "places");
}

void need_bonds(int64_t n_bonds, const int64_t *list, const double *lengths, const char *name = "pairs") {
    need(n_bonds, list, name);
    need(n_bonds, lengths, "lengths");
}

}  // namespace

int hol_chains_create(int64_t n_atoms, const double *masses, hol_chains **chains) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        *chains = nullptr;
        need(n_atoms, masses, "masses");
        *chains = new hol_chains(n_atoms, masses);
    });
}

int hol_chains_copy(const hol_chains *chains, hol_chains **copy) {
    return guarded(__func__, [&] {
        need(copy, "copy");
        *copy = nullptr;
        need(chains, "chains");
        *copy = new hol_chains(chains->chains);
    });
}

void hol_chains_destroy(hol_chains *chains) { delete chains; }

int hol_chains_add(hol_chains *chains, int64_t n_bonds, const int64_t *atoms, const double *lengths) {
    return guarded(__func__, chains, [&] {
        need_bonds(n_bonds, atoms, lengths, "atoms");
        chains->chains.add(n_bonds, atoms, lengths);
    });
}

int hol_chains_add_block(hol_chains *chains, int64_t n_chains, int64_t n_bonds, int64_t first_atom,
                         const double *lengths) {
    return guarded(__func__, chains, [&] {
        need(n_chains == 0 ? 0 : n_bonds, lengths, "lengths");
        chains->chains.add_block(n_chains, n_bonds, first_atom, lengths);
    });
}

int hol_chains_add_bonds(hol_chains *chains, int64_t n_bonds, const int64_t *pairs, const double *lengths) {
    return guarded<LongDoubleEnvironment>(__func__, chains, [&] {
        need_bonds(n_bonds, pairs, lengths);
        chains->chains.add_bonds(n_bonds, pairs, lengths);
    });
}

int hol_chains_add_molecules(hol_chains *chains, int64_t n_molecules, int64_t n_atoms, int64_t first_atom,
                             int64_t n_bonds, const int64_t *pairs, const double *lengths) {
    return guarded<LongDoubleEnvironment>(__func__, chains, [&] {
        need_bonds(n_molecules == 0 ? 0 : n_bonds, pairs, lengths);
        chains->chains.add_molecules(n_molecules, n_atoms, first_atom, n_bonds, pairs, lengths);
    });
}

int hol_chains_add_rigid(hol_chains *chains, int64_t n_bodies, const int64_t *sizes, const int64_t *atoms,
                         const double *places, int64_t n_bonds, const int64_t *pairs, const double *lengths) {
    return guarded(__func__, chains, [&] {
        need_bodies(n_bodies, sizes, atoms, places);
        need_bonds(n_bonds, pairs, lengths);
        chains->chains.add_rigid(n_bodies, sizes, atoms, places, n_bonds, pairs, lengths);
    });
}

int hol_chains_add_rigid_molecules(hol_chains *chains, int64_t n_molecules, int64_t n_atoms, int64_t first_atom,
                                   int64_t n_bodies, const int64_t *sizes, const int64_t *atoms, const double *places,
                                   int64_t n_bonds, const int64_t *pairs, const double *lengths) {
    return guarded(__func__, chains, [&] {
        need_bodies(n_molecules == 0 ? 0 : n_bodies, sizes, atoms, places);
        need_bonds(n_molecules == 0 ? 0 : n_bonds, pairs, lengths);
        chains->chains.add_rigid_molecules(n_molecules, n_atoms, first_atom, n_bodies, sizes, atoms, places, n_bonds,
                                           pairs, lengths);
    });
}

int hol_chains_set_index_base(hol_chains *chains, int base) {
    return guarded(__func__, chains, [&] {
        if (base != 0 && base != 1) throw make_error(Status::value, "the index base is %d; it must be 0 or 1", base);
        chains->chains.set_base(base);
    });
}

int hol_chains_set_bodies(hol_chains *chains, hol_bodies which) {
    return guarded(__func__, chains, [&] {
        if (which != HOL_BODIES_FOUND && which != HOL_BODIES_GIVEN)
            throw make_error(Status::value, "which is %d; it must be HOL_BODIES_FOUND or HOL_BODIES_GIVEN",
                             static_cast<int>(which));
        chains->chains.finds_bodies = which == HOL_BODIES_FOUND;
    });
}

int hol_chains_set_box(hol_chains *chains, const double *box) {
    return guarded(__func__, chains, [&] { chains->chains.set_box(box); });
}

int hol_chains_set_reference_box(hol_chains *chains, const double *box) {
    return guarded(__func__, chains, [&] { chains->chains.set_reference_box(box); });
}

int hol_chains_set_box_rate(hol_chains *chains, const double *L) {
    return guarded(__func__, chains, [&] { chains->chains.set_box_rate(L); });
}

int hol_chains_set_labels(hol_chains *chains, const int64_t *atoms, const int64_t *molecules) {
    return guarded(__func__, chains, [&] { chains->chains.set_labels(atoms, molecules); });
}

int hol_chains_add_bonds_with_images(hol_chains *chains, int64_t n_bonds, const int64_t *pairs, const double *lengths,
                                     const int64_t *images) {
    return guarded(__func__, chains, [&] {
        check_n_bonds(n_bonds);
        need(n_bonds, pairs, "pairs");
        need(n_bonds, lengths, "lengths");
        need(n_bonds, images, "images");
        chains->chains.add_with_images(n_bonds, pairs, lengths, images);
    });
}

int hol_chains_set_images(hol_chains *chains, const int64_t *images) {
    return guarded(__func__, chains, [&] {
        need(chains->n_bonds(), images, "images");
        chains->chains.set_images(images);
    });
}

int hol_chains_set_lengths(hol_chains *chains, const double *lengths) {
    return guarded(__func__, chains, [&] {
        need(chains->n_bonds(), lengths, "lengths");
        chains->chains.set_lengths(lengths);
    });
}

int hol_chains_set_length(hol_chains *chains, int64_t bond, double length) {
    return guarded(__func__, chains, [&] {
        const int base = chains->chains.base;
        if (bond < base || bond - base >= chains->n_bonds())
            throw make_error(Status::index, "bond %lld is outside %d .. %lld", static_cast<long long>(bond), base,
                             static_cast<long long>(chains->n_bonds() - 1 + base));
        chains->chains.set_length(bond - base, length);
    });
}

int hol_chains_set_masses(hol_chains *chains, const double *masses) {
    return guarded(__func__, chains, [&] {
        need(chains->n_atoms(), masses, "masses");
        chains->chains.set_masses(masses);
    });
}

static_assert(static_cast<int>(Checks::never) == HOL_NEVER && static_cast<int>(Checks::at_start) == HOL_AT_START &&
                  static_cast<int>(Checks::always) == HOL_ALWAYS,
              "core/molecules/chains.hpp and the public header disagree");

int hol_chains_set_checks(hol_chains *chains, hol_when when) {
    return guarded(__func__, chains, [&] {
        if (when != HOL_NEVER && when != HOL_AT_START && when != HOL_ALWAYS)
            throw make_error(Status::value, "when is %d; it must be HOL_NEVER, HOL_AT_START or HOL_ALWAYS",
                             static_cast<int>(when));
        chains->chains.set_checks(static_cast<Checks>(when));
    });
}

int hol_chains_set_threads(hol_chains *chains, int n_threads) {
    return guarded(__func__, chains, [&] {
        if (n_threads < 1) throw make_error(Status::value, "n_threads is %d; it must be at least 1", n_threads);
        chains->chains.n_threads = n_threads;
    });
}

int hol_chains_set_active(hol_chains *chains, const unsigned char *active) {
    return guarded(__func__, chains, [&] { chains->chains.set_active(active); });
}

int hol_chains_set_tolerance(hol_chains *chains, double tolerance) {
    return guarded(__func__, chains, [&] {
        if (!(tolerance >= 0 && tolerance < 1))
            throw make_error(Status::value,
                             "the tolerance is %g; it must be positive and below 1, a part of the square of a length, "
                             "or 0 for the default",
                             tolerance);
        chains->chains.tolerance = tolerance;
    });
}

int hol_chains_set_length_tolerance(hol_chains *chains, double tolerance) {
    return guarded(__func__, chains, [&] {
        if (!(tolerance >= 0 && tolerance <= 0.01))
            throw make_error(Status::value, "the tolerance of lengths is %g; it must be in 0 .. 0.01", tolerance);
        chains->chains.length_tolerance = tolerance;
    });
}

int hol_chains_set_memory_limit(hol_chains *chains, int64_t bytes) {
    return guarded(__func__, chains, [&] {
        if (bytes < 0)
            throw make_error(Status::value, "bytes is %lld; it must be positive, or 0 for the default",
                             static_cast<long long>(bytes));
        chains->chains.memory_limit = bytes;
    });
}

int hol_chains_set_max_iterations(hol_chains *chains, int max_iterations) {
    return guarded(__func__, chains, [&] {
        if (max_iterations < 1 || max_iterations > 1000)
            throw make_error(Status::value, "max_iterations is %d; it must be in 1 .. 1000", max_iterations);
        chains->chains.max_iterations = max_iterations;
    });
}
