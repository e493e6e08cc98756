#include "core/rigid/body.hpp"
#include "core/index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace holonomic::rigid {

namespace {

using plain::less;
using plain::square_root;

// A body thinner than this part of its longest axis is flat or straight: its distances do not tell the difference.
constexpr double thin = 1e-8;
// Squares of lengths must neither vanish nor overflow.
constexpr double least_size = 1e-140, most_size = 1e140;

struct Axes {
    DoublePair square[3];
    DoublePair axis[3][3];  // axis[p] of unit length
};

// Jacobi's rotations, in twice the precision: the thinnest axis keeps its digits.
Axes axes_of(DoublePair s[3][3]) {
    DoublePair e[3][3];
    for (int p = 0; p < 3; ++p)
        for (int c = 0; c < 3; ++c) e[p][c] = as_pair(p == c ? 1 : 0);
    for (int sweep = 0; sweep < 60; ++sweep) {
        bool turned = false;
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) {
                const double off = s[p][q].hi;
                if (off == 0 || std::fabs(off) < 1e-40 * (std::fabs(s[p][p].hi) + std::fabs(s[q][q].hi))) continue;
                turned = true;
                // tan of the angle, small: t^2 + 2 theta t - 1 = 0
                const DoublePair theta = (s[q][q] - s[p][p]) / (2.0 * s[p][q]);
                const DoublePair root = square_root(theta * theta + as_pair(1));
                const DoublePair size = plain::abs(theta) + root;
                DoublePair t = as_pair(1) / size;
                if (theta.hi < 0) t = -t;
                const DoublePair c = as_pair(1) / square_root(t * t + as_pair(1)), sine = t * c;
                for (int k = 0; k < 3; ++k) {
                    const DoublePair a = s[k][p], b = s[k][q];
                    s[k][p] = c * a - sine * b;
                    s[k][q] = sine * a + c * b;
                }
                for (int k = 0; k < 3; ++k) {
                    const DoublePair a = s[p][k], b = s[q][k];
                    s[p][k] = c * a - sine * b;
                    s[q][k] = sine * a + c * b;
                }
                for (int k = 0; k < 3; ++k) {
                    const DoublePair a = e[p][k], b = e[q][k];
                    e[p][k] = c * a - sine * b;
                    e[q][k] = sine * a + c * b;
                }
            }
        if (!turned) break;
    }
    int order[3] = {0, 1, 2};
    std::sort(order, order + 3, [&](int p, int q) { return less(s[q][q], s[p][p]); });
    Axes found;
    for (int p = 0; p < 3; ++p) {
        found.square[p] = s[order[p]][order[p]];
        for (int c = 0; c < 3; ++c) found.axis[p][c] = e[order[p]][c];
    }
    return found;
}

// Coordinates and shares as kernels have them, for axes of length 1, rounded; and what that leaves off their product.
// Shares are too large by 1/1600: were it the rounding alone, what kernels take off would be less than half a unit of
// the last digit, and lost, or a whole one, each time in the same way.
void set_weights(Body &body) {
    const std::int64_t n = body.n_atoms, K = 1 + body.rank;
    std::vector<double> &weights = body.weights;
    weights.resize(at(2 * n * K));
    DoublePair length[4] = {as_pair(1)};
    for (int p = 0; p < body.rank; ++p) length[1 + p] = square_root(body.square[p]);
    for (std::int64_t a = 0; a < n; ++a)
        for (std::int64_t k = 0; k < K; ++k) {
            weights[at(a * K + k)] = k == 0 ? 1 : rounded(body.y[at(a * body.rank + k - 1)] * length[k]);
            weights[at((n + a) * K + k)] = rounded(1.000618 * (body.share[at(a * K + k)] / length[k]));
        }
    DoublePair product[4][4];
    for (std::int64_t k = 0; k < K; ++k)
        for (std::int64_t l = 0; l < K; ++l) {
            product[k][l] = as_pair(0);
            for (std::int64_t a = 0; a < n; ++a)
                product[k][l] = product[k][l] + weights[at((n + a) * K + k)] * as_pair(weights[at(a * K + l)]);
        }
    // 1 less its inverse, as what stands beside its diagonal is as small as a rounding.
    for (std::int64_t k = 0; k < K; ++k)
        for (std::int64_t l = 0; l < K; ++l)
            body.excess[k][l] =
                rounded((k == l ? product[k][k] - as_pair(1) : product[k][l] / product[l][l]) / product[k][k]);
}

// sum m y = 0 and sum m y y^T = M to the last digit of pairs: what the rounding of a thin axis, whose square is 1e-16
// of the longest, left of it would couple that axis to the others.
void make_orthonormal(Body &body, const DoublePair &mass) {
    const std::int32_t rank = body.rank;
    const auto product = [&](int p, int q) {  // q = -1: the mean
        DoublePair sum = as_pair(0);
        for (std::int32_t a = 0; a < body.n_atoms; ++a) {
            const DoublePair *const y = body.y.data() + a * rank;
            sum = sum + body.masses[at(a)] * (q < 0 ? y[p] : y[p] * y[q]);
        }
        return sum / mass;
    };
    for (int p = 0; p < rank; ++p) {
        for (int q = -1; q < p; ++q) {
            const DoublePair part = product(p, q);
            for (std::int32_t a = 0; a < body.n_atoms; ++a) {
                DoublePair *const y = body.y.data() + a * rank;
                y[p] = y[p] - (q < 0 ? part : part * y[q]);
            }
        }
        const DoublePair size = square_root(product(p, p));
        for (std::int32_t a = 0; a < body.n_atoms; ++a) body.y[at(a * rank + p)] = body.y[at(a * rank + p)] / size;
    }
}

bool is_right_handed(const Axes &axes) {
    const auto e = [&](int p, int c) { return axes.axis[p][c % 3].hi; };
    double product = 0;
    for (int c = 0; c < 3; ++c) product += (e(0, c + 1) * e(1, c + 2) - e(0, c + 2) * e(1, c + 1)) * e(2, c);
    return product > 0;
}

// A site off the plane.
void lift(Body &body, std::int32_t site, const DoublePair &height) {
    body.z.resize(at(body.n_atoms), as_pair(0));
    body.height.resize(at(body.n_atoms), 0);
    body.z[at(site)] = height / square_root(body.square[0] * body.square[1]);
    body.height[at(site)] = rounded(height);
}

void check_input(std::int32_t n, const double *masses, const double *coordinates) {
    int massive = 0;
    for (std::int32_t a = 0; a < n; ++a) {
        massive += masses[a] > 0;
        for (int c = 0; c < 3; ++c)
            if (!std::isfinite(coordinates[3 * a + c])) throw BodyFault{BodyFault::not_finite, a};
    }
    if (massive == 0) throw BodyFault{BodyFault::no_mass, -1};
    if (massive == 1) throw BodyFault{BodyFault::one_mass, -1};
}

}  // namespace

Body make_body(std::int32_t n, const double *masses, const double *coordinates) {
    check_input(n, masses, coordinates);
    Body body;
    body.n_atoms = n;
    body.masses.assign(masses, masses + n);
    body.coordinates.assign(coordinates, coordinates + 3 * at(n));
    body.n_massive = static_cast<std::int32_t>(std::count_if(masses, masses + n, [](double m) { return m > 0; }));
    // Coordinates from the first atom's, which is exact; then from the centre.
    DoublePair mass = as_pair(0), centre[3], s[3][3];
    std::vector<DoublePair> x(3 * at(n));
    for (int c = 0; c < 3; ++c) centre[c] = as_pair(0);
    for (std::int32_t a = 0; a < n; ++a) {
        mass = mass + as_pair(masses[a]);
        for (int c = 0; c < 3; ++c) {
            x[at(3 * a + c)] = as_pair(coordinates[3 * a + c]) - as_pair(coordinates[c]);
            centre[c] = centre[c] + masses[a] * x[at(3 * a + c)];
        }
    }
    for (int c = 0; c < 3; ++c) centre[c] = centre[c] / mass;
    double largest = 0, extent = 0;
    for (std::int32_t a = 0; a < n; ++a) {
        double square = 0;
        for (int c = 0; c < 3; ++c) {
            DoublePair &component = x[at(3 * a + c)];
            component = component - centre[c];
            square += component.hi * component.hi;
            largest = std::max(largest, std::fabs(coordinates[3 * a + c]));
        }
        extent = std::max(extent, std::sqrt(square));
    }
    body.extent = extent;
    if (!(extent > 8 * std::numeric_limits<double>::epsilon() * largest)) throw BodyFault{BodyFault::one_point, -1};
    if (!(extent > least_size && extent < most_size)) throw BodyFault{BodyFault::size, -1};
    for (int c = 0; c < 3; ++c)
        for (int d = 0; d < 3; ++d) {
            s[c][d] = as_pair(0);
            for (std::int32_t a = 0; a < n; ++a) s[c][d] = s[c][d] + (masses[a] * x[at(3 * a + c)]) * x[at(3 * a + d)];
            s[c][d] = s[c][d] / mass;
        }
    const Axes axes = axes_of(s);
    if (!(axes.square[0].hi > least_size * least_size)) throw BodyFault{BodyFault::one_mass, -1};
    body.mass = rounded(mass);
    body.inverse_mass = 1 / body.mass;
    body.rank = 0;
    for (int p = 0; p < 3; ++p) {
        body.square[p] = as_pair(0);
        body.length[p] = 0;
        if (!(axes.square[p].hi > thin * thin * axes.square[0].hi)) continue;
        body.rank = p + 1;
        body.square[p] = axes.square[p];
        body.length[p] = std::sqrt(axes.square[p].hi);
    }
    body.y.resize(at(n) * at(body.rank));
    body.share.resize(at(n) * at(1 + body.rank));
    for (std::int32_t a = 0; a < n; ++a) {
        body.share[at(a * (1 + body.rank))] = as_pair(masses[a]) / mass;
        for (int p = 0; p < 3; ++p) {
            DoublePair along = as_pair(0);
            for (int c = 0; c < 3; ++c) along = along + axes.axis[p][c] * x[at(3 * a + c)];
            if (p >= body.rank) {
                if (!(std::fabs(along.hi) > 4 * thin * extent)) continue;
                if (masses[a] > 0) throw BodyFault{BodyFault::light, a};
                if (body.rank == 1) throw BodyFault{BodyFault::off_line, a};
                lift(body, a, is_right_handed(axes) ? along : -along);
                continue;
            }
            body.y[at(a * body.rank + p)] = along / square_root(body.square[p]);
        }
    }
    make_orthonormal(body, mass);
    for (std::int32_t a = 0; a < n; ++a)
        for (int p = 0; p < body.rank; ++p)
            body.share[at(a * (1 + body.rank) + 1 + p)] = (masses[a] * body.y[at(a * body.rank + p)]) / mass;
    double farthest = 0;
    for (const DoublePair &y : body.y) farthest = std::max(farthest, std::fabs(y.hi));
    for (const double height : body.height) farthest = std::max(farthest, std::fabs(height) / body.length[1]);
    // Of a size, too, whose moments of inertia are far from what a double holds.
    const double least_moment = body.mass * (body.length[body.rank - 1] * body.length[body.rank - 1]);
    body.is_thick = body.length[body.rank - 1] > 1e-3 * body.length[0] && farthest < 100 && least_moment > 1e-200 &&
                    least_moment < 1e200;
    if (body.is_thick) set_weights(body);
    return body;
}

std::int64_t Body::bytes() const {
    return static_cast<std::int64_t>(
        (masses.capacity() + coordinates.capacity() + weights.capacity() + height.capacity()) * sizeof(double) +
        (y.capacity() + z.capacity() + first.capacity() + of_fixed.capacity() + share.capacity()) * sizeof(DoublePair) +
        (relations.c.capacity() + relations.of_fixed.capacity()) * sizeof(double) + sizeof *this);
}

const char *fault_in_words(BodyFault::Cause cause) {
    switch (cause) {
        case BodyFault::no_mass:
            return "has no mass: all its atoms are massless sites";
        case BodyFault::one_mass:
            return "has mass at one point alone: it has no orientation; at least two atoms need a mass";
        case BodyFault::one_point:
            return "has all its atoms at one point";
        case BodyFault::not_finite:
            return "has a reference coordinate that is not finite";
        case BodyFault::size:
            return "is too large or too small: choose other units";
        case BodyFault::off_line:
            return "has a massless site off the line of its masses: such a site has no place that the masses determine";
        case BodyFault::twice:
            return "has a linear relation that follows from the others";
        case BodyFault::undetermined:
            return "has massless atoms whose coordinates do not follow from those of atoms with mass";
        case BodyFault::held:
            return "has linear relations with fixed atoms that leave nothing of it free";
        default:
            return "has an atom so light that the others alone determine its motion, and off their line or plane";
    }
}

// Prim's tree of least distances.
std::vector<NearestStep> nearest_steps(const Body &body, std::int32_t first) {
    const std::int32_t n = body.n_atoms;
    std::vector<NearestStep> steps;
    std::vector<double> least(at(n), std::numeric_limits<double>::infinity());
    std::vector<std::int32_t> before(at(n), -1);
    std::vector<bool> done(at(n), false);
    std::int32_t last = first;
    done[at(first)] = true;
    for (std::int32_t k = 1; k < n; ++k) {
        std::int32_t next = -1;
        for (std::int32_t a = 0; a < n; ++a) {
            if (done[at(a)]) continue;
            double square = 0;
            for (int c = 0; c < 3; ++c) {
                const double d = body.coordinates[at(3 * a + c)] - body.coordinates[at(3 * last + c)];
                square += d * d;
            }
            if (square < least[at(a)]) {
                least[at(a)] = square;
                before[at(a)] = last;
            }
            if (next < 0 || least[at(a)] < least[at(next)]) next = a;
        }
        steps.push_back({next, before[at(next)]});
        done[at(next)] = true;
        last = next;
    }
    return steps;
}

}  // namespace holonomic::rigid
