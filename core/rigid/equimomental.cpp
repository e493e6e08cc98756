// With J = sum m x x^T = (tr I / 2) 1 - I and any L of as many columns as J has dimensions with L L^T = J / M, points
// of mass M / n at x_a = L s_a have sum m x x^T = J, where the s_a are the corners of a regular simplex: sum_a s_a = 0,
// sum_a s_a s_a^T = n 1.
#include "core/rigid/equimomental.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.hpp"

namespace holonomic::rigid {

namespace {

// What the digits of a file may leave of a plane's or a line's missing thickness, of sum m x^2; and what rounding does.
constexpr long double of_file = 1e-5L, of_rounding = 1e-14L;

const char axis[] = "xyz";

void check(double mass, const double *centre, const double *inertia) {
    if (!(mass > 0) || std::isinf(mass))
        throw make_error(Status::value, "the mass is %g; it must be above 0 and finite", mass);
    for (int i = 0; centre && i < 3; ++i)
        if (!std::isfinite(centre[i])) throw make_error(Status::value, "the centre's %c is %g", axis[i], centre[i]);
    double largest = 0;
    for (int e = 0; e < 9; ++e) {
        if (!std::isfinite(inertia[e]))
            throw make_error(Status::value, "the inertia's element %c%c is %g", axis[e / 3], axis[e % 3], inertia[e]);
        largest = std::max(largest, std::fabs(inertia[e]));
    }
    for (int i = 0; i < 3; ++i) {
        if (!(inertia[4 * i] >= 0))
            throw make_error(Status::value, "the inertia's element %c%c is %g: a moment of inertia is not negative",
                             axis[i], axis[i], inertia[4 * i]);
        for (int j = 0; j < i; ++j)
            if (!(std::fabs(inertia[3 * i + j] - inertia[3 * j + i]) <= 1e-10 * largest))
                throw make_error(Status::value,
                                 "the inertia is not symmetric: its element %c%c is %.10g, and %c%c is %.10g", axis[j],
                                 axis[i], inertia[3 * j + i], axis[i], axis[j], inertia[3 * i + j]);
    }
}

long double largest_of(const long double (&J)[3][3]) {
    long double largest = 0;
    for (const auto &row : J)
        for (const long double element : row) largest = std::max(largest, std::fabs(element));
    return largest;
}

// Of two eigenvalues that are left, whether they are of unlike signs and alike in size.
bool is_indefinite(const long double (&J)[3][3]) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const long double product = J[i][j] * J[i][j] - J[i][i] * J[j][j];
        if (product > 0.05L * (J[i][i] * J[i][i] + J[j][j] * J[j][j] + J[i][j] * J[i][j])) return true;
    }
    return false;
}

struct CholeskyFactor {
    long double column[3][3];
    int rank;
};

// Cholesky's, with pivots in descending order; a rank less than 3 where what is left is 0 to rounding, or as far below
// as a file's digits may be. rank -1: more is below.
CholeskyFactor factor_of(long double (&J)[3][3]) {
    CholeskyFactor factor{};
    const long double trace = J[0][0] + J[1][1] + J[2][2];
    for (int k = 0; k < 3; ++k) {
        int p = 0;
        for (int i = 1; i < 3; ++i)
            if (J[i][i] > J[p][p]) p = i;
        if (!(J[p][p] > of_rounding * trace) || (largest_of(J) <= of_file * trace && is_indefinite(J))) break;
        long double *const c = factor.column[k];
        for (int i = 0; i < 3; ++i) c[i] = J[i][p] / std::sqrt(J[p][p]);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) J[i][j] = i == p || j == p ? 0 : J[i][j] - c[i] * c[j];
        factor.rank = k + 1;
    }
    if (!(largest_of(J) <= of_file * trace)) factor.rank = -1;
    return factor;
}

// The eigenvalues of a symmetric matrix, ascending, as roots of its characteristic polynomial: to half the digits, for
// messages.
void moments_of(const double *a, double (&moment)[3]) {
    const double mean = (a[0] + a[4] + a[8]) / 3;
    double b[9], square = 0;
    for (int e = 0; e < 9; ++e) {
        b[e] = a[e] - (e % 4 == 0 ? mean : 0);
        square += b[e] * b[e] / 6;
    }
    const double p = std::sqrt(square), det = b[0] * (b[4] * b[8] - b[5] * b[7]) - b[1] * (b[3] * b[8] - b[5] * b[6]) +
                                              b[2] * (b[3] * b[7] - b[4] * b[6]);
    const double third = std::acos(-1.0) * 2 / 3;
    const double angle = p > 0 ? std::acos(std::max(-1.0, std::min(1.0, det / (2 * p * p * p)))) / 3 : 0;
    for (int k = 0; k < 3; ++k) moment[k] = mean + 2 * p * std::cos(angle + third * (k + 1));
    std::sort(moment, moment + 3);
    for (double &x : moment)
        if (std::fabs(x) < 1e-7 * moment[2]) x = 0;
}

// Of the regular simplex of rank + 1 corners.
void corner_of(int rank, int a, long double (&s)[3]) {
    const long double root = std::sqrt(2.0L), angle = std::acos(-1.0L) * 2 / 3 * a;
    s[0] = rank == 1 ? 1 - 2 * a : rank == 2 ? root * std::cos(angle) : a < 2 ? 1 : -1;
    s[1] = rank == 2 ? root * std::sin(angle) : a % 2 == 0 ? 1 : -1;
    s[2] = a == 0 || a == 3 ? 1 : -1;
}

}  // namespace

MassPoints equimomental_points(double mass, const double *centre, const double *inertia) {
    check(mass, centre, inertia);
    const long double half = (static_cast<long double>(inertia[0]) + inertia[4] + inertia[8]) / 2;
    if (!(half > 0)) throw make_error(Status::value, "the inertia is 0: that is a point, and no body");
    long double J[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            J[i][j] = (i == j ? half : 0) - (static_cast<long double>(inertia[3 * i + j]) + inertia[3 * j + i]) / 2;
    const CholeskyFactor factor = factor_of(J);
    if (factor.rank < 0) {
        double moment[3];
        moments_of(inertia, moment);
        if (!(moment[0] >= 0))
            throw make_error(Status::value, "the inertia has the principal moment %.6g: none can be negative",
                             moment[0]);
        throw make_error(Status::value,
                         "the inertia has the principal moments %.6g, %.6g and %.6g: of no distribution of mass the "
                         "largest is above the sum of the others",
                         moment[0], moment[1], moment[2]);
    }
    MassPoints found{factor.rank + 1, mass / (factor.rank + 1), {}};
    for (int a = 0; a < found.n; ++a) {
        long double s[3];
        corner_of(factor.rank, a, s);
        for (int i = 0; i < 3; ++i) {
            long double x = 0;
            for (int k = 0; k < factor.rank; ++k) x += factor.column[k][i] * s[k];
            found.coordinates[a][i] =
                static_cast<double>((centre ? centre[i] : 0) + x / std::sqrt(static_cast<long double>(mass)));
        }
    }
    return found;
}

}  // namespace holonomic::rigid
