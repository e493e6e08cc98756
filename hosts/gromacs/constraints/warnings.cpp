// What GROMACS tells of constraints: how far they are off, and bonds that turned by more than an angle in one step.
#include <climits>
#include <cmath>
#include <cinttypes>

#include "rank.hpp"

namespace holonomic {

namespace {

struct Vector {
    double x, y, z;
};
double dot(const Vector &a, const Vector &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// A bond is shorter than half the box, so that one shift along each vector is enough.
struct Images {
    explicit Images(const t_pbc *of) : periodic(of != nullptr && of->pbcType != PbcType::No), pbc(of) {
        if (periodic) n = pbc->pbcType == PbcType::XY ? 2 : 3;
    }
    void wrap(Vector &d) const {
        for (int a = n - 1; a >= 0; a--) {
            const double side = pbc->box[a][a];
            const double shift = std::rint((a == 2 ? d.z : a == 1 ? d.y : d.x) / side);
            d.x -= shift * pbc->box[a][0];
            d.y -= shift * pbc->box[a][1];
            d.z -= shift * pbc->box[a][2];
        }
    }
    bool periodic;
    const t_pbc *pbc;
    int n = 0;
};

Vector bond(const real *q, int i, int j) {
    const real *const a = q + 3 * static_cast<ptrdiff_t>(i), *const b = q + 3 * static_cast<ptrdiff_t>(j);
    return {double(b[0]) - a[0], double(b[1]) - a[1], double(b[2]) - a[2]};
}

template <bool periodic>
bool any_turned(const Molecules &molecules, const Call &call, const Images &images, double cosine) {
    for (size_t k = 0; k < molecules.n_bonds(); k++) {
        const int i = molecules.first_atom(k), j = molecules.second_atom(k);
        Vector before = bond(call.x, i, j), after = bond(call.q, i, j);
        if (periodic) {
            images.wrap(before);
            images.wrap(after);
        }
        const double length = molecules.length(k);
        if (!(dot(before, after) >= cosine * length * length)) return true;
    }
    return false;
}

double warning_cosine(const Call &call) { return std::cos(call.parameters.LincsWarnAngle * M_PI / 180); }

void tell_turned(const Molecules &molecules, const Call &call) {
    const Images images(call.pbc);
    const double cosine = warning_cosine(call);
    fprintf(stderr,
            "bonds that rotated more than %g degrees:\n atom 1 atom 2  angle  previous, current, constraint length\n",
            double(call.parameters.LincsWarnAngle));
    for (size_t k = 0; k < molecules.n_bonds(); k++) {
        const int i = molecules.first_atom(k), j = molecules.second_atom(k);
        Vector before = bond(call.x, i, j), after = bond(call.q, i, j);
        images.wrap(before);
        images.wrap(after);
        const double length_before = std::sqrt(dot(before, before)), length_after = std::sqrt(dot(after, after));
        const double turned = dot(before, after) / (length_before * length_after);
        if (turned >= cosine) continue;
        fprintf(stderr, " %6d %6d  %5.1f  %8.4f %8.4f    %8.4f\n", ddglatnr(domain, i), ddglatnr(domain, j),
                std::acos(turned) * 180 / M_PI, length_before, length_after, molecules.length(k));
        if (!std::isfinite(length_after)) gmx_fatal(0, __FILE__, __LINE__, "Bond length not finite.");
        ++*call.n_warnings;
    }
}

}  // namespace

Deviation deviation(const Molecules &molecules, real *q) {
    Deviation result;
    if (molecules.chains() == nullptr) return result;
    std::vector<double> off(molecules.n_bonds(), 0);
    const hol_view view_of_q = view(q);
    hol_residuals_view(molecules.chains(), &view_of_q, nullptr, off.data(), nullptr);
    for (size_t k = 0; k < off.size(); k++) {
        const double d = std::fabs(std::sqrt(1 + off[k]) - 1);
        result.sum_of_squares += d * d;
        if (d > result.largest) {
            result.largest = d;
            result.bond = k;
        }
    }
    return result;
}

bool any_turned(const Molecules &molecules, const Call &call) {
    const Images images(call.pbc);
    return images.periodic ? any_turned<true>(molecules, call, images, warning_cosine(call))
                           : any_turned<false>(molecules, call, images, warning_cosine(call));
}

void warn(Molecules &molecules, const Call &call, int status) {
    const Deviation left = deviation(molecules, call.q);
    fprintf(stderr,
            "\nStep %" PRId64 ", time %g (ps)  CONSTRAINT WARNING\n"
            "relative constraint deviation: rms %.6f, max %.6f (between atoms %d and %d)\n",
            call.step, double(call.parameters.init_t + call.step * call.parameters.delta_t),
            std::sqrt(left.sum_of_squares / static_cast<double>(molecules.n_bonds())), left.largest,
            ddglatnr(domain, molecules.first_atom(left.bond)), ddglatnr(domain, molecules.second_atom(left.bond)));
    if (status != HOL_OK) {
        int64_t n_bad = 0;
        hol_error_location(nullptr, nullptr, nullptr, &n_bad);
        if (domain != nullptr) {  // once more, for the numbers of the topology; what was solved stays
            molecules.set_labels(domain);
            const hol_view x = view(call.x), q = view(call.q);
            hol_project_positions_view(molecules.chains(), &x, &q, nullptr, 1, nullptr, 0, nullptr, nullptr);
        }
        fprintf(stderr, "%" PRId64 " molecule%s could not be solved: %s\n", n_bad, n_bad == 1 ? "" : "s",
                hol_error_message());
        *call.n_warnings += static_cast<int>(n_bad);
    }
    tell_turned(molecules, call);
    if (*call.n_warnings > call.max_warnings)
        gmx::too_many_constraint_warnings(ConstraintAlgorithm::Lincs, *call.n_warnings);
}

}  // namespace holonomic
