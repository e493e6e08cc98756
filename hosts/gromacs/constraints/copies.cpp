#include "copies.hpp"

#include <cmath>
#include <limits>

namespace holonomic {

// Vectors wider than registers are handed over in memory; here functions are inlined, and no other file sees them.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace {

// An atom's vector as one of four numbers: its components are worked on together.
typedef real Four __attribute__((vector_size(4 * sizeof(real))));
typedef decltype(Four{} < Four{}) Flags;

Four read(const real *p) { return Four{p[0], p[1], p[2], 0}; }

// A bond is shorter than half of each side of the box. Of another image at least one component is longer than that, and
// shifts along each vector, the last first, bring it back.
struct Box {
    explicit Box(const t_pbc *pbc) {
        if (pbc == nullptr || pbc->pbcType == PbcType::No) return;
        n = pbc->pbcType == PbcType::XY ? 2 : 3;
        for (int a = 0; a < n; a++) {
            for (int b = 0; b < 3; b++) vectors[a][b] = pbc->box[a][b];
            half[a] = pbc->box[a][a] / 2;
        }
    }
    Flags is_other_image(Four a, Four b) const { return (a - b > half) | (b - a > half); }
    void wrap(double *d) const {
        constexpr double to_integer = 0x1.8p52;  // a sum with it has no bits behind the point
        for (int a = n - 1; a >= 0; a--) {
            const double shift = (d[a] / vectors[a][a] + to_integer) - to_integer;
            for (int b = 0; b < 3; b++) d[b] -= shift * vectors[a][b];
        }
    }
    static constexpr real far = std::numeric_limits<real>::infinity();
    int n = 0;
    double vectors[3][3] = {};
    Four half = {far, far, far, far};
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
        Flags is_cut = {};
        for (int k = start; k < end; k++) {
            const Four here = read(from + 3 * static_cast<ptrdiff_t>(atoms[k]));
            is_cut |= box.is_other_image(here, read(from + 3 * static_cast<ptrdiff_t>(atoms[parents[k]])));
            for (int a = 0; a < 3; a++) to[3 * static_cast<ptrdiff_t>(k) + a] = here[a];
        }
        if (is_cut[0] | is_cut[1] | is_cut[2]) make_whole(arrangement, box, from, to, start, end);
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
