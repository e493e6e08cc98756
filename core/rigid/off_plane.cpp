// Massless sites off the plane of a body's masses: at a height along the normal that its two vectors give,
//
//     r_s = c + y_1 u_1 + y_2 u_2 + z u_1 x u_2
//
// so that, with the force f on it, z u_2 x f comes to u_1 and z f x u_1 to u_2, as the site's virtual work has them. It
// is no sum of masses' coordinates with constant factors: carrying its force adds to the virial.
#include "core/rigid/rates.hpp"

namespace holonomic::rigid {

namespace {

// z of an atom, or null.
const DoublePair *lift_of(const System &system, std::int32_t atom, const Part **part) {
    const MoleculeKind &s = system.kind();
    if (atom >= s.n_held) return nullptr;
    *part = &s.parts[static_cast<std::size_t>(s.part_of[static_cast<std::size_t>(atom)])];
    const Body &its = system.body(**part);
    if (its.z.empty()) return nullptr;
    const DoublePair &z = its.z[static_cast<std::size_t>(atom - (*part)->first_atom)];
    return z.hi == 0 ? nullptr : &z;
}

}  // namespace

PairVector System::position_of(const Conformation &where, std::int32_t atom) const {
    const PairVector view = at_atom(where.q, atom);
    const Part *part;
    const DoublePair *const z = lift_of(*this, atom, &part);
    if (!z) return view;
    const PairVector *const u = where.q + part->first_node + 1;
    return view + *z * cross(u[0], u[1]);
}

// Relative to what flows with the box, as all velocities are.
PairVector System::velocity_of(const Conformation &where, const PairVector *v, const BoxRate *rate,
                               std::int32_t atom) const {
    const PairVector velocity = at_atom(v, atom);
    const Part *part;
    const DoublePair *const z = lift_of(*this, atom, &part);
    if (!z) return velocity;
    const PairVector *const u = where.q + part->first_node + 1, *const w = v + part->first_node + 1;
    const PairVector turn = cross(w[0] + flow(rate, u[0]), u[1]) + cross(u[0], w[1] + flow(rate, u[1]));
    return velocity + *z * (turn - flow(rate, cross(u[0], u[1])));
}

PairVector System::lifted_force(const Part &part, const AtomArray &f, const MoleculeView &view) const {
    const Body &its = body(part);
    PairVector sum = {as_pair(0), as_pair(0), as_pair(0)};
    for (std::int32_t i = 0; i < its.n_atoms; ++i) {
        const DoublePair &z = its.z[static_cast<std::size_t>(i)];
        if (z.hi == 0) continue;
        sum = sum + z * vector_of_atom(f, view.atoms[part.first_atom + i]);
    }
    return sum;
}

void System::carry_to_axes(const Conformation &where, const Part &part, const PairVector &lifted,
                           PairVector *nodes) const {
    const PairVector *const u = where.q + part.first_node + 1;
    PairVector *const to = nodes + part.first_node + 1;
    to[0] = to[0] + cross(u[1], lifted);
    to[1] = to[1] + cross(lifted, u[0]);
}

void System::add_virial_of_sites(const Conformation &where, const AtomArray &f, const MoleculeView &view,
                                 double *virial) const {
    for (const Part &part : s_.parts) {
        if (body(part).z.empty()) continue;
        const PairVector *const u = where.q + part.first_node + 1, lifted = lifted_force(part, f, view);
        const Vector3<double> arm[3] = {rounded(u[0]), rounded(u[1]), rounded(-cross(u[0], u[1]))},
                              force[3] = {rounded(cross(u[1], lifted)), rounded(cross(lifted, u[0])), rounded(lifted)};
        for (int k = 0; k < 3; ++k) {
            const double x[3] = {arm[k].x, arm[k].y, arm[k].z}, y[3] = {force[k].x, force[k].y, force[k].z};
            double *to = virial;
            for (int i = 0; i < 3; ++i)
                for (int j = i; j < 3; ++j) *to++ += 0.5 * (x[i] * y[j] + x[j] * y[i]);
        }
    }
}

}  // namespace holonomic::rigid
