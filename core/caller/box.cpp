#include "core/caller/box.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/caller/reduce.hpp"
#include "core/error.hpp"

namespace holonomic {

namespace {

bool is_diagonal(const double m[3][3]) {
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c)
            if (i != c && m[i][c] != 0) return false;
    return true;
}

Box orthorhombic_box(const double m[3][3]) {
    Box box{};
    box.lattice = Box::orthorhombic;
    for (int i = 0; i < 3; ++i) {
        box.h[4 * i] = m[i][i];
        box.inverse[4 * i] = m[i][i] != 0 ? 1 / m[i][i] : 0;
        if (!std::isfinite(box.inverse[4 * i])) throw make_error(Status::value, "box vector %d is too short", i + 1);
    }
    for (int i = 0; i < most_lanes + 2; ++i) {
        box.minus_side[i] = -box.h[4 * (i % 3)];
        box.per_side[i] = box.inverse[4 * (i % 3)];
    }
    return box;
}

// Replaces missing vectors, one or two, by ones perpendicular to the others.
void fill_missing_rows(double m[3][3], const bool *periodic) {
    const auto cross = [](const double *a, const double *b, double *c) {
        for (int k = 0; k < 3; ++k) c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    };
    for (int i = 0; i < 3; ++i) {
        if (periodic[i]) continue;
        double *a = m[i], *b = m[(i + 1) % 3], *c = m[(i + 2) % 3];
        if (periodic[(i + 1) % 3] && periodic[(i + 2) % 3]) {
            cross(b, c, a);
        } else if (!periodic[(i + 1) % 3] && periodic[(i + 2) % 3]) {
            int smallest = 0;
            for (int k = 1; k < 3; ++k)
                if (std::fabs(c[k]) < std::fabs(c[smallest])) smallest = k;
            double axis[3] = {0, 0, 0};
            axis[smallest] = 1;
            cross(c, axis, a);
            cross(c, a, b);
            return;
        }
    }
}

}  // namespace

// A row of zeros means that the box is not periodic along that vector. For the inverse it is replaced by a vector that
// makes the matrix regular; its own multiple is then never subtracted, because the kernels skip zero elements of h.
// Any other rows of the same lattice are the same box; kernels take those that are reduced (reduce.hpp), as nearest
// images are found by rounding fractional coordinates.
Box make_box(const double *h) {
    if (!h) return Box{};
    double m[3][3];
    bool periodic[3];
    for (int i = 0; i < 3; ++i) {
        periodic[i] = false;
        for (int c = 0; c < 3; ++c) {
            m[i][c] = h[3 * i + c];
            if (!std::isfinite(m[i][c]))
                throw make_error(Status::value, "element (%d,%d) of the box is not finite", i + 1, c + 1);
            periodic[i] = periodic[i] || m[i][c] != 0;
        }
    }
    // A side that was meant for the diagonal stands elsewhere, as where three sides fill the first row.
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c)
            if (m[i][c] != 0 && !periodic[c])
                throw make_error(Status::value,
                                 "box vector %d is zero, and box vector %d has a component (%g) along that axis: this "
                                 "is no cell; the box is three vectors, one in each row, and the sides of a "
                                 "rectangular box stand on the diagonal",
                                 c + 1, i + 1, m[i][c]);
    if (!periodic[0] && !periodic[1] && !periodic[2]) return Box{};
    if (is_diagonal(m)) return orthorhombic_box(m);
    double whole[3][3], gradient[3][3];
    std::memcpy(whole, m, sizeof m);
    fill_missing_rows(whole, periodic);
    double size = 1;
    for (const double *row : whole) size *= std::sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
    if (!(std::fabs(gradients_of(whole, gradient)) > 1e-10 * size))
        throw make_error(Status::value, "the box vectors lie in a plane or on a line");
    if (reduce_cell(whole, periodic)) {
        gradients_of(whole, gradient);
        for (int i = 0; i < 3; ++i)
            if (periodic[i]) std::copy(whole[i], whole[i] + 3, m[i]);
        if (is_diagonal(m)) return orthorhombic_box(m);
    }
    Box next{};
    next.lattice = Box::triclinic;
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c) {
            next.h[3 * i + c] = m[i][c];
            next.inverse[3 * c + i] = periodic[i] ? gradient[i][c] : 0;
        }
    return next;
}

Cell make_cell(const double *h) {
    Cell cell{};
    static_cast<Box &>(cell) = make_box(h);
    if (h) std::copy(h, h + 9, cell.given);
    return cell;
}

namespace {

// The distance of opposite faces is one over the gradient of the fractional coordinate.
double gradient_along(const Box &box, int i) {
    const double *const g = box.inverse + i;
    return std::sqrt(g[0] * g[0] + g[3] * g[3] + g[6] * g[6]);
}

}  // namespace

int narrow_side(const Box &box, double longest_bond, double *width) {
    if (box.lattice == Box::none || longest_bond == 0) return -1;
    for (int i = 0; i < 3; ++i) {
        const double gradient = gradient_along(box, i);
        if (gradient * 2 * longest_bond <= 1 + 1e-12) continue;
        *width = 1 / gradient;
        return i;
    }
    return -1;
}

double steepest_gradient(const Box &box) {
    if (box.lattice == Box::none) return 0;
    double steepest = 0;
    for (int i = 0; i < 3; ++i) steepest = std::max(gradient_along(box, i), steepest);
    return steepest;
}

std::int64_t bonds_round(const Box &box, double longest_bond) {
    if (box.lattice == Box::none) return 0;
    const double n = std::floor(1 / (steepest_gradient(box) * longest_bond) * (1 - 1e-9)) + 1;
    return n < 1e18 ? static_cast<std::int64_t>(n) : 0;
}

BoxRate make_box_rate(const double *L) {
    BoxRate rate{};
    if (!L) return rate;
    for (int i = 0; i < 9; ++i) {
        if (!std::isfinite(L[i]))
            throw make_error(Status::value, "element (%d,%d) of the rate of the box is not finite", i / 3 + 1,
                             i % 3 + 1);
        rate.L[i] = L[i];
    }
    const double strain[6] = {L[0], L[1] + L[3], L[2] + L[6], L[4], L[5] + L[7], L[8]};
    std::memcpy(rate.strain, strain, sizeof strain);
    return rate;
}

void minimum_image(const Box &box, double *d) {
    if (box.lattice == Box::none) return;
    double n[3];
    for (int i = 0; i < 3; ++i)
        n[i] = std::nearbyint(d[0] * box.inverse[i] + d[1] * box.inverse[3 + i] + d[2] * box.inverse[6 + i]);
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c)
            if (box.h[3 * i + c] != 0) d[c] = std::fma(-n[i], box.h[3 * i + c], d[c]);
}

}  // namespace holonomic
