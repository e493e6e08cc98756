// SPDX-License-Identifier: GPL-2.0-only
// Data files for LAMMPS, in reduced units, written to standard output.
//
//   make_scene melt N_CHAINS N_BEADS       linear chains that wind through a simple cubic lattice
//   make_scene sheet N_CHAINS N_BEADS      linear chains that wind through a square lattice, for dimension 2
//   make_scene line N_BEADS                one straight chain along x
//   make_scene dimers|trimers|waters|stars|lines|methanes N    molecules at lattice points, turned at random
//   make_scene bent N ANGLE                three beads with a given angle, in degrees
//
// Bonds have the length 1.05 (melt, sheet: the lattice's spacing). Type 1: ends and light atoms; type 2: all others.
// Angles of bent molecules, waters and stars are of type 1. Masses belong to the input script.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>

namespace {

constexpr double bond_length = 1.05;
constexpr double pi = 3.14159265358979323846;

struct Atom {
    int molecule, type;
    double x, y, z;
};

struct Scene {
    double box[3];  // from 0 to there; without a height: from -0.5 to 0.5
    std::vector<Atom> atoms;
    std::vector<std::vector<int>> bonds, angles;  // atoms, counted from 1
};

/** Lattice points along a way on which each is next to the one before. */
std::vector<std::vector<int>> winding(int n, int layers) {
    std::vector<std::vector<int>> points;
    for (int k = 0; k < layers; ++k)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const int y = k % 2 ? n - 1 - j : j;
                const int x = (j + k * n) % 2 ? n - 1 - i : i;
                points.push_back({x, y, k});
            }
    return points;
}

Scene melt(int n_chains, int n_beads, bool flat) {
    const double n_atoms = static_cast<double>(n_chains) * n_beads;
    const int n = static_cast<int>(std::ceil((flat ? std::sqrt(n_atoms) : std::cbrt(n_atoms)) - 1e-9));
    const auto points = winding(n, flat ? 1 : n);
    Scene scene{{n * bond_length, n * bond_length, flat ? 0 : n * bond_length}, {}, {}, {}};
    for (int k = 0; k < n_chains * n_beads; ++k) {
        const bool end = k % n_beads == 0 || k % n_beads == n_beads - 1;
        scene.atoms.push_back({k / n_beads + 1, end ? 1 : 2, points[k][0] * bond_length, points[k][1] * bond_length,
                               points[k][2] * bond_length});
        if (k % n_beads > 0) scene.bonds.push_back({k, k + 1});
    }
    return scene;
}

Scene line(int n_beads) {
    Scene scene{{(n_beads + 2) * bond_length, 8, 8}, {}, {}, {}};
    for (int k = 0; k < n_beads; ++k) {
        scene.atoms.push_back({1, k == 0 || k == n_beads - 1 ? 1 : 2, (k + 1) * bond_length, 4, 4});
        if (k > 0) scene.bonds.push_back({k, k + 1});
    }
    return scene;
}

/** A molecule: its atoms, bonds and angles, counted from 1. */
struct Template {
    std::vector<std::vector<double>> r;
    std::vector<int> types;
    std::vector<std::vector<int>> bonds, angles;
};

Template bent(double degrees) {
    const double c = bond_length * std::cos(degrees * pi / 180), s = bond_length * std::sin(degrees * pi / 180);
    return {{{bond_length, 0, 0}, {0, 0, 0}, {c, s, 0}}, {1, 2, 1}, {{1, 2}, {2, 3}}, {{1, 2, 3}}};
}

Template template_of(const char *kind, double degrees) {
    if (!strcmp(kind, "dimers")) return {{{0, 0, 0}, {bond_length, 0, 0}}, {1, 1}, {{1, 2}}, {}};
    if (!strcmp(kind, "trimers")) {
        Template trimer = bent(120);
        trimer.angles.clear();
        return trimer;
    }
    if (!strcmp(kind, "waters")) return bent(109.47);
    if (!strcmp(kind, "bent")) return bent(degrees);
    if (!strcmp(kind, "lines"))
        return {{{0, 0, 0}, {bond_length, 0, 0}, {2 * bond_length, 0, 0}, {3 * bond_length, 0, 0}},
                {1, 2, 2, 1},
                {{1, 2}, {2, 3}, {3, 4}},
                {{1, 2, 3}, {2, 3, 4}}};
    const double a = bond_length / std::sqrt(3.0);
    if (!strcmp(kind, "methanes"))
        return {{{0, 0, 0}, {a, a, a}, {a, -a, -a}, {-a, a, -a}, {-a, -a, a}},
                {2, 1, 1, 1, 1},
                {{1, 2}, {1, 3}, {1, 4}, {1, 5}},
                {{2, 1, 3}, {2, 1, 4}, {2, 1, 5}, {3, 1, 4}, {3, 1, 5}, {4, 1, 5}}};
    return {{{0, 0, 0}, {a, a, a}, {a, -a, -a}, {-a, a, -a}}, {2, 1, 1, 1}, {{1, 2}, {1, 3}, {1, 4}}, {}};
}

Template centred(Template shape) {
    for (int c = 0; c < 3; ++c) {
        double mean = 0;
        for (const auto &r : shape.r) mean += r[c] / static_cast<double>(shape.r.size());
        for (auto &r : shape.r) r[c] -= mean;
    }
    return shape;
}

/** A rotation drawn uniformly, by a random unit quaternion. */
void rotation(std::mt19937_64 &random, double m[3][3]) {
    std::normal_distribution<double> normal;
    double q[4], norm = 0;
    for (double &x : q) x = normal(random), norm += x * x;
    for (double &x : q) x /= std::sqrt(norm);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    memcpy(m, rows, sizeof rows);
}

Scene lattice(const char *kind, int n_molecules, double degrees) {
    const Template shape = centred(template_of(kind, degrees));
    const int n = static_cast<int>(std::ceil(std::cbrt(n_molecules) - 1e-9));
    double radius = 0;
    for (const auto &r : shape.r) radius = std::max(radius, std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]));
    const double spacing = 2 * radius + 1;
    Scene scene{{n * spacing, n * spacing, n * spacing}, {}, {}, {}};
    std::mt19937_64 random(4711);
    for (int k = 0; k < n_molecules; ++k) {
        double m[3][3];
        rotation(random, m);
        const int first = static_cast<int>(scene.atoms.size());
        const double at[3] = {(k % n + 0.5) * spacing, (k / n % n + 0.5) * spacing, (k / n / n + 0.5) * spacing};
        for (std::size_t i = 0; i < shape.r.size(); ++i) {
            double r[3];
            for (int c = 0; c < 3; ++c)
                r[c] = at[c] + m[c][0] * shape.r[i][0] + m[c][1] * shape.r[i][1] + m[c][2] * shape.r[i][2];
            scene.atoms.push_back({k + 1, shape.types[i], r[0], r[1], r[2]});
        }
        for (const auto &bond : shape.bonds) scene.bonds.push_back({first + bond[0], first + bond[1]});
        for (const auto &angle : shape.angles)
            scene.angles.push_back({first + angle[0], first + angle[1], first + angle[2]});
    }
    return scene;
}

void list(const char *title, const std::vector<std::vector<int>> &entries) {
    if (entries.empty()) return;
    std::printf("\n%s\n\n", title);
    for (std::size_t k = 0; k < entries.size(); ++k) {
        std::printf("%zu 1", k + 1);
        for (int atom : entries[k]) std::printf(" %d", atom);
        std::printf("\n");
    }
}

void print(const Scene &scene) {
    std::printf("made by make_scene\n\n%zu atoms\n%zu bonds\n%zu angles\n2 atom types\n1 bond types\n1 angle types\n\n",
                scene.atoms.size(), scene.bonds.size(), scene.angles.size());
    const char *axes[3] = {"xlo xhi", "ylo yhi", "zlo zhi"};
    for (int c = 0; c < 3; ++c) {
        const double half = scene.box[c] > 0 ? 0 : 0.5;
        std::printf("%g %.17g %s\n", -half, scene.box[c] + half, axes[c]);
    }
    std::printf("\nAtoms # molecular\n\n");
    for (std::size_t k = 0; k < scene.atoms.size(); ++k) {
        const Atom &a = scene.atoms[k];
        std::printf("%zu %d %d %.17g %.17g %.17g\n", k + 1, a.molecule, a.type, a.x, a.y, a.z);
    }
    list("Bonds", scene.bonds);
    list("Angles", scene.angles);
}

}  // namespace

int main(int argc, char **argv) {
    if (argc < 3) {
        std::fprintf(stderr,
                     "make_scene melt|sheet N_CHAINS N_BEADS | line N | dimers|trimers|waters|stars|lines|methanes N | "
                     "bent N ANGLE\n");
        return 2;
    }
    const int n = std::atoi(argv[2]);
    const double last = argc > 3 ? std::atof(argv[3]) : 0;
    if (!strcmp(argv[1], "melt") || !strcmp(argv[1], "sheet"))
        print(melt(n, static_cast<int>(last), !strcmp(argv[1], "sheet")));
    else if (!strcmp(argv[1], "line"))
        print(line(n));
    else
        print(lattice(argv[1], n, last));
    return 0;
}
