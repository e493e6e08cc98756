#include "core/inverse/inverse.hpp"

#include <cmath>

#include "core/caller/packed_array.hpp"
#include "core/inverse/chain_inverse.hpp"
#include "core/inverse/molecule_inverse.hpp"
#include "core/run/diagnose.hpp"

namespace holonomic {

std::unique_ptr<const Inverse> Inverse::make(const Chains &chains, std::int64_t molecule, const AtomArray &r) {
    if (chains.molecule(molecule).shape) return std::make_unique<const MoleculeInverse>(chains, molecule, r);
    return std::make_unique<const ChainInverse>(chains, molecule, r);
}

void Inverse::refuse(const Chains &chains, std::int64_t molecule, const AtomArray &r) {
    Tally tally{};
    tally.n_bad = 1;
    tally.first_bad = molecule;
    throw diagnose(chains, tally, chains.box, {{"position", &r}}, Status::not_finite);
}

void Inverse::check(std::int64_t i) const {
    if (i >= 0 && i < n_bonds()) return;
    Error error = make_error(Status::index, "the number of a bond is outside %d .. %lld", base_,
                             static_cast<long long>(n_bonds()) - 1 + base_);
    error.base = base_;
    throw error;
}

void Inverse::check_finite(const std::vector<std::int64_t> &atoms, const AtomArray &v, const AtomArray &f,
                           const double *lambda) const {
    const auto check_array = [&](const AtomArray &array, const char *what) {
        if (!array.x) return;
        for (const std::int64_t atom : atoms) {
            double x[3];
            read_atom(array, atom, x);
            if (std::isfinite(std::fabs(x[0]) + std::fabs(x[1]) + std::fabs(x[2]))) continue;
            Error error = make_error(Status::not_finite, "the %s of atom %lld is not finite", what,
                                     static_cast<long long>(atom + base_));
            error.atom = atom;
            error.base = base_;
            throw error;
        }
    };
    check_array(v, "velocity");
    check_array(f, "force");
    for (std::int64_t k = 0; k < n_bonds(); ++k) {
        if (std::isfinite(lambda[k])) continue;
        Error error = make_error(Status::not_finite, "the multiplier of bond %lld is not finite",
                                 static_cast<long long>(k) + base_);
        error.bond = k;
        error.base = base_;
        throw error;
    }
}

}  // namespace holonomic
