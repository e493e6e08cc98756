// Conformations: each atom at the length of its bonds from those before it, in a direction chosen at random.
#include <algorithm>
#include <array>
#include <cmath>

#include "kind.hpp"

namespace bench {
namespace {

using Vector = std::array<double, 3>;

Vector operator+(const Vector &a, const Vector &b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vector operator-(const Vector &a, const Vector &b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector operator*(double x, const Vector &a) { return {x * a[0], x * a[1], x * a[2]}; }
double dot(const Vector &a, const Vector &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector &a, const Vector &b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector unit(const Vector &a) { return 1 / std::sqrt(dot(a, a)) * a; }

const double pi = std::acos(-1.0);

class Placement {
public:
    Placement(const Kind &kind, random_stream &s, double *r)
        : kind_(kind), s_(s), r_(r), there_(kind.n_atoms(), false), start_(kind.n_atoms() + 1),
          next_(2 * kind.n_bonds()), length_(2 * kind.n_bonds()) {
        for (std::size_t k = 0; k < kind.n_bonds(); ++k)
            ++start_[at(kind.first[k]) + 1], ++start_[at(kind.second[k]) + 1];
        for (std::size_t i = 0; i < kind.n_atoms(); ++i) start_[i + 1] += start_[i];
        std::vector<std::size_t> fill(start_.begin(), start_.end() - 1);
        for (std::size_t k = 0; k < kind.n_bonds(); ++k) {
            const int ends[2] = {kind.first[k], kind.second[k]};
            for (int e = 0; e < 2; ++e) {
                next_[fill[at(ends[e])]] = ends[1 - e];
                length_[fill[at(ends[e])]++] = kind.length[k];
            }
        }
    }

    void run() {
        if (kind_.closed_walk) return closed_walk();
        put(0, {0, 0, 0});
        std::vector<const std::vector<int> *> polygon_of(kind_.n_atoms(), nullptr);
        for (const auto &polygon : kind_.polygons)
            for (std::size_t i = 1; i < polygon.size(); ++i) polygon_of[at(polygon[i])] = &polygon;
        for (std::size_t i = 1; i < kind_.n_atoms(); ++i) {
            if (there_[i]) continue;
            if (polygon_of[i])
                polygon(*polygon_of[i]);
            else
                one(static_cast<int>(i));
        }
    }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    Vector get(int i) const { return {r_[3 * at(i)], r_[3 * at(i) + 1], r_[3 * at(i) + 2]}; }
    void put(int i, const Vector &x) {
        std::copy(x.begin(), x.end(), r_ + 3 * i);
        there_[at(i)] = true;
    }
    Vector any() {
        Vector u;
        random_direction(&s_, u.data());
        return u;
    }
    Vector across(const Vector &axis) { return unit(cross(axis, any())); }

    /// Directions from atom i to those of its neighbours that are there.
    std::vector<Vector> around(int i) const {
        std::vector<Vector> list;
        for (std::size_t e = start_[at(i)]; e < start_[at(i) + 1]; ++e)
            if (there_[at(next_[e])]) list.push_back(unit(get(next_[e]) - get(i)));
        return list;
    }

    void one(int i) {
        std::vector<std::size_t> bonds;
        for (std::size_t e = start_[at(i)]; e < start_[at(i) + 1]; ++e)
            if (there_[at(next_[e])]) bonds.push_back(e);
        const int a = next_[bonds[0]];
        if (bonds.size() == 1) return put(i, get(a) + length_[bonds[0]] * direction_from(a));
        // Anywhere on the circle that has both distances.
        const Vector axis = get(next_[bonds[1]]) - get(a);
        const double l0 = length_[bonds[0]], l1 = length_[bonds[1]], c = std::sqrt(dot(axis, axis));
        const double along = (l0 * l0 - l1 * l1 + c * c) / (2 * c), out = std::sqrt(l0 * l0 - along * along);
        put(i, get(a) + along / c * axis + out * across(axis));
    }

    Vector direction_from(int a) {
        const std::vector<Vector> others = around(a);
        const std::size_t valence = start_[at(a) + 1] - start_[at(a)];
        if (others.empty()) return any();
        if (kind_.chemical) return chemical_direction(others, valence);
        for (int attempt = 0;; ++attempt) {  // not within 60 degrees of another bond, if there is room
            const Vector u = any();
            const bool free =
                std::all_of(others.begin(), others.end(), [&](const Vector &o) { return dot(o, u) < 0.5; });
            if (free || attempt == 100) return u;
        }
    }

    /// At tetrahedral angles to the others, or at 120 degrees if there are three neighbours.
    Vector chemical_direction(const std::vector<Vector> &others, std::size_t valence) {
        const double angle = valence == 3 ? 2 * pi / 3 : std::acos(-1.0 / 3);
        if (others.size() == 1) return std::cos(angle) * others[0] + std::sin(angle) * across(others[0]);
        Vector sum = {0, 0, 0};
        for (const Vector &o : others) sum = sum - o;
        if (others.size() == 2 && valence >= 4) {
            const Vector normal = unit(cross(others[0], others[1]));
            return std::sqrt(1.0 / 3) * unit(sum) + std::sqrt(2.0 / 3) * normal;
        }
        return unit(sum);
    }

    /// A regular polygon, as its first bond is long, away from what its first atom is bonded to.
    void polygon(const std::vector<int> &atoms) {
        const double n = static_cast<double>(atoms.size()), length = length_between(atoms[0], atoms[1]);
        const double radius = length / (2 * std::sin(pi / n));
        const std::vector<Vector> others = around(atoms[0]);
        const Vector out = others.empty() ? any() : -1.0 * others[0], side = across(out);
        const Vector middle = get(atoms[0]) + radius * out;
        for (std::size_t k = 1; k < atoms.size(); ++k) {
            const double angle = 2 * pi * static_cast<double>(k) / n;
            put(atoms[k], middle - radius * (std::cos(angle) * out - std::sin(angle) * side));
        }
    }

    double length_between(int i, int j) const {
        for (std::size_t e = start_[at(i)]; e < start_[at(i) + 1]; ++e)
            if (next_[e] == j) return length_[e];
        return 0;
    }

    /// Random steps, then by turns their sum taken from all of them and each brought to unit length.
    void closed_walk() {
        const std::size_t n = kind_.n_atoms();
        std::vector<Vector> step(n);
        for (Vector &u : step) u = any();
        for (int turn = 0; turn < 100; ++turn) {
            Vector sum = {0, 0, 0};
            for (const Vector &u : step) sum = sum + u;
            for (Vector &u : step) u = unit(u - 1 / static_cast<double>(n) * sum);
        }
        Vector here = {0, 0, 0};
        for (std::size_t i = 0; i < n; ++i) {
            put(static_cast<int>(i), here);
            here = here + step[i];
        }
    }

    const Kind &kind_;
    random_stream &s_;
    double *r_;
    std::vector<bool> there_;
    std::vector<std::size_t> start_;  ///< atom i has the neighbours next_[start_[i]] .. next_[start_[i+1]-1]
    std::vector<int> next_;
    std::vector<double> length_;
};

}  // namespace

void place_atoms(const Kind &kind, random_stream &s, double *r) { Placement(kind, s, r).run(); }

}  // namespace bench
