#include "core/run/diagnose.hpp"

#include <cmath>
#include <cstdio>

#include "core/caller/view.hpp"

namespace holonomic {

namespace {

std::int64_t atom_at(const Lane &lane, std::int64_t k) { return lane.atoms ? lane.atoms[k] : lane.first_atom + k; }

bool bond_vector(const AtomArray &r, const Box &box, const Lane &lane, std::int64_t k, double *d) {
    double a[3], b[3];
    read_atom(r, atom_at(lane, k), a);
    read_atom(r, atom_at(lane, k + 1), b);
    for (int c = 0; c < 3; ++c) d[c] = b[c] - a[c];
    minimum_image(box, d);
    return d[0] != 0 || d[1] != 0 || d[2] != 0;
}

// First bond whose pivot vanishes; -1 if none does, -2 if the numbers overflow before.
std::int64_t vanishing_pivot(const AtomArray &r, const Box &box, const Lane &lane) {
    const auto w = [&](std::int64_t k) { return lane.w ? lane.w[k] : lane.w_uniform; };
    double d[3], d1[3];
    bond_vector(r, box, lane, 0, d);
    double q = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], E = w(0) * q;
    for (std::int64_t k = 0; k < lane.n_bonds; ++k) {
        const double P = E + w(k + 1) * q;
        if (!std::isfinite(P)) return -2;
        if (!(P > 0)) return k;
        if (k + 1 == lane.n_bonds) break;
        bond_vector(r, box, lane, k + 1, d1);
        const double q1 = d1[0] * d1[0] + d1[1] * d1[1] + d1[2] * d1[2];
        double X = 0;
        for (int c = 0; c < 3; ++c) {
            const double x = d[(c + 1) % 3] * d1[(c + 2) % 3] - d[(c + 2) % 3] * d1[(c + 1) % 3];
            X += x * x;
        }
        E = w(k + 1) * (q1 * E + w(k + 1) * X) / P;
        q = q1;
        for (int c = 0; c < 3; ++c) d[c] = d1[c];
    }
    return -1;
}

}  // namespace

Error diagnose(const Chains &chains, const Tally &tally, const NamedArray *arrays, int n_arrays, Status otherwise) {
    const Lane lane = chains.lane(tally.first_bad);
    const int base = chains.base;
    const auto number = [base](std::int64_t i) { return static_cast<long long>(i + base); };
    char others[80] = "";
    if (tally.n_bad > 1)
        std::snprintf(others, sizeof others, " (the first of %lld bad chains)", static_cast<long long>(tally.n_bad));
    const auto finish = [&](Error error, std::int64_t bond, std::int64_t atom) {
        error.chain = lane.chain;
        error.bond = bond;
        error.atom = atom;
        error.n_bad = tally.n_bad;
        error.base = base;
        return error;
    };
    const long long chain = number(lane.chain);
    for (int a = 0; a < n_arrays; ++a) {
        if (!arrays[a].array->x) continue;
        for (std::int64_t k = 0; k <= lane.n_bonds; ++k) {
            double x[3];
            const std::int64_t atom = atom_at(lane, k);
            read_atom(*arrays[a].array, atom, x);
            if (std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2])) continue;
            return finish(make_error(Status::not_finite, "chain %lld: the %s of atom %lld is not finite%s", chain,
                                     arrays[a].what, number(atom), others),
                          -1, atom);
        }
    }
    for (std::int64_t k = 0; k < lane.n_bonds; ++k) {
        double d[3];
        if (!bond_vector(*arrays[0].array, chains.box, lane, k, d))
            return finish(
                make_error(Status::degenerate, "chain %lld: bond %lld has length zero%s", chain, number(k), others), k,
                -1);
    }
    const std::int64_t taut = vanishing_pivot(*arrays[0].array, chains.box, lane);
    if (taut >= 0)
        return finish(make_error(Status::degenerate,
                                 "chain %lld: taut between atoms that are held fixed; the tension of bond %lld is not "
                                 "determined%s",
                                 chain, number(taut), others),
                      taut, -1);
    if (taut == -1 && otherwise == Status::no_convergence)
        return finish(make_error(otherwise,
                                 "chain %lld: no corrections along the reference bonds bring the bonds back to their "
                                 "lengths; the step is too large, or a length can't be reached%s",
                                 chain, others),
                      -1, -1);
    return finish(make_error(Status::not_finite, "chain %lld: the numbers overflow or underflow; choose other units%s",
                             chain, others),
                  -1, -1);
}

}  // namespace holonomic
