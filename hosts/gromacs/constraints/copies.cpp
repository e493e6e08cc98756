#include "copies.hpp"

#include <limits>

namespace holonomic {

// Vectors wider than registers are handed over in memory; here functions are inlined, and no other file sees them.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace {

// An atom's vector as one of four numbers: its components are worked on together. The fourth is of no meaning: arrays
// of positions are padded, so that it may be read.
typedef real Four __attribute__((vector_size(4 * sizeof(real))));
typedef decltype(Four{} < Four{}) Flags;
typedef Four UnalignedFour __attribute__((aligned(sizeof(real)), may_alias));
typedef real Pair __attribute__((vector_size(2 * sizeof(real)), aligned(sizeof(real)), may_alias));
typedef double DoublePair __attribute__((vector_size(2 * sizeof(double)), aligned(sizeof(double)), may_alias));

Four read(const real *p) { return *reinterpret_cast<const UnalignedFour *>(p); }
void widen(const real *from, double *to) {
    *reinterpret_cast<DoublePair *>(to) = __builtin_convertvector(*reinterpret_cast<const Pair *>(from), DoublePair);
    to[2] = from[2];
}
bool any(const Flags &flags) { return (flags[0] | flags[1] | flags[2]) != 0; }
bool all(const Flags &flags) { return (flags[0] & flags[1] & flags[2]) != 0; }

// A bond is shorter than half of each side of the box. Of another image at least one component is longer than that, and
// shifts along each vector, the last first, bring it back.
struct Box {
    explicit Box(const t_pbc *pbc) {
        if (pbc == nullptr || pbc->pbcType == PbcType::No) return;
        for (int a = 0; a < (pbc->pbcType == PbcType::XY ? 2 : 3); a++) {
            for (int b = 0; b <= a; b++) {
                vectors[a][b] = pbc->box[a][b];
                is_cuboid &= a == b || vectors[a][b] == 0;
            }
            per_side[a] = 1.0 / pbc->box[a][a];
            half_squared[a] = pbc->box[a][a] * pbc->box[a][a] / 4;
        }
    }
    Flags is_other_image(Four d) const { return d * d > half_squared; }
    void wrap(double *d) const {
        constexpr double to_integer = 0x1.8p52;  // a sum with it has no bits behind the point
        const auto sides = [&](int a) { return (d[a] * per_side[a] + to_integer) - to_integer; };
        if (is_cuboid) {
            for (int a = 0; a < 3; a++) d[a] -= sides(a) * vectors[a][a];
            return;
        }
        for (int a = 2; a >= 0; a--) {
            const double shift = sides(a);
            for (int b = 0; b <= a; b++) d[b] -= shift * vectors[a][b];
        }
    }
    static constexpr real far = std::numeric_limits<real>::infinity();
    bool is_cuboid = true;
    double vectors[3][3] = {}, per_side[3] = {};
    Four half_squared = {far, far, far, far};
};

// Calls each(k) for 0 <= k < n; true if it says so of all. One thread begins no team: that takes as long as many
// molecules.
template <typename Each>
bool for_all(int64_t n, int n_threads, const Each &each) {
    bool all_true = true;
    if (n_threads == 1) {
        for (int64_t k = 0; k < n; k++) all_true &= each(k);
        return all_true;
    }
#pragma omp parallel for num_threads(n_threads) schedule(static) reduction(& : all_true)
    for (int64_t k = 0; k < n; k++) all_true &= each(k);
    return all_true;
}

// Calls each(start, end) for all molecules, by their places.
template <typename Each>
bool for_molecules(const Arrangement &arrangement, int n_threads, const Each &each) {
    const int *const starts = arrangement.starts.data();
    return for_all(static_cast<int64_t>(arrangement.starts.size()) - 1, n_threads,
                   [=](int64_t m) { return each(starts[m], starts[m + 1]); });
}

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
    const int *const atoms = arrangement.atoms.data(), *const parents = arrangement.parents.data();
    for_molecules(arrangement, n_threads, [=, &arrangement](int start, int end) {
        Flags is_cut = {};
        for (int k = start; k < end; k++) {
            const real *const here = from + 3 * static_cast<ptrdiff_t>(atoms[k]);
            is_cut |= box.is_other_image(read(here) - read(from + 3 * static_cast<ptrdiff_t>(atoms[parents[k]])));
            widen(here, to + 3 * static_cast<ptrdiff_t>(k));
        }
        if (any(is_cut)) make_whole(arrangement, box, from, to, start, end);
        return true;
    });
}

bool copy_both_whole(const Arrangement &arrangement, const t_pbc *pbc, const real *x, const real *q, double *to_x,
                     double *to_q, double near, int n_threads) {
    const Box box(pbc);
    const int *const atoms = arrangement.atoms.data(), *const parents = arrangement.parents.data();
    const auto square = static_cast<real>(near * near);
    const Four near_squared = {square, square, square, Box::far};
    return for_molecules(arrangement, n_threads, [=, &arrangement](int start, int end) {
        Flags is_cut = {}, is_near = ~is_cut;
        for (int k = start; k < end; k++) {
            const ptrdiff_t i = 3 * static_cast<ptrdiff_t>(atoms[k]);
            const Four before = read(x + i), moved = read(q + i) - before;
            is_cut |= box.is_other_image(before - read(x + 3 * static_cast<ptrdiff_t>(atoms[parents[k]])));
            is_near &= moved * moved <= near_squared;
            widen(x + i, to_x + 3 * static_cast<ptrdiff_t>(k));
            widen(q + i, to_q + 3 * static_cast<ptrdiff_t>(k));
        }
        const bool all_near = all(is_near);
        if (!all_near || any(is_cut)) {
            make_whole(arrangement, box, x, to_x, start, end);
            if (!all_near) {
                make_whole(arrangement, box, q, to_q, start, end);
            } else {
                for (int k = start; k < end; k++)  // as from the atom's image in x
                    for (int a = 0; a < 3; a++) {
                        const ptrdiff_t i = 3 * static_cast<ptrdiff_t>(atoms[k]) + a;
                        const ptrdiff_t place = 3 * static_cast<ptrdiff_t>(k) + a;
                        to_q[place] = to_x[place] + (double(q[i]) - double(x[i]));
                    }
            }
        }
        return all_near;
    });
}

void copy(const Arrangement &arrangement, const real *from, double *to, int n_threads) {
    const int *const atoms = arrangement.atoms.data();
    for_all(static_cast<int64_t>(arrangement.atoms.size()), n_threads, [=](int64_t k) {
        for (int a = 0; a < 3; a++) to[3 * k + a] = from[3 * static_cast<ptrdiff_t>(atoms[k]) + a];
        return true;
    });
}

bool move(const Arrangement &arrangement, const double *d, double inverse_dt, real *q, real *v, double near,
          int n_threads) {
    const int *const atoms = arrangement.atoms.data();
    return for_all(static_cast<int64_t>(arrangement.atoms.size()), n_threads, [=](int64_t k) {
        const double x = d[3 * k], y = d[3 * k + 1], z = d[3 * k + 2];
        real *const here = q + 3 * static_cast<ptrdiff_t>(atoms[k]);
        here[0] = static_cast<real>(here[0] + x);
        here[1] = static_cast<real>(here[1] + y);
        here[2] = static_cast<real>(here[2] + z);
        if (v != nullptr) {
            real *const velocity = v + 3 * static_cast<ptrdiff_t>(atoms[k]);
            velocity[0] = static_cast<real>(velocity[0] + inverse_dt * x);
            velocity[1] = static_cast<real>(velocity[1] + inverse_dt * y);
            velocity[2] = static_cast<real>(velocity[2] + inverse_dt * z);
        }
        return x * x + y * y + z * z <= near * near;
    });
}

void hand_back(const Arrangement &arrangement, const double *p, const real *q, real *projected, int n_threads) {
    const int *const atoms = arrangement.atoms.data();
    for_all(static_cast<int64_t>(arrangement.atoms.size()), n_threads, [=](int64_t k) {
        for (int a = 0; a < 3; a++) {
            const ptrdiff_t i = 3 * static_cast<ptrdiff_t>(atoms[k]) + a;
            projected[i] = static_cast<real>(projected == q ? p[3 * k + a] : projected[i] + (p[3 * k + a] - q[i]));
        }
        return true;
    });
}

}  // namespace holonomic
