#include "core/reactions.hpp"

#include <algorithm>
#include <cmath>

#include "core/caller/box.hpp"
#include "core/caller/packed_array.hpp"
#include "core/rigid/parts.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/execute.hpp"
#include "core/run/lane.hpp"
#include "core/run/staging.hpp"

namespace holonomic {

namespace {

struct Call {
    AtomArray r, g;
    const double *given;
    double *lambda, *tension, *bond_virial;
    bool add, virial;
    const Box *box;
};

// A bond's vector d, 2 lambda, and the pull 2 lambda d.
struct BondPull {
    double d[3], t, p[3];
};

struct Vector {
    double x[3];
};

inline Vector read(const AtomArray &array, std::int64_t atom) {
    Vector a;
    read_atom(array, atom, a.x);
    return a;
}

inline BondPull pull_of(const Call &call, const Vector &ri, const Vector &rj, std::int64_t bond) {
    BondPull x;
    bond_vector(*call.box, ri.x, rj.x, x.d);
    x.t = 2 * call.given[bond];
    for (int c = 0; c < 3; ++c) x.p[c] = x.t * x.d[c];
    return x;
}

inline double length_of(const BondPull &x) { return std::sqrt(x.d[0] * x.d[0] + x.d[1] * x.d[1] + x.d[2] * x.d[2]); }

// xx xy xz yy yz zz of - t d (x) d; zeros as +0.
inline void virial_of(const BondPull &x, double *w) {
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b) *w++ = 0 - x.p[a] * x.d[b];
}

// Not finite if anything of the bond is not, or if its virial or twice the force would overflow.
inline double size_of(const BondPull &x) {
    double force = 0, length = 0;
    for (int c = 0; c < 3; ++c) {
        force += std::fabs(x.p[c]);
        length += std::fabs(x.d[c]);
    }
    return 4 * force + force * length + length;
}

inline void write_bond(const Call &call, const BondPull &x, std::int64_t bond, Tally &tally) {
    if (call.lambda) call.lambda[bond] = call.given[bond];
    if (call.tension) call.tension[bond] = x.t * length_of(x);
    double w[6];
    if (call.bond_virial || call.virial) virial_of(x, w);
    if (call.bond_virial) std::copy(w, w + 6, call.bond_virial + 6 * bond);
    for (int c = 0; call.virial && c < 6; ++c) tally.virial[c] += w[c];
}

inline void write_force(const Call &call, std::int64_t atom, Vector force) {
    if (call.add) {
        const Vector before = read(call.g, atom);
        for (int c = 0; c < 3; ++c) force.x[c] = before.x[c] + force.x[c];
    }
    write_atom(call.g, atom, force.x);
}

// Calls each(k, pull) for the bonds begin .. end - 1 of a chain.
template <class Each>
void along(const Call &call, const Lane &lane, std::int64_t begin, std::int64_t end, Each each) {
    Vector r0 = read(call.r, atom_of(lane, begin));
    for (std::int64_t k = begin; k < end; ++k) {
        const Vector r1 = read(call.r, atom_of(lane, k + 1));
        each(k, pull_of(call, r0, r1, lane.first_bond + k));
        r0 = r1;
    }
}

bool is_finite(const Call &call, const Lane &lane, std::int64_t begin, std::int64_t end) {
    double size = 0;
    along(call, lane, begin, end, [&](std::int64_t, const BondPull &x) { size += size_of(x); });
    return std::isfinite(size);
}

// The bonds begin .. end - 1, and the atoms begin .. end - 1, behind the last bond also the last atom.
void write_chain(const Call &call, const Lane &lane, std::int64_t begin, std::int64_t end, Tally &tally) {
    Vector before{};
    if (begin > 0)
        along(call, lane, begin - 1, begin, [&](std::int64_t, const BondPull &x) {
            before = {{x.p[0], x.p[1], x.p[2]}};
        });
    along(call, lane, begin, end, [&](std::int64_t k, const BondPull &x) {
        write_bond(call, x, lane.first_bond + k, tally);
        if (!call.g.x) return;
        write_force(call, atom_of(lane, k), {{x.p[0] - before.x[0], x.p[1] - before.x[1], x.p[2] - before.x[2]}});
        before = {{x.p[0], x.p[1], x.p[2]}};
    });
    if (!call.g.x || end < lane.n_bonds) return;
    write_force(call, atom_of(lane, end), {{0 - before.x[0], 0 - before.x[1], 0 - before.x[2]}});
}

template <class Each>
void over_bonds(const Call &call, const EliminationPlan &shape, const MoleculeLane &lane, Each each) {
    for (std::int32_t k = 0; k < shape.n_bonds; ++k) {
        const Vector ri = read(call.r, atom_of(lane, shape.atom_i[k])),
                     rj = read(call.r, atom_of(lane, shape.atom_j[k]));
        each(k, pull_of(call, ri, rj, lane.first_bond + k));
    }
}

// `force` [n_atoms][3]
void write_molecule(const Call &call, const EliminationPlan &shape, const MoleculeLane &lane, double *force,
                    Tally &tally) {
    if (call.g.x) std::fill_n(force, 3 * std::ptrdiff_t{shape.n_atoms}, 0.0);
    over_bonds(call, shape, lane, [&](std::int32_t k, const BondPull &x) {
        write_bond(call, x, lane.first_bond + k, tally);
        if (!call.g.x) return;
        double *const i = force + 3 * std::ptrdiff_t{shape.atom_i[k]};
        double *const j = force + 3 * std::ptrdiff_t{shape.atom_j[k]};
        for (int c = 0; c < 3; ++c) {
            i[c] += x.p[c];
            j[c] -= x.p[c];
        }
    });
    for (std::int32_t i = 0; call.g.x && i < shape.n_atoms; ++i)
        write_force(call, atom_of(lane, i), {{force[3 * i], force[3 * i + 1], force[3 * i + 2]}});
}

struct ReactionsWork final : Work {
    static constexpr std::int64_t block = 4096;  // bonds of a long chain that a thread takes at a time
    const Variants<Call> calls;
    ReactionsWork(const Call &call, Staging &staging)
        : calls(
              call, staging,
              [&](Call &c) {
                  c.given = staging.inputs(call.given);
                  c.lambda = staging.results(call.lambda);
                  c.tension = staging.results(call.tension);
                  c.bond_virial = staging.results(call.bond_virial, 6);
              },
              [&](Call &c) {
                  c.r = staging.atoms(call.r);
                  c.g = staging.summed_atoms(call.g, call.add);
              }) {}
    void unit(const Unit &unit, int where, double *, Tally &tally) const override {
        const Call &call = calls[where];
        for (std::int64_t i = 0; i < unit.count; ++i) {
            const Lane lane = lane_of(unit, i);
            if (is_finite(call, lane, 0, lane.n_bonds))
                write_chain(call, lane, 0, lane.n_bonds, tally);
            else
                note_bad(lane.chain, tally);
        }
    }
    void unit(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const override {
        const Call &call = calls[where];
        for (std::int64_t i = 0; i < unit.count; ++i) {
            const MoleculeLane lane = lane_of(unit, i);
            double size = 0;
            over_bonds(call, *unit.elimination, lane, [&](std::int32_t, const BondPull &x) { size += size_of(x); });
            if (std::isfinite(size))
                write_molecule(call, *unit.elimination, lane, scratch, tally);
            else
                note_bad(lane.molecule, tally);
        }
    }
    std::int64_t long_blocks(std::int64_t n) const override { return (n + block - 1) / block; }
    std::int64_t long_bytes(std::int64_t) const override { return 0; }
    void long_chain(const Lane &lane, int where, const Team &team, double *, Tally &tally) const override {
        const Call &call = calls[where];
        Tally found = empty_tally();
        const auto end_of = [&](std::int64_t j) { return std::min((j + 1) * block, lane.n_bonds); };
        team.for_each(long_blocks(lane.n_bonds), found, [&](std::int64_t j, double *, Tally &part) {
            if (!is_finite(call, lane, j * block, end_of(j))) note_bad(lane.chain, part);
        });
        if (found.n_bad > 0) return note_bad(lane.chain, tally);
        team.for_each(long_blocks(lane.n_bonds), tally, [&](std::int64_t j, double *, Tally &part) {
            write_chain(call, lane, j * block, end_of(j), part);
        });
    }
};

}  // namespace

Tally react(const Chains &chains, const AtomArray &r, const Cell &box, const double *lambda, const Reactions &out) {
    const Call call{r, out.g, lambda, out.lambda, out.tension, out.bond_virial, out.add, out.virial, &box};
    Staging staging(chains, 6);
    const Tally tally = execute(chains, ReactionsWork(call, staging));
    staging.put_back();
    clear_unconstrained(chains, out.lambda);
    clear_unconstrained(chains, out.tension);
    clear_unconstrained(chains, out.bond_virial, 6);
    return tally;
}

namespace {

void reactions_of_bonds(const Chains &chains, const AtomArray &r, const Cell &box, const double *lambda, Reactions out,
                        double *virial) {
    out.virial = virial != nullptr;
    const Tally tally = react(chains, r, box, lambda, out);
    if (tally.n_bad > 0) {
        check_values(chains, tally, lambda, "multiplier");
        throw diagnose(chains, tally, box, {{"position", &r}}, Status::not_finite);
    }
    if (virial) write_virial(tally, virial);
}

}  // namespace

void reactions(const Chains &chains, const AtomArray &r, const Cell &box, const double *lambda, Reactions out,
               double *virial) {
    out.virial = virial != nullptr;
    rigid::over_all(
        chains, out.add ? nullptr : &out.g, virial,
        [&](double *to) { reactions_of_bonds(chains, r, box, lambda, out, to); },
        [&](double *to) { rigid::reactions(chains, r, box, lambda, out, to); });
}

}  // namespace holonomic
