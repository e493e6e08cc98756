#include "scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

using Point = std::array<double, 3>;

Point Builder::direction() {
    Point d;
    double square;
    do {
        square = 0;
        for (double &x : d) x = 2 * uniform() - 1, square += x * x;
    } while (square > 1 || square < 1e-4);
    for (double &x : d) x /= std::sqrt(square);
    return d;
}

int Builder::atom(double mass, const Point &at) {
    scene.masses.push_back(mass);
    scene.r.insert(scene.r.end(), at.begin(), at.end());
    return static_cast<int>(scene.masses.size()) - 1;
}

Point Builder::at(int atom) const { return {scene.r[3 * atom], scene.r[3 * atom + 1], scene.r[3 * atom + 2]}; }

int Builder::strand(int a, int n_bonds, double mass, double stiff, Point along) {
    for (int k = 0; k < n_bonds; ++k) {
        const Point d = direction();
        Point next = at(a);
        for (int c = 0; c < 3; ++c) along[c] = stiff * along[c] + (1 - stiff) * d[c];
        const double length = std::sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
        for (int c = 0; c < 3; ++c) along[c] /= length, next[c] += along[c];
        const int b = atom(mass, next);
        bond(a, b);
        a = b;
    }
    return a;
}

Scene Builder::finish(int n_pieces, bool slabs) {
    Scene &s = scene;
    for (std::size_t k = 0; k < s.pairs.size(); k += 2) {
        const Point a = at(static_cast<int>(s.pairs[k])), b = at(static_cast<int>(s.pairs[k + 1]));
        s.lengths.push_back(std::sqrt(std::pow(b[0] - a[0], 2) + std::pow(b[1] - a[1], 2) + std::pow(b[2] - a[2], 2)));
    }
    for (std::size_t k = 0; k < s.r.size(); ++k) {
        const double mass = s.masses[k / 3];
        s.v.push_back(mass > 0 ? normal() / std::sqrt(mass) : 0);
        s.f.push_back(10 * normal());
    }
    std::vector<int> order(s.masses.size());
    std::iota(order.begin(), order.end(), 0);
    if (slabs) std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return s.r[3 * a] < s.r[3 * b]; });
    s.owner.resize(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) s.owner[order[k]] = static_cast<int>(k * n_pieces / order.size());
    return s;
}

namespace {

/** A backbone of three atoms a residue; side chains that branch, with hydrogens, and rings of six in a third of them.
 */
void add_protein(Builder &b, int n_bonds) {
    int last = b.atom(14, {0, 0, 0});
    for (int residue = 0; static_cast<int>(b.scene.pairs.size() / 2) < n_bonds; ++residue) {
        const int alpha = b.strand(last, 1, 12, 0.3, b.direction());
        const int carbon = b.strand(alpha, 1, 12, 0.3, b.direction());
        b.strand(carbon, 1, 16, 0, b.direction());
        last = b.strand(carbon, 1, 14, 0.3, b.direction());
        b.strand(last, 1, 1, 0, b.direction());
        b.strand(alpha, 1, 1, 0, b.direction());
        int side = b.strand(alpha, 1 + residue % 4, 12, 0.5, b.direction());
        b.strand(side, 1, 1, 0, b.direction());
        if (residue % 3) continue;
        // A ring, a little out of its plane
        const Point from = b.at(side);
        int before = side;
        for (int k = 1; k < 6; ++k) {
            const double angle = std::acos(-1.0) * k / 3;
            const int next = b.atom(12, {from[0] + 1.4 * (1 - std::cos(angle)), from[1] + 1.4 * std::sin(angle),
                                         from[2] + 0.1 * b.normal()});
            b.bond(before, next);
            b.strand(next, 1, 1, 0, b.direction());
            before = next;
        }
        b.bond(before, side);
    }
}

/** Knots of a cubic lattice, strands of 100 bonds between neighbours, a fifth of them missing. loose: how much each
 * bond is away from the straight line. */
void add_gel(Builder &b, int n_bonds, double loose) {
    constexpr int n_strand = 100;
    const int side = std::max(2, static_cast<int>(std::cbrt(n_bonds / n_strand / 2.4) + 1));
    const double step = 25;
    std::vector<int> knots;
    for (int x = 0; x < side; ++x)
        for (int y = 0; y < side; ++y)
            for (int z = 0; z < side; ++z)
                knots.push_back(b.atom(1, {step * x + b.normal(), step * y + b.normal(), step * z + b.normal()}));
    const int next[3] = {side * side, side, 1};
    for (int n = 0; n < side * side * side; ++n)
        for (int c = 0; c < 3; ++c) {
            if (n / next[c] % side == side - 1 || b.uniform() < 0.2) continue;
            const Point end = b.at(knots[n + next[c]]);
            int last = knots[n];
            for (int k = 1; k < n_strand; ++k) {
                const Point from = b.at(last), d = b.direction();
                Point to;
                for (int x = 0; x < 3; ++x) to[x] = from[x] + loose * d[x] + (end[x] - from[x]) / (n_strand - k + 1);
                const int atom = b.atom(1, to);
                b.bond(last, atom);
                last = atom;
            }
            b.bond(last, knots[n + next[c]]);
        }
}

}  // namespace

/** Each atom to its place in a triclinic cell, which the molecule crosses many times. */
void wrap(Scene &s) {
    s.box = {24, 0, 0, 5, 22, 0, -3, 4, 20};
    for (std::int64_t i = 0; i < s.n_atoms(); ++i)
        for (int c = 2; c >= 0; --c) {
            const double n = std::floor(s.r[3 * i + c] / s.box[4 * c]);
            for (int x = 0; x < 3; ++x) s.r[3 * i + x] -= n * s.box[3 * c + x];
        }
}

Scene make_scene(const std::string &kind, int n_bonds, int n_pieces, const std::string &layout) {
    Builder b(static_cast<unsigned>(n_bonds));
    if (kind == "protein") {
        add_protein(b, n_bonds);
    } else if (kind == "gel") {
        add_gel(b, n_bonds, 0.9);
    } else if (kind == "taut") {
        add_gel(b, n_bonds, 0.02);
        b.scene.stiff = true;
        b.scene.time_step = 1e-4;
    } else if (kind == "flat") {
        // A chain with a triangle whose height is about 10^-n_bonds. Numbers of few decimals would be taken for rounded
        // ones, and the triangle for a straight one.
        const double height = std::sqrt(0.7) * std::pow(10, -n_bonds), side = std::sqrt(1.3);
        const int corner = b.strand(b.atom(1, {0, 0, 0}), 10, 1, 0.3, {1, 0, 0});
        const Point at = b.at(corner);
        const int middle = b.atom(1, {at[0] + side, at[1] + height, at[2]}),
                  end = b.atom(1, {at[0] + 2 * side, at[1], at[2]});
        b.bond(corner, middle), b.bond(middle, end), b.bond(corner, end);
        b.strand(end, 10, 1, 0.3, {1, 0, 0});
        b.scene.stiff = true;
    } else if (kind == "chain" || kind == "rod" || kind == "light") {
        b.strand(b.atom(1, {0, 0, 0}), n_bonds, 1, kind == "rod" ? 0.999 : 0.3, {1, 0, 0});
        if (kind == "light")  // masses over eight decades, and a fixed atom
            for (double &mass : b.scene.masses) mass = std::pow(10, 8 * b.uniform() - 4);
        if (kind == "light") b.scene.masses[n_bonds / 3] = 0;
        b.scene.stiff = kind == "rod";
        if (kind != "chain") b.scene.time_step = 1e-4;
    } else {
        throw std::runtime_error("no scene " + kind);
    }
    Scene scene = b.finish(n_pieces, layout != "blocks");
    if (layout == "box") wrap(scene);
    return scene;
}
