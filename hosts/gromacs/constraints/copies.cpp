#include "copies.hpp"

#include <limits>
#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace holonomic {

// Vectors wider than registers are handed over in memory; here functions are inlined, and no other file sees them.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace {

// An atom's vector as one of four numbers: its components are worked on together. The fourth is of no meaning: arrays
// of positions are padded, so that it may be read.
typedef real Four __attribute__((vector_size(4 * sizeof(real))));
typedef decltype(Four{} < Four{}) Flags;
typedef Four UnalignedFour __attribute__((aligned(sizeof(real)), may_alias));
typedef double DoublePair __attribute__((vector_size(2 * sizeof(double)), aligned(sizeof(double)), may_alias));

Four read(const real *p) { return *reinterpret_cast<const UnalignedFour *>(p); }
#if defined(__SSE2__) && !GMX_DOUBLE
// What gcc makes of the other form converts one by one.
Four pair_at(const real *p) { return _mm_loadl_pi(Four{}, reinterpret_cast<const __m64 *>(p)); }
DoublePair low_of(Four a) { return _mm_cvtps_pd(a); }
double third_of(Four a) { return _mm_cvtsd_f64(_mm_cvtps_pd(_mm_movehl_ps(a, a))); }
void write(real *to, const DoublePair &xy, double z) {
    _mm_storel_pi(reinterpret_cast<__m64 *>(to), _mm_cvtpd_ps(xy));
    to[2] = static_cast<real>(z);
}
#else
Four pair_at(const real *p) { return Four{p[0], p[1], 0, 0}; }
DoublePair low_of(const Four &a) { return DoublePair{a[0], a[1]}; }
double third_of(const Four &a) { return a[2]; }
void write(real *to, const DoublePair &xy, double z) {
    for (int a = 0; a < 2; a++) to[a] = static_cast<real>(xy[a]);
    to[2] = static_cast<real>(z);
}
#endif
void widen(const Four &from, double *to) {
    *reinterpret_cast<DoublePair *>(to) = low_of(from);
    to[2] = third_of(from);
}
// Of three numbers: velocities may end with them.
void add(real *to, const DoublePair &xy, double z) { write(to, low_of(pair_at(to)) + xy, to[2] + z); }
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
        const Each own = each;  // nothing that is written can be a part of it
        for (int64_t k = 0; k < n; k++) all_true &= own(k);
        return all_true;
    }
#pragma omp parallel num_threads(n_threads) reduction(& : all_true)
    {
        const Each own = each;
#pragma omp for schedule(static)
        for (int64_t k = 0; k < n; k++) all_true &= own(k);
    }
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
            widen(read(here), to + 3 * static_cast<ptrdiff_t>(k));
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
    return for_molecules(arrangement, n_threads, [=, places = &arrangement](int start, int end) {
        Flags is_cut = {}, is_near = ~is_cut;
        for (int k = start; k < end; k++) {
            const ptrdiff_t i = 3 * static_cast<ptrdiff_t>(atoms[k]);
            const Four before = read(x + i), after = read(q + i), moved = after - before;
            is_cut |= box.is_other_image(before - read(x + 3 * static_cast<ptrdiff_t>(atoms[parents[k]])));
            is_near &= moved * moved <= near_squared;
            widen(before, to_x + 3 * static_cast<ptrdiff_t>(k));
            widen(after, to_q + 3 * static_cast<ptrdiff_t>(k));
        }
        const bool all_near = all(is_near);
        if (!all_near || any(is_cut)) {
            make_whole(*places, box, x, to_x, start, end);
            if (!all_near) {
                make_whole(*places, box, q, to_q, start, end);
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

bool move(const Arrangement &arrangement, double *d, double inverse_dt, real *q, real *v, double near, int n_threads) {
    const int *const atoms = arrangement.atoms.data();
    return for_all(static_cast<int64_t>(arrangement.atoms.size()), n_threads, [=](int64_t k) {
        DoublePair &first = *reinterpret_cast<DoublePair *>(d + 3 * k);
        const DoublePair xy = first;
        const double z = d[3 * k + 2];
        first = DoublePair{};
        d[3 * k + 2] = 0;
        const ptrdiff_t i = 3 * static_cast<ptrdiff_t>(atoms[k]);
        add(q + i, xy, z);
        if (v != nullptr) add(v + i, inverse_dt * xy, inverse_dt * z);
        return xy[0] * xy[0] + xy[1] * xy[1] + z * z <= near * near;
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
