#include "core/violation.hpp"

#include <cmath>

#include "core/caller/box.hpp"
#include "core/caller/view.hpp"
#include "core/kernels/tally.hpp"
#include "core/run/apart.hpp"
#include "core/run/diagnose.hpp"

namespace holonomic {

namespace {

// Calls each(bond, (d.d - a^2) / a^2, d.(v_j - v_i + L d)) for all bonds of a molecule; the last is 0 without v.
template <class Each>
void measure(const Chains &chains, const Molecule &m, const AtomArray &r, const AtomArray &v, const Each &each) {
    const BoxRate *const of_box = v.x ? chains.box_rate() : nullptr;
    double r0[3], v0[3] = {0, 0, 0}, r1[3] = {0, 0, 0}, v1[3] = {0, 0, 0};
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
        each(k, (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - a * a) / (a * a),
             (d[0] * (v1[0] - v0[0]) + d[1] * (v1[1] - v0[1]) + d[2] * (v1[2] - v0[2])) +
                 (of_box ? stretching(*of_box, d) : 0));
    }
}

// Whatever else is wrong with a molecule of the tally, it gives no number.
void throw_if_bad(const Chains &chains, const Tally &tally, const AtomArray &r, const AtomArray &v) {
    if (tally.n_bad == 0) return;
    const NamedArray arrays[] = {{"position", &r}, {"velocity", &v}};
    Error error = diagnose(chains, tally, chains.box, arrays, 2, Status::not_finite);
    error.status = Status::not_finite;
    throw error;
}

}  // namespace

void violation(const Chains &chains, const AtomArray &r, const AtomArray &v, Worst *worst) {
    Worst found{0, -1, -1, 0, -1, -1};
    Tally tally = empty_tally();
    chains.for_active([&](const Molecule &m) {
        bool finite = true;
        measure(chains, m, r, v, [&](std::int64_t k, double off, double change) {
            const double length = std::fabs(off), rate = std::fabs(change);
            finite = finite && std::isfinite(length) && std::isfinite(rate);
            if (found.length_chain < 0 || length > found.length) {
                found.length = length;
                found.length_chain = m.number + chains.base;
                found.length_bond = k + chains.base;
            }
            if (v.x && (found.rate_chain < 0 || rate > found.rate)) {
                found.rate = rate;
                found.rate_chain = m.number + chains.base;
                found.rate_bond = k + chains.base;
            }
        });
        if (!finite) note_bad(m.number, tally);
        return true;
    });
    throw_if_bad(chains, tally, r, v);
    *worst = found;
}

void residuals(const Chains &chains, const AtomArray &r, const AtomArray &v, double *length, double *rate) {
    Tally tally = empty_tally();
    chains.for_active([&](const Molecule &m) {
        bool finite = true;
        measure(chains, m, r, v, [&](std::int64_t, double off, double change) {
            finite = finite && std::isfinite(off) && std::isfinite(change);
        });
        if (!finite) {
            note_bad(m.number, tally);
            return true;
        }
        measure(chains, m, r, v, [&](std::int64_t k, double off, double change) {
            if (length) length[m.bond(k)] = off;
            if (rate) rate[m.bond(k)] = change;
        });
        return true;
    });
    clear_unconstrained(chains, length);
    clear_unconstrained(chains, rate);
    throw_if_bad(chains, tally, r, v);
}

}  // namespace holonomic
