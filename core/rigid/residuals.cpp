// What is left of each bond of molecules with bodies, between the atoms as they are.
#include <cmath>

#include "core/caller/box.hpp"
#include "core/residuals.hpp"
#include "core/rigid/run.hpp"
#include "core/rigid/verbs.hpp"

namespace holonomic::rigid {

namespace {

struct BodyResiduals final : BodyWork {
    AtomArray r, v;
    const Cell &box;
    const BoxRate *box_rate;
    double *length, *rate;

    BodyResiduals(const Chains &chains, const AtomArray &r_, const AtomArray &v_, double *length_, double *rate_)
        : BodyWork(chains), r(r_), v(v_), box(chains.box), box_rate(chains.box_rate()), length(length_), rate(rate_) {}

    void place_bond(const MoleculeKind &kind, const MoleculeView &view, std::size_t k, const double (&x)[2][3],
                    double *d) const {
        if (!kind.has_images || box.lattice == Box::none) return holonomic::bond_vector(box, x[0], x[1], d);
        const Vector3<double> image = rounded(told_image(box, view, k));
        d[0] = x[1][0] - x[0][0] + image.x, d[1] = x[1][1] - x[0][1] + image.y, d[2] = x[1][2] - x[0][2] + image.z;
    }
    Residual residual_of(const MoleculeKind &kind, const MoleculeView &view, std::size_t k) const {
        const Bond &bond = kind.bonds[k];
        double x[2][3], u[2][3] = {}, d[3];
        const std::int32_t ends[2] = {bond.i, bond.j};
        for (int end = 0; end < 2; ++end) {
            read_atom(r, view.atoms[ends[end]], x[end]);
            if (v.x) read_atom(v, view.atoms[ends[end]], u[end]);
        }
        place_bond(kind, view, k, x, d);
        return holonomic::residual_of(d, u[0], u[1], bond.length, v.x ? box_rate : nullptr);
    }

    Outcome molecule(const System &system, const MoleculeView &view, Tally &) const override {
        const MoleculeKind &kind = system.kind();
        for (std::size_t k = 0; k < kind.bonds.size(); ++k) {
            const Residual left = residual_of(kind, view, k);
            if (!std::isfinite(left.length) || !std::isfinite(left.rate)) return Outcome::not_finite;
        }
        for (std::size_t k = 0; k < kind.bonds.size(); ++k) {
            const Residual left = residual_of(kind, view, k);
            if (length) length[view.bonds[k]] = left.length;
            if (rate) rate[view.bonds[k]] = left.rate;
        }
        return Outcome::good;
    }
};

}  // namespace

void residuals(const Chains &chains, const AtomArray &r, const AtomArray &v, double *length, double *rate) {
    run_all(chains, BodyResiduals(chains, r, v, length, rate), {{"position", &r}, {"velocity", &v}}, nullptr);
}

}  // namespace holonomic::rigid
