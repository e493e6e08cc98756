#include "core/rigid/within.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace holonomic::rigid {

namespace {

void add_pull(double *force, const Bond &bond, double t, const Vector3<double> &d) {
    const double pull[3] = {t * d.x, t * d.y, t * d.z};
    for (int c = 0; c < 3; ++c) {
        force[3 * bond.i + c] += pull[c];
        force[3 * bond.j + c] -= pull[c];
    }
}

// Least squares by conjugate gradients, which begin at zero and stay in the span of the rows: so the norm is the least.
class Sharing {
public:
    Sharing(const System &system, const Conformation &where)
        : system_(system), s_(system.kind()), where_(where), n_bonds_(s_.bonds.size()), t_(system.within),
          force_(force_within(system)), along_(force_ + 3 * std::ptrdiff_t{s_.n_held}), slope_(t_ + n_bonds_),
          direction_(slope_ + n_bonds_) {}

    void run() {
        std::fill(t_, t_ + n_bonds_, 0.0);
        double before = descend(), size = 0;
        for (std::int32_t i = 0; i < 3 * s_.n_held; ++i) size += force_[i] * force_[i];
        std::copy(slope_, slope_ + n_bonds_, direction_);
        const double enough = 0.01 * std::numeric_limits<double>::epsilon() * size * reach();
        for (int step = 0; step < 50 + 12 * s_.n_held && before > enough * std::numeric_limits<double>::epsilon();
             ++step) {
            std::fill(along_, along_ + 3 * std::ptrdiff_t{s_.n_held}, 0.0);
            for_each([&](std::size_t k, const Bond &bond, const Vector3<double> &d) {
                add_pull(along_, bond, direction_[k], d);
            });
            double square = 0;
            for (std::int32_t i = 0; i < 3 * s_.n_held; ++i) square += along_[i] * along_[i];
            if (!(square > 0)) break;
            const double length = before / square;
            for_each([&](std::size_t k, const Bond &, const Vector3<double> &) { t_[k] += length * direction_[k]; });
            for (std::int32_t i = 0; i < 3 * s_.n_held; ++i) force_[i] -= length * along_[i];
            const double now = descend();
            for_each([&](std::size_t k, const Bond &, const Vector3<double> &) {
                direction_[k] = slope_[k] + now / before * direction_[k];
            });
            before = now;
        }
    }

private:
    template <class Each>
    void for_each(const Each &each) const {
        for (std::size_t k = 0; k < n_bonds_; ++k)
            if (s_.bonds[k].row < 0) each(k, s_.bonds[k], vector_of(system_, where_, k));
    }
    double reach() const {
        double sum = 0;
        for_each([&](std::size_t, const Bond &bond, const Vector3<double> &) { sum += 2 * bond.length * bond.length; });
        return sum;
    }
    // Which way each multiplier makes what is left of the forces less; its square.
    double descend() const {
        double square = 0;
        for_each([&](std::size_t k, const Bond &bond, const Vector3<double> &d) {
            const double *const a = force_ + 3 * std::ptrdiff_t{bond.i}, *const b = force_ + 3 * std::ptrdiff_t{bond.j};
            slope_[k] = (a[0] - b[0]) * d.x + (a[1] - b[1]) * d.y + (a[2] - b[2]) * d.z;
            square += slope_[k] * slope_[k];
        });
        return square;
    }

    const System &system_;
    const MoleculeKind &s_;
    const Conformation &where_;
    const std::size_t n_bonds_;
    double *const t_, *const force_, *const along_, *const slope_, *const direction_;
};

}  // namespace

void share_within(const System &system, const Conformation &where) {
    const MoleculeKind &s = system.kind();
    double *const force = force_within(system);
    for (std::size_t k = 0; k < s.bonds.size(); ++k) {
        const Bond &bond = s.bonds[k];
        if (bond.row < 0) continue;
        const Vector3<double> d = vector_of(system, where, k);
        const double t = rounded(system.t[bond.row]), pull[3] = {t * d.x, t * d.y, t * d.z};
        for (int c = 0; c < 3; ++c) {
            if (bond.i < s.n_held) force[3 * bond.i + c] -= pull[c];
            if (bond.j < s.n_held) force[3 * bond.j + c] += pull[c];
        }
    }
    Sharing(system, where).run();
}

}  // namespace holonomic::rigid
