// What GROMACS tells of constraints: how far they are off, and bonds that turned by more than an angle in one step.
#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstring>

#include "copies.hpp"
#include "rank.hpp"

namespace holonomic {

namespace {

struct Vector {
    double x, y, z;
};

double dot(const Vector &a, const Vector &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

Vector along(const Bond &bond, const double *q) {
    const double *const i = q + 3 * bond.first, *const j = q + 3 * bond.second;
    return {j[0] - i[0], j[1] - i[1], j[2] - i[2]};
}

double warning_cosine(const Call &call) { return std::cos(call.parameters.LincsWarnAngle * M_PI / 180); }

void tell_turned(const Molecules &molecules, const Call &call, const double *x, const double *q) {
    const double cosine = warning_cosine(call);
    fprintf(stderr,
            "bonds that rotated more than %g degrees:\n atom 1 atom 2  angle  previous, current, constraint length\n",
            double(call.parameters.LincsWarnAngle));
    for (size_t k = 0; k < molecules.n_bonds(); k++) {
        const Bond &bond = molecules.places().bonds[k];
        const Vector before = along(bond, x), after = along(bond, q);
        const double length_before = std::sqrt(dot(before, before)), length_after = std::sqrt(dot(after, after));
        const double turned = dot(before, after) / (length_before * length_after);
        if (turned >= cosine) continue;
        fprintf(stderr, " %6d %6d  %5.1f  %8.4f %8.4f    %8.4f\n", molecules.number(bond.first),
                molecules.number(bond.second), std::acos(turned) * 180 / M_PI, length_before, length_after,
                molecules.length(k));
        if (!std::isfinite(length_after)) gmx_fatal(0, __FILE__, __LINE__, "Bond length not finite.");
        ++*call.n_warnings;
    }
}

}  // namespace

Deviation deviation(const Molecules &molecules, const t_pbc *pbc, const real *q) {
    Deviation result;
    if (molecules.chains() == nullptr) return result;
    std::vector<double> whole(3 * molecules.n_atoms());
    copy_whole(molecules.places(), pbc, q, whole.data(), molecules.n_threads());
    for (size_t k = 0; k < molecules.n_bonds(); k++) {
        const Vector d = along(molecules.places().bonds[k], whole.data());
        const double off = std::fabs(std::sqrt(dot(d, d)) / molecules.length(k) - 1);
        result.n_bonds += molecules.share(k);
        result.sum_of_squares += molecules.share(k) * off * off;
        if (off > result.largest) {
            result.largest = off;
            result.bond = k;
        }
    }
    return result;
}

// Turning by that angle takes a chord, of which each end has moved by half.
double no_turn(const Molecules &molecules, const Call &call) {
    const double cosine = warning_cosine(call);
    return 0.99 * std::sqrt(std::max(0.0, 2 - 2 * cosine)) / 2 * molecules.shortest();
}

bool any_turned(const Molecules &molecules, const Call &call, const double *x, const double *q) {
    const double cosine = warning_cosine(call);
    const std::vector<Bond> &bonds = molecules.places().bonds;
    bool any = false;
    for (size_t k = 0; k < bonds.size(); k++) {
        const double length = molecules.length(k);
        any |= !(dot(along(bonds[k], x), along(bonds[k], q)) >= cosine * length * length);
    }
    return any;
}

void warn(const Molecules &molecules, const Call &call, const std::string &words, int64_t n_unsolved, const double *x,
          const double *q) {
    const Deviation left = deviation(molecules, call.pbc, call.q);
    const Bond &worst = molecules.places().bonds[left.bond];
    fprintf(stderr,
            "\nStep %" PRId64
            ", time %g (ps)  CONSTRAINT WARNING\n"
            "relative constraint deviation: rms %.6f, max %.6f (between atoms %d and %d)\n",
            call.step, double(call.parameters.init_t + call.step * call.parameters.delta_t),
            std::sqrt(left.sum_of_squares / left.n_bonds), left.largest, molecules.number(worst.first),
            molecules.number(worst.second));
    if (n_unsolved > 0)
        fprintf(stderr, "%" PRId64 " molecule%s could not be solved: %s\n", n_unsolved, n_unsolved == 1 ? "" : "s",
                words.c_str());
    *call.n_warnings += static_cast<int>(n_unsolved);
    tell_turned(molecules, call, x, q);
    if (*call.n_warnings > call.max_warnings)
        gmx::too_many_constraint_warnings(ConstraintAlgorithm::Lincs, *call.n_warnings);
}

}  // namespace holonomic
