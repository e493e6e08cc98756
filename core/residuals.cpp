#include "core/residuals.hpp"

#include <cmath>

#include "core/caller/packed_array.hpp"
#include "core/kernels/tally.hpp"
#include "core/rigid/parts.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/staging.hpp"

namespace holonomic {

namespace {

Residual residual_of(const Chains &chains, const Molecule &m, std::int64_t k, const AtomArray &r, const AtomArray &v) {
    double from[3], to[3], d[3], from_v[3] = {0, 0, 0}, to_v[3] = {0, 0, 0};
    read_atom(r, m.atom(m.i(k)), from);
    read_atom(r, m.atom(m.j(k)), to);
    if (v.x) {
        read_atom(v, m.atom(m.i(k)), from_v);
        read_atom(v, m.atom(m.j(k)), to_v);
    }
    bond_vector(chains.box, from, to, d);
    return residual_of(d, from_v, to_v, m.length(k), v.x ? chains.box_rate() : nullptr);
}

void residuals_of_bonds(const Chains &chains, const AtomArray &r, const AtomArray &v, double *length, double *rate) {
    Tally tally = empty_tally();
    chains.for_active([&](const Molecule &m) {
        bool finite = true;
        for (std::int64_t k = 0; k < m.n_bonds && finite; ++k) {
            const Residual left = residual_of(chains, m, k, r, v);
            finite = std::isfinite(left.length) && std::isfinite(left.rate);
        }
        if (!finite) note_bad(m.number, tally);
        for (std::int64_t k = 0; k < m.n_bonds && finite; ++k) {
            const Residual left = residual_of(chains, m, k, r, v);
            if (length) length[m.bond(k)] = left.length;
            if (rate) rate[m.bond(k)] = left.rate;
        }
        return true;
    });
    clear_unconstrained(chains, length);
    clear_unconstrained(chains, rate);
    if (tally.n_bad == 0) return;
    Error error = diagnose(chains, tally, chains.box, {{"position", &r}, {"velocity", &v}}, Status::not_finite);
    error.status = Status::not_finite;  // whatever else is wrong with that molecule, it gives no number
    throw error;
}

}  // namespace

void residuals(const Chains &chains, const AtomArray &r, const AtomArray &v, double *length, double *rate) {
    rigid::over_all(
        chains, nullptr, [&] { residuals_of_bonds(chains, r, v, length, rate); },
        [&] { rigid::residuals(chains, r, v, length, rate); });
}

}  // namespace holonomic
