#include "copies.hpp"

#include <cmath>
#include <limits>

namespace holonomic {

namespace {

// A bond is shorter than half of each side of the box. Of another image at least one component is longer than that, and
// one shift along each vector, the last first, brings it back.
struct Box {
    explicit Box(const t_pbc *pbc) {
        if (pbc == nullptr || pbc->pbcType == PbcType::No) return;
        n = pbc->pbcType == PbcType::XY ? 2 : 3;
        for (int a = 0; a < n; a++) {
            for (int b = 0; b < 3; b++) vectors[a][b] = pbc->box[a][b];
            half[a] = pbc->box[a][a] / 2;
        }
    }
    // A sum in place of "or": three comparisons without a branch.
    bool is_other_image(const real *a, const real *b) const {
        return int(std::fabs(a[0] - b[0]) > half[0]) + int(std::fabs(a[1] - b[1]) > half[1]) +
                   int(std::fabs(a[2] - b[2]) > half[2]) !=
               0;
    }
    void wrap(double *d) const {
        for (int a = n - 1; a >= 0; a--) {
            const double shift = std::rint(d[a] / vectors[a][a]);
            for (int b = 0; b < 3; b++) d[b] -= shift * vectors[a][b];
        }
    }
    int n = 0;
    double vectors[3][3] = {};
    real half[3] = {std::numeric_limits<real>::infinity(), std::numeric_limits<real>::infinity(),
                    std::numeric_limits<real>::infinity()};
};

// A molecule that a face of the box cuts.
void make_whole(const Arrangement &arrangement, const Box &box, const real *from, double *to, int start, int end) {
    for (int k = start + 1; k < end; k++) {
        const int parent = arrangement.parents[k];
        const real *const here = from + 3 * static_cast<ptrdiff_t>(arrangement.atoms[k]);
        const real *const there = from + 3 * static_cast<ptrdiff_t>(arrangement.atoms[parent]);
        double d[3] = {double(here[0]) - there[0], double(here[1]) - there[1], double(here[2]) - there[2]};
        box.wrap(d);
        for (int a = 0; a < 3; a++)
            to[3 * static_cast<ptrdiff_t>(k) + a] = to[3 * static_cast<ptrdiff_t>(parent) + a] + d[a];
    }
}

}  // namespace

void copy_whole(const Arrangement &arrangement, const t_pbc *pbc, const real *from, double *to, int n_threads) {
    const Box box(pbc);
    const auto n_molecules = static_cast<int64_t>(arrangement.starts.size()) - 1;
    const int *const atoms = arrangement.atoms.data(), *const parents = arrangement.parents.data();
#pragma omp parallel for num_threads(n_threads) schedule(static) if (n_threads > 1)
    for (int64_t m = 0; m < n_molecules; m++) {
        const int start = arrangement.starts[m], end = arrangement.starts[m + 1];
        bool is_cut = false;
        for (int k = start; k < end; k++) {
            const real *const here = from + 3 * static_cast<ptrdiff_t>(atoms[k]);
            is_cut |= box.is_other_image(here, from + 3 * static_cast<ptrdiff_t>(atoms[parents[k]]));
            double *const place = to + 3 * static_cast<ptrdiff_t>(k);
            place[0] = here[0];
            place[1] = here[1];
            place[2] = here[2];
        }
        if (is_cut) make_whole(arrangement, box, from, to, start, end);
    }
}

void copy(const Arrangement &arrangement, const real *from, double *to, int n_threads) {
    const auto n = static_cast<int64_t>(arrangement.atoms.size());
    const int *const atoms = arrangement.atoms.data();
#pragma omp parallel for num_threads(n_threads) schedule(static) if (n_threads > 1)
    for (int64_t k = 0; k < n; k++)
        for (int a = 0; a < 3; a++) to[3 * k + a] = from[3 * static_cast<ptrdiff_t>(atoms[k]) + a];
}

void move(const Arrangement &arrangement, const double *d, double inverse_dt, real *q, real *v, int n_threads) {
    const auto n = static_cast<int64_t>(arrangement.atoms.size());
    const int *const atoms = arrangement.atoms.data();
#pragma omp parallel for num_threads(n_threads) schedule(static) if (n_threads > 1)
    for (int64_t k = 0; k < n; k++) {
        const double x = d[3 * k], y = d[3 * k + 1], z = d[3 * k + 2];
        real *const here = q + 3 * static_cast<ptrdiff_t>(atoms[k]);
        here[0] = static_cast<real>(here[0] + x);
        here[1] = static_cast<real>(here[1] + y);
        here[2] = static_cast<real>(here[2] + z);
        if (v == nullptr) continue;
        real *const velocity = v + 3 * static_cast<ptrdiff_t>(atoms[k]);
        velocity[0] = static_cast<real>(velocity[0] + inverse_dt * x);
        velocity[1] = static_cast<real>(velocity[1] + inverse_dt * y);
        velocity[2] = static_cast<real>(velocity[2] + inverse_dt * z);
    }
}

void hand_back(const Arrangement &arrangement, const double *p, const real *q, real *projected, int n_threads) {
    const auto n = static_cast<int64_t>(arrangement.atoms.size());
    const int *const atoms = arrangement.atoms.data();
#pragma omp parallel for num_threads(n_threads) schedule(static) if (n_threads > 1)
    for (int64_t k = 0; k < n; k++)
        for (int a = 0; a < 3; a++) {
            const ptrdiff_t i = 3 * static_cast<ptrdiff_t>(atoms[k]) + a;
            projected[i] = static_cast<real>(projected == q ? p[3 * k + a] : projected[i] + (p[3 * k + a] - q[i]));
        }
}

}  // namespace holonomic
