#include "bodies/scene.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace bench {
namespace {

void add(BodyScene &s, double mass, double x, double y, double z) {
    s.mass.push_back(mass);
    s.place.insert(s.place.end(), {x, y, z});
}

BodyScene shape(const std::string &name) {
    BodyScene s;
    s.name = name;
    const double pi = std::acos(-1.0);
    if (name == "CO2") {
        for (int i = -1; i < 2; ++i) add(s, i == 0 ? 12.011 : 15.999, 1.16 * i, 0, 0);
    } else if (name == "benzene") {
        for (int i = 0; i < 12; ++i)
            add(s, i < 6 ? 12.011 : 1.008, (i < 6 ? 1.397 : 2.481) * std::cos(pi / 3 * i),
                (i < 6 ? 1.397 : 2.481) * std::sin(pi / 3 * i), 0);
    } else if (name == "C60") {
        // The corners of a truncated icosahedron: even permutations of three triples with all signs.
        const double g = (1 + std::sqrt(5.0)) / 2;
        const double corners[3][3] = {{0, 1, 3 * g}, {1, 2 + g, 2 * g}, {g, 2, 2 * g + 1}};
        for (int c = 0; c < 3; ++c)
            for (int turn = 0; turn < 3; ++turn)
                for (int signs = 0; signs < 8; ++signs) {
                    double x[3];
                    for (int k = 0; k < 3; ++k)
                        x[k] = 0.7 * corners[c][(k + turn) % 3] * (signs >> ((k + turn) % 3) & 1 ? -1 : 1);
                    if (c == 0 && (signs & 1)) continue;  // +0 and -0
                    add(s, 12.011, x[0], x[1], x[2]);
                }
    } else {
        add(s, 3, 1, 0, 0), add(s, 2, -1, 0.5, 0), add(s, 4, 0.3, -1, 0.2), add(s, 1, 0, 0.4, 1.1),
            add(s, 2, 0, 0, -0.9);
    }
    return s;
}

void turn(const double *axis, double angle, const double *from, double *to) {
    const double c = std::cos(angle), s = std::sin(angle),
                 along = axis[0] * from[0] + axis[1] * from[1] + axis[2] * from[2];
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        to[k] = c * from[k] + s * (axis[l] * from[m] - axis[m] * from[l]) + (1 - c) * along * axis[k];
    }
}

}  // namespace

bool BodyScene::is_free() const {
    return std::all_of(spring.begin(), spring.end(), [](double k) { return k == 0; });
}

void BodyScene::forces(const double *x, double *f) const {
    const std::int64_t n = 3 * atoms_each();
    for (std::int64_t b = 0; b < n_bodies; ++b)
        for (std::int64_t i = 0; i < n; ++i)
            f[b * n + i] =
                spring[static_cast<std::size_t>(i)] * (anchor[static_cast<std::size_t>(b * n + i)] - x[b * n + i]);
}

double BodyScene::potential(const double *x) const {
    double sum = 0;
    const std::size_t n = spring.size();
    for (std::size_t i = 0; i < anchor.size(); ++i)
        sum += 0.5 * spring[i % n] * (x[i] - anchor[i]) * (x[i] - anchor[i]);
    return sum;
}

std::vector<BodyScene> body_scenes(std::int64_t n_bodies) {
    std::vector<BodyScene> scenes;
    for (const char *const name : {"CO2", "benzene", "C60", "free top"}) {
        BodyScene s = shape(name);
        s.n_bodies = n_bodies;
        std::mt19937_64 random(7);
        std::normal_distribution<double> normal;
        const std::size_t n = s.mass.size();
        double whole = 0, centre[3] = {};
        for (std::size_t i = 0; i < n; ++i) {
            whole += s.mass[i];
            for (std::size_t c = 0; c < 3; ++c) centre[c] += s.mass[i] * s.place[3 * i + c];
        }
        for (std::size_t i = 0; i < 3 * n; ++i) s.place[i] -= centre[i % 3] / whole;
        // Stiffer where the body is heavier, so that all kinds move as fast; unlike in x, y, z and from atom to atom.
        for (std::size_t i = 0; i < 3 * n; ++i)
            s.spring.push_back(s.name == "free top" ? 0
                                                    : whole / static_cast<double>(n) *
                                                          (1 + 0.7 * std::sin(2.3 * static_cast<double>(i))));
        for (std::int64_t b = 0; b < n_bodies; ++b) {
            double axis[3], spin[3], speed[3], size = 0;
            for (double &x : axis) x = normal(random), size += x * x;
            for (double &x : axis) x /= std::sqrt(size);
            for (int c = 0; c < 3; ++c) spin[c] = normal(random), speed[c] = normal(random);
            for (std::size_t i = 0; i < n; ++i) {
                double x[3];
                turn(axis, static_cast<double>(b), &s.place[3 * i], x);
                for (int c = 0; c < 3; ++c) {
                    const int d = (c + 1) % 3, e = (c + 2) % 3;
                    s.r.push_back(x[c]);
                    s.v.push_back((s.name == "free top" ? 0 : speed[c]) + spin[d] * x[e] - spin[e] * x[d]);
                    s.anchor.push_back(x[c] + 0.3 * normal(random));
                }
            }
        }
        scenes.push_back(s);
    }
    return scenes;
}

}  // namespace bench
