#include "boundary.hpp"

using holonomic::guarded;
using holonomic::make_error;
using holonomic::need;
using holonomic::Status;

int hol_chains_add_linear(hol_chains *chains, int64_t n_relations, const int64_t *sizes, const int64_t *atoms,
                          const double *coefficients, int64_t n_bonds, const int64_t *pairs, const double *lengths) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(sizes, "sizes");
        need(atoms, "atoms");
        need(coefficients, "coefficients");
        if (n_bonds < 0 || n_bonds > int64_t{1} << 30)
            throw make_error(Status::value, "n_bonds is %lld; it must be in 0 .. 2^30",
                             static_cast<long long>(n_bonds));
        if (n_bonds > 0) {
            need(pairs, "pairs");
            need(lengths, "lengths");
        }
        chains->chains.add_linear(n_relations, sizes, atoms, coefficients, n_bonds, pairs, lengths);
    });
}
