// Parts that linear relations alone hold together.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/index.hpp"
#include "core/rigid/body.hpp"

namespace holonomic::rigid {

namespace {

// Vectors over the atoms, which are made orthogonal by Gram and Schmidt's method, the longest one first.
class Orthogonalization {
public:
    Orthogonalization(const double *masses, std::size_t n, const DoublePair &mass)
        : masses_(masses), n_(n), mass_(mass) {}

    using Vector = std::vector<DoublePair>;
    // To those that begin, which are not returned.
    std::vector<Vector> orthonormal(std::vector<Vector> all, std::size_t count,
                                    const std::vector<Vector> &begin) const {
        std::vector<Vector> found;
        for (const Vector &other : begin) take_away(all, other);
        while (found.size() < count) {
            const auto longest = std::max_element(all.begin(), all.end(), [this](const Vector &a, const Vector &b) {
                return product(a, a).hi < product(b, b).hi;
            });
            Vector next = std::move(*longest);
            all.erase(longest);
            for (int pass = 0; pass < 2; ++pass) {
                std::vector<Vector> alone{std::move(next)};
                for (const Vector &other : begin) take_away(alone, other);
                for (const Vector &other : found) take_away(alone, other);
                next = std::move(alone[0]);
            }
            const DoublePair square = product(next, next);
            if (!(square.hi > least)) return found;
            const DoublePair size = plain::square_root(square);
            for (DoublePair &y : next) y = y / size;
            take_away(all, next);
            found.push_back(std::move(next));
        }
        return found;
    }

    // What masses do not see of it.
    Vector rest(Vector vector, const std::vector<Vector> &of) const {
        std::vector<Vector> alone{std::move(vector)};
        for (const Vector &other : of) take_away(alone, other);
        return std::move(alone[0]);
    }

private:
    // What is shorter stands for atoms without mass alone, whose coordinates nothing determines.
    static constexpr double least = 1e-20;

    DoublePair product(const Vector &a, const Vector &b) const {
        DoublePair sum = as_pair(0);
        for (std::size_t i = 0; i < n_; ++i) sum = sum + masses_[i] * (a[i] * b[i]);
        return sum / mass_;
    }
    void take_away(std::vector<Vector> &from, const Vector &unit) const {
        for (Vector &vector : from) {
            const DoublePair part = product(vector, unit);
            for (std::size_t i = 0; i < n_; ++i) vector[i] = vector[i] - part * unit[i];
        }
    }

    const double *const masses_;
    const std::size_t n_;
    const DoublePair mass_;
};

}  // namespace

Body make_affine(const double *masses, const Relations &relations, double extent) {
    const std::int32_t n = relations.n_atoms;
    Body body;
    body.is_rigid = false;
    body.relations = relations;
    body.n_atoms = n;
    body.masses.assign(masses, masses + n);
    body.coordinates.assign(3 * at(n), 0);
    body.n_massive = static_cast<std::int32_t>(std::count_if(masses, masses + n, [](double m) { return m > 0; }));
    if (body.n_massive == 0) throw BodyFault{BodyFault::no_mass, -1};
    DoublePair mass = as_pair(0);
    for (std::int32_t i = 0; i < n; ++i) mass = mass + as_pair(masses[i]);
    body.mass = rounded(mass);
    body.inverse_mass = 1 / body.mass;
    body.extent = extent;
    body.is_thick = false;
    for (int p = 0; p < 3; ++p) body.length[p] = 0, body.square[p] = as_pair(0);

    const Leaders leaders = leaders_of(relations, 1e-10);
    if (!leaders.left_out.empty()) throw BodyFault{BodyFault::twice, leaders.left_out[0]};
    const std::size_t count = leaders.atoms.size();
    std::vector<Orthogonalization::Vector> columns(count, Orthogonalization::Vector(at(n)));
    for (std::size_t i = 0; i < at(n); ++i)
        for (std::size_t l = 0; l < count; ++l) columns[l][i] = leaders.of[i * count + l];
    const Orthogonalization basis(masses, at(n), mass);
    std::vector<Orthogonalization::Vector> y{Orthogonalization::Vector(at(n), as_pair(1))};
    const bool is_free = relations.n_fixed == 0;
    if (!is_free) y.clear();
    if (count == 0) throw BodyFault{BodyFault::held, -1};
    for (Orthogonalization::Vector &vector : basis.orthonormal(std::move(columns), count - y.size(), y))
        y.push_back(std::move(vector));
    if (y.size() < count) throw BodyFault{BodyFault::undetermined, -1};
    body.rank = static_cast<std::int32_t>(y.size()) - 1;
    if (!is_free) body.first = y[0];
    for (std::size_t i = 0; i < at(n); ++i)
        for (std::size_t p = 0; p < y.size(); ++p) {
            if (p > 0) body.y.push_back(y[p][i]);
            body.share.push_back((masses[i] * y[p][i]) / mass);
        }
    const std::size_t n_fixed = at(relations.n_fixed);
    body.of_fixed.resize(at(n) * n_fixed);
    for (std::size_t j = 0; j < n_fixed; ++j) {
        Orthogonalization::Vector follows(at(n));
        for (std::size_t i = 0; i < at(n); ++i) follows[i] = leaders.of_fixed[i * n_fixed + j];
        follows = basis.rest(std::move(follows), y);
        for (std::size_t i = 0; i < at(n); ++i) body.of_fixed[i * n_fixed + j] = follows[i];
    }
    return body;
}

}  // namespace holonomic::rigid
