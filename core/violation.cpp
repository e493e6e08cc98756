#include "core/violation.hpp"

#include <cmath>

#include "core/caller/box.hpp"
#include "core/caller/packed_array.hpp"
#include "core/kernels/tally.hpp"
#include "core/rigid/parts.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/diagnose.hpp"

namespace holonomic {

namespace {

void violation_of_bonds(const Chains &chains, const AtomArray &r, const AtomArray &v, Worst *worst) {
    const BoxRate *const of_box = chains.box_rate();
    Worst found{0, -1, -1, 0, -1, -1};
    Tally tally = empty_tally();
    for (std::int64_t chain = 0; chain < chains.n_chains(); ++chain) {
        if (!chains.is_active(chain)) continue;
        const Molecule m = chains.molecule(chain);
        double r0[3], v0[3] = {0, 0, 0}, r1[3] = {0, 0, 0}, v1[3] = {0, 0, 0};
        bool finite = true;
        for (std::int64_t k = 0; k < m.n_bonds; ++k) {
            if (k > 0 && m.i(k) == m.j(k - 1)) {
                for (int c = 0; c < 3; ++c) {
                    r0[c] = r1[c];
                    v0[c] = v1[c];
                }
            } else {
                read_atom(r, m.atom(m.i(k)), r0);
                if (v.x) read_atom(v, m.atom(m.i(k)), v0);
            }
            read_atom(r, m.atom(m.j(k)), r1);
            if (v.x) read_atom(v, m.atom(m.j(k)), v1);
            const double a = m.length(k);
            double d[3];
            bond_vector(chains.box, r0, r1, d);
            const double length = std::fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - a * a) / (a * a);
            const double rate = std::fabs((d[0] * (v1[0] - v0[0]) + d[1] * (v1[1] - v0[1]) + d[2] * (v1[2] - v0[2])) +
                                          (of_box && v.x ? stretching(*of_box, d) : 0));
            finite = finite && std::isfinite(length) && std::isfinite(rate);
            if (found.length_molecule < 0 || length > found.length) {
                found.length = length;
                found.length_molecule = chain + chains.base;
                found.length_bond = k + chains.base;
            }
            if (v.x && (found.rate_molecule < 0 || rate > found.rate)) {
                found.rate = rate;
                found.rate_molecule = chain + chains.base;
                found.rate_bond = k + chains.base;
            }
        }
        if (!finite) note_bad(chain, tally);
    }
    if (tally.n_bad > 0) {
        Error error = diagnose(chains, tally, chains.box, {{"position", &r}, {"velocity", &v}}, Status::not_finite);
        error.status = Status::not_finite;  // whatever else is wrong with that chain, it gives no number
        throw error;
    }
    *worst = found;
}

}  // namespace

void violation(const Chains &chains, const AtomArray &r, const AtomArray &v, Worst *worst) {
    Worst found{0, -1, -1, 0, -1, -1};
    rigid::over_all(
        chains, nullptr, [&] { violation_of_bonds(chains, r, v, &found); },
        [&] { rigid::violation(chains, r, v, &found); });
    *worst = found;
}

}  // namespace holonomic
