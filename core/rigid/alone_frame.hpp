// The centre and the axes of one body in plain doubles, and their equations (alone.hpp).
#ifndef HOLONOMIC_RIGID_ALONE_FRAME_HPP
#define HOLONOMIC_RIGID_ALONE_FRAME_HPP

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rigid/alone.hpp"

namespace holonomic::rigid {

constexpr double eps = std::numeric_limits<double>::epsilon();

// A vector for the centre and R for the axes: of positions, velocities or forces.
template <int R>
struct Frame {
    double c[3], u[R][3];
};

inline double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Atoms from the first one, to x.
inline void unfold(const Lone &lone, const AtomArray &r, const Box &box, double *x) {
    double first[3], next[3];
    read_atom(r, lone.atoms[0], first);
    if (box.shape == Box::none) {
        for (std::int32_t a = 0; a < lone.body.n_atoms; ++a) {
            read_atom(r, lone.atoms[a], next);
            for (int c = 0; c < 3; ++c) x[3 * a + c] = next[c] - first[c];
        }
        return;
    }
    for (int c = 0; c < 3; ++c) x[c] = first[c] - first[c];
    for (const Step &step : lone.shape.steps) {
        double d[3];
        read_atom(r, lone.atoms[step.before], first);
        read_atom(r, lone.atoms[step.atom], next);
        bond_vector(box, first, next, d);
        for (int c = 0; c < 3; ++c) x[3 * step.atom + c] = x[3 * step.before + c] + d[c];
    }
}

template <int R>
Frame<R> frame_of(const Body &body, const double *x) {
    Frame<R> sum{};
    const double *share = body.share_rounded.data();
    for (std::int32_t a = 0; a < body.n_atoms; ++a, share += 1 + R, x += 3)
        for (int c = 0; c < 3; ++c) {
            sum.c[c] += share[0] * x[c];
            for (int p = 0; p < R; ++p) sum.u[p][c] += share[1 + p] * x[c];
        }
    return sum;
}

// Velocities of the atoms that have mass; what sites have is not looked at.
template <int R>
Frame<R> rates_of(const Lone &lone, const AtomArray &v) {
    Frame<R> sum{};
    const double *share = lone.body.share_rounded.data();
    for (std::int32_t a = 0; a < lone.body.n_atoms; ++a, share += 1 + R) {
        if (share[0] == 0) continue;
        double x[3];
        read_atom(v, lone.atoms[a], x);
        for (int c = 0; c < 3; ++c) {
            sum.c[c] += share[0] * x[c];
            for (int p = 0; p < R; ++p) sum.u[p][c] += share[1 + p] * x[c];
        }
    }
    return sum;
}

template <int R>
void at_atom(const Body &body, std::int32_t a, const Frame<R> &frame, double *x) {
    const double *const y = body.y_rounded.data() + static_cast<std::ptrdiff_t>(a) * R;
    for (int c = 0; c < 3; ++c) {
        x[c] = frame.c[c];
        for (int p = 0; p < R; ++p) x[c] += y[p] * frame.u[p][c];
    }
}

// X Lambda + Lambda X^T = b for a symmetric Lambda, X being all but diagonal; by its diagonal, and corrections.
template <int R>
bool solve(const double (*X)[R], const double (*b)[R], double (*lambda)[R], int most_passes) {
    double size[R], largest = 0;
    for (int p = 0; p < R; ++p) size[p] = std::sqrt(X[p][p]);
    for (int p = 0; p < R; ++p)
        for (int q = 0; q < R; ++q) {
            lambda[p][q] = b[p][q] / (X[p][p] + X[q][q]);
            largest = std::max(largest, std::fabs(lambda[p][q]) * size[p] * size[q]);
        }
    for (int pass = 0; pass < most_passes; ++pass) {
        double change[R][R], worst = 0;
        for (int p = 0; p < R; ++p)
            for (int q = p; q < R; ++q) {
                double rest = b[p][q];
                for (int s = 0; s < R; ++s) rest -= X[p][s] * lambda[s][q] + lambda[p][s] * X[q][s];
                change[p][q] = change[q][p] = rest / (X[p][p] + X[q][q]);
                worst = std::max(worst, std::fabs(change[p][q]) * size[p] * size[q]);
            }
        for (int p = 0; p < R; ++p)
            for (int q = 0; q < R; ++q) lambda[p][q] += change[p][q];
        if (worst <= 2 * eps * largest) return true;
    }
    return false;
}

// u_p less the sum of Lambda_pq of v_q.
template <int R>
void take_away(double (*u)[3], const double (*v)[3], const double (*lambda)[R]) {
    for (int p = 0; p < R; ++p)
        for (int q = 0; q < R; ++q)
            for (int c = 0; c < 3; ++c) u[p][c] -= lambda[p][q] * v[q][c];
}

template <int R>
void products(const double (*u)[3], double (*s)[R]) {
    for (int p = 0; p < R; ++p)
        for (int q = p; q < R; ++q) s[p][q] = s[q][p] = dot(u[p], u[q]);
}

template <int R>
void add_virial(const double (*u)[3], const double (*lambda)[R], double factor, double *virial) {
    if (!virial) return;
    for (int p = 0; p < R; ++p)
        for (int q = 0; q < R; ++q) {
            double *to = virial;
            for (int a = 0; a < 3; ++a)
                for (int b = a; b < 3; ++b) *to++ -= factor * lambda[p][q] * u[p][a] * u[q][b];
        }
}

template <int R>
bool is_finite(const Frame<R> &frame) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
        sum += std::fabs(frame.c[c]);
        for (int p = 0; p < R; ++p) sum += std::fabs(frame.u[p][c]);
    }
    return std::isfinite(sum);
}

// Sites count in no sum; what they have must be a number all the same.
inline bool are_finite(const double *x, std::int32_t n) {
    double sum = 0;
    for (std::int32_t i = 0; i < 3 * n; ++i) sum += std::fabs(x[i]);
    return std::isfinite(sum);
}

}  // namespace holonomic::rigid
#endif
