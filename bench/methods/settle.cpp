// SETTLE (Miyamoto and Kollman 1992, J. Comput. Chem. 13, 952): the rigid triangle of water put back by rotations in
// closed form; and its velocity part, the three multipliers by cofactors. Scalar, one molecule after the other.
#include <cmath>
#include <stdexcept>

#include "graph_methods.hpp"

namespace bench {
namespace {

struct Vector {
    double x, y, z;
};
Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector operator*(double s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(Vector a, Vector b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Vector unit(Vector a) { return 1 / std::sqrt(dot(a, a)) * a; }
Vector load(const double *r) { return {r[0], r[1], r[2]}; }
void store(Vector a, double *r) { r[0] = a.x, r[1] = a.y, r[2] = a.z; }
double square(double x) { return x * x; }

/// The canonical triangle: distances of atoms from the centre of mass along and across its axis.
struct Triangle {
    double part_o, part_h;  ///< of the mass
    double ra, rb, rc, hh2, over_ra;
    double wo, wh;
    explicit Triangle(const Kind &kind) {
        const double o = kind.mass[0], h = kind.mass[1], all = o + 2 * h;
        part_o = o / all, part_h = h / all;
        rc = kind.length[2] / 2;
        const double height = std::sqrt(square(kind.length[0]) - square(rc));
        ra = 2 * part_h * height, rb = height - ra, over_ra = 1 / ra;
        hh2 = square(kind.length[2]);
        wo = kind.w[0], wh = kind.w[1];
    }
};

void positions(const Triangle &t, const double *reference, double over_dt, double *r, double *v) {
    const Vector b0 = load(reference + 3) - load(reference), c0 = load(reference + 6) - load(reference);
    const Vector a = load(r), b = load(r + 3), c = load(r + 6);
    const Vector centre = t.part_o * a + t.part_h * (b + c);
    const Vector a1 = a - centre, b1 = b - centre, c1 = c - centre;
    // Axes: z normal to the old triangle, x normal to it and to the new oxygen.
    const Vector normal = cross(b0, c0), ez = unit(normal), ex = unit(cross(a1, normal)), ey = cross(ez, ex);
    const double xb0 = dot(b0, ex), yb0 = dot(b0, ey), xc0 = dot(c0, ex), yc0 = dot(c0, ey);
    const double za1 = dot(a1, ez), xb1 = dot(b1, ex), yb1 = dot(b1, ey), zb1 = dot(b1, ez);
    const double xc1 = dot(c1, ex), yc1 = dot(c1, ey), zc1 = dot(c1, ez);
    // Turned about x by phi and about y by psi, so that the heights above the plane are those of the new atoms.
    const double sin_phi = za1 * t.over_ra, cos_phi = std::sqrt(1 - square(sin_phi));
    const double sin_psi = (zb1 - zc1) / (2 * t.rc * cos_phi), cos_psi = std::sqrt(1 - square(sin_psi));
    const double ya2 = t.ra * cos_phi, yb2 = -t.rb * cos_phi - t.rc * sin_psi * sin_phi;
    const double yc2 = -t.rb * cos_phi + t.rc * sin_psi * sin_phi;
    double xb2 = -t.rc * cos_psi;
    // What rounding took from the distance of the hydrogens.
    const double distance2 = 4 * square(xb2) + square(yb2 - yc2) + square(zb1 - zc1);
    xb2 -= 0.5 * (2 * xb2 + std::sqrt(4 * square(xb2) - distance2 + t.hh2));
    // Turned about z by theta, so that the forces act along the old bonds.
    const double alpha = xb2 * (xb0 - xc0) + yb0 * yb2 + yc0 * yc2, beta = xb2 * (yc0 - yb0) + xb0 * yb2 + xc0 * yc2;
    const double gamma = xb0 * yb1 - xb1 * yb0 + xc0 * yc1 - xc1 * yc0, norm = square(alpha) + square(beta);
    const double sin_theta = (alpha * gamma - beta * std::sqrt(norm - square(gamma))) / norm;
    const double cos_theta = std::sqrt(1 - square(sin_theta));
    const Vector new_a = centre + (-ya2 * sin_theta) * ex + (ya2 * cos_theta) * ey + za1 * ez;
    const Vector new_b =
        centre + (xb2 * cos_theta - yb2 * sin_theta) * ex + (xb2 * sin_theta + yb2 * cos_theta) * ey + zb1 * ez;
    const Vector new_c =
        centre + (-xb2 * cos_theta - yc2 * sin_theta) * ex + (-xb2 * sin_theta + yc2 * cos_theta) * ey + zc1 * ez;
    store(load(v) + over_dt * (new_a - a), v);
    store(load(v + 3) + over_dt * (new_b - b), v + 3);
    store(load(v + 6) + over_dt * (new_c - c), v + 6);
    store(new_a, r);
    store(new_b, r + 3);
    store(new_c, r + 6);
}

void velocities(const Triangle &t, const double *r, double *v) {
    const Vector d0 = load(r + 3) - load(r), d1 = load(r + 6) - load(r), d2 = load(r + 6) - load(r + 3);
    const Vector va = load(v), vb = load(v + 3), vc = load(v + 6);
    const double b0 = dot(d0, vb - va), b1 = dot(d1, vc - va), b2 = dot(d2, vc - vb);
    const double a00 = (t.wo + t.wh) * dot(d0, d0), a11 = (t.wo + t.wh) * dot(d1, d1), a22 = 2 * t.wh * dot(d2, d2);
    const double a01 = t.wo * dot(d0, d1), a02 = -t.wh * dot(d0, d2), a12 = t.wh * dot(d1, d2);
    const double c00 = a11 * a22 - a12 * a12, c01 = a02 * a12 - a01 * a22, c02 = a01 * a12 - a02 * a11;
    const double c11 = a00 * a22 - a02 * a02, c12 = a01 * a02 - a00 * a12, c22 = a00 * a11 - a01 * a01;
    const double inverse = 1 / (a00 * c00 + a01 * c01 + a02 * c02);
    const double t0 = inverse * (c00 * b0 + c01 * b1 + c02 * b2), t1 = inverse * (c01 * b0 + c11 * b1 + c12 * b2);
    const double t2 = inverse * (c02 * b0 + c12 * b1 + c22 * b2);
    store(va + t.wo * (t0 * d0 + t1 * d1), v);
    store(vb - t.wh * (t0 * d0 - t2 * d2), v + 3);
    store(vc - t.wh * (t1 * d1 + t2 * d2), v + 6);
}

}  // namespace

Method settle(Level level, const Molecules &m) {
    for (const Kind &kind : m.kinds)
        if (kind.n_atoms() != 3 || kind.n_bonds() != 3 || kind.w[1] != kind.w[2] || kind.length[0] != kind.length[1])
            throw std::invalid_argument("SETTLE is for water alone");
    const std::vector<Triangle> triangles(m.kinds.begin(), m.kinds.end());
    return {"settle", "default", [level, &m, triangles](State &s) {
                for (const Molecules::Place &place : m.places) {
                    const std::size_t at = 3 * place.atom;
                    if (level == Level::position)
                        positions(triangles[place.kind], &m.r[at], 1 / m.dt, &s.r[at], &s.v[at]);
                    else
                        velocities(triangles[place.kind], &m.r[at], &s.v[at]);
                }
            }};
}

}  // namespace bench
