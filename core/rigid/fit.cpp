#include "core/rigid/fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.hpp"
#include "core/rigid/heights.hpp"

namespace holonomic::rigid {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// What full digits leave open. Fewer than five atoms are independent wherever they are not flat to rounding. Five and
// more depend anyway: out of their plane by 1e-6 of their size, they miss no length by more.
constexpr double of_few = 16 * epsilon, of_many = 1e-12;

// Gauss's and Newton's method: equations of all distances by conjugate gradients, which leave motions as a whole alone.
class Fit {
public:
    Fit(const Distances &wanted, int dimension, std::vector<double> &x) : dimension_(dimension), x_(x) {
        for (std::int64_t i = 0; i < wanted.n; ++i)
            for (std::int64_t j = 0; j < i; ++j)
                if (wanted.at(i, j) > 0) pairs_.push_back({i, j, wanted.at(i, j), 0, {}});
    }

    void run() {
        double before = std::numeric_limits<double>::infinity();
        for (int round = 0; round < 30; ++round) {
            const double square = measure();
            if (!(square < before * (1 - 1e-12))) break;
            before = square;
            best_ = x_;
            step();
        }
        x_ = best_;
    }

private:
    struct PairOfAtoms {
        std::int64_t i, j;
        double length, missing, along[3];
    };
    using Vector = std::vector<double>;

    double measure() {
        double sum = 0;
        for (PairOfAtoms &pair : pairs_) {
            double square = 0;
            for (int c = 0; c < dimension_; ++c) {
                pair.along[c] = x_[at(3 * pair.i + c)] - x_[at(3 * pair.j + c)];
                square += pair.along[c] * pair.along[c];
            }
            const double distance = std::sqrt(square);
            for (int c = 0; c < dimension_; ++c) pair.along[c] /= distance;
            pair.missing = pair.length - distance;
            sum += pair.missing * pair.missing;
        }
        return sum;
    }
    Vector stretch(const Vector &move) const {
        Vector out;
        for (const PairOfAtoms &pair : pairs_) {
            double sum = 0;
            for (int c = 0; c < dimension_; ++c)
                sum += pair.along[c] * (move[at(3 * pair.i + c)] - move[at(3 * pair.j + c)]);
            out.push_back(sum);
        }
        return out;
    }
    Vector pull(const Vector &tension) const {
        Vector out(x_.size(), 0.0);
        for (std::size_t k = 0; k < pairs_.size(); ++k)
            for (int c = 0; c < dimension_; ++c) {
                out[at(3 * pairs_[k].i + c)] += pairs_[k].along[c] * tension[k];
                out[at(3 * pairs_[k].j + c)] -= pairs_[k].along[c] * tension[k];
            }
        return out;
    }
    static double square(const Vector &a) {
        double sum = 0;
        for (const double x : a) sum += x * x;
        return sum;
    }
    void step() {
        Vector residual;
        for (const PairOfAtoms &pair : pairs_) residual.push_back(pair.missing);
        Vector gradient = pull(residual), direction = gradient;
        double size = square(gradient);
        const double enough = 1e-28 * size;
        for (std::size_t k = 0; k < 2 * x_.size() && size > enough; ++k) {
            const Vector change = stretch(direction);
            const double factor = size / square(change);
            if (!std::isfinite(factor)) return;
            for (std::size_t e = 0; e < x_.size(); ++e) x_[e] += factor * direction[e];
            for (std::size_t e = 0; e < residual.size(); ++e) residual[e] -= factor * change[e];
            gradient = pull(residual);
            const double next = square(gradient);
            for (std::size_t e = 0; e < x_.size(); ++e) direction[e] = gradient[e] + next / size * direction[e];
            size = next;
        }
    }

    const int dimension_;
    std::vector<double> &x_, best_;
    std::vector<PairOfAtoms> pairs_;
};

// Of the square of a height, relative to the largest, which independence is a matter of for few atoms.
double of_heights(const Distances &wanted) { return 2 * epsilon * static_cast<double>(wanted.n - 2); }

bool is_float(double x) { return static_cast<double>(static_cast<float>(x)) == x; }

// Numbers of so many decimals, or square roots of those.
struct Grid {
    int decimals;
    bool of_squares;
    // To a few roundings of doubles, or of floats that became doubles. chance: times that of any number.
    bool has(double length, double &chance) const {
        constexpr double of_float = 0.51 * std::numeric_limits<float>::epsilon();
        const double scale = std::pow(10.0, decimals);
        const double x = of_squares ? length * scale * (length * scale) : length * scale;
        // Coordinates far from the origin are off by more than these squares are.
        const double of_coordinates = of_squares ? std::min(1e-12 * scale * scale, 0.03) : 0;
        const double margin = std::max((is_float(length) ? of_float : 4 * epsilon) * x, of_coordinates);
        chance *= std::min(1.0, 2 * margin);
        return x >= 0.5 && std::fabs(x - std::round(x)) <= margin;
    }
    bool has_all(const std::vector<double> &values, double &chance) const {
        return std::all_of(values.begin(), values.end(), [&](double value) { return has(value, chance); });
    }
    // Most lengths of the molecule beside the group's, which are on the grid.
    bool has_most(const std::vector<double> &molecule, std::ptrdiff_t n_of_group) const {
        double chance = 1;
        const auto on_grid =
            std::count_if(molecule.begin(), molecule.end(), [&](double value) { return has(value, chance); });
        const auto others = static_cast<std::ptrdiff_t>(molecule.size()) - n_of_group;
        return others <= 0 || 2 * (on_grid - n_of_group) > others;
    }
};

// The least number of decimals that all values have; -1 if more than `most`, or if so many decimals are all that a
// number of this size has: what is as near by chance is not rounded. Few values are never sure, and the molecule's
// others decide.
int decimals_of(const std::vector<double> &values, int most, bool of_squares, double likely = 3e-4,
                const MoleculeLengths &molecule = nullptr) {
    constexpr double sure = 1e-9;
    for (int p = 0; p <= most; ++p) {
        double chance = 1;
        const Grid grid{p, of_squares};
        if (!grid.has_all(values, chance)) continue;
        const bool rounded =
            chance < sure ||
            (chance < likely && (!molecule || grid.has_most(molecule(), static_cast<std::ptrdiff_t>(values.size()))));
        return rounded ? p : -1;
    }
    return -1;
}

// Fewer than three decimals are a round number, not a rounded one.
constexpr int few_decimals = 3;

// The coarsest of the roundings that single lengths show: others may have more decimals, or full digits.
struct Roundings {
    double coarsest = 0;
    double with_zeros = 0;  // the same, if round numbers have lost zeros at their ends
    std::ptrdiff_t count = 0;
};
Roundings roundings_of(const std::vector<double> &values) {
    constexpr double likely = 1e-8;  // of one value: there are many lengths in a set
    Roundings found;
    for (const double value : values) {
        const int p = decimals_of({value}, 9, false, likely);
        const double rounded = p >= few_decimals          ? std::pow(10.0, -p)
                               : p < 0 && is_float(value) ? std::numeric_limits<float>::epsilon() * value
                                                          : 0;
        found.coarsest = std::max(found.coarsest, rounded);
        found.with_zeros = std::max(found.with_zeros, p < 0 ? rounded : std::pow(10.0, -std::max(p, few_decimals)));
        found.count += p >= 0 || rounded > 0;
    }
    return found;
}

// Whether coordinates on a grid of so many decimals would be on a line or in a plane: what is off it then is no
// rounding.
bool are_flat_on_grid(const Distances &wanted, int decimals) {
    const double scale = std::pow(10.0, 2 * decimals);
    std::vector<double> squares(wanted.length), coordinates;
    for (std::int64_t i = 0; i < wanted.n; ++i)
        for (std::int64_t j = 0; j < i; ++j)
            if (!(wanted.at(i, j) > 0)) return false;  // not all are held
    for (double &x : squares) x = std::round(x * x * scale) / scale;
    return coordinates_in(static_cast<int>(wanted.n) - 2, wanted.n, squares.data(), coordinates) <= of_heights(wanted);
}

}  // namespace

Misfit misfit_of(const Distances &wanted, const std::vector<double> &coordinates) {
    Misfit worst{0, 0, 0, 0};
    for (std::int64_t i = 0; i < wanted.n; ++i)
        for (std::int64_t j = 0; j < i; ++j) {
            const double length = wanted.at(i, j);
            if (!(length > 0)) continue;
            double square = 0;
            for (int c = 0; c < 3; ++c) square += std::pow(coordinates[at(3 * i + c)] - coordinates[at(3 * j + c)], 2);
            const double distance = std::sqrt(square), error = std::fabs(distance - length) / length;
            if (!(error <= worst.error)) worst = {error, i, j, distance};
        }
    return worst;
}

// Differences of squares, |x - p|^2 - |x - p_0|^2, are linear in x: the least sum of squares of these.
bool locate(const Distances &wanted, int dimension, std::vector<double> &coordinates) {
    double A[3][4] = {}, largest = 0;
    const double *const first = coordinates.data() + 3;
    for (std::int64_t i = 2; i < wanted.n; ++i) {
        double row[4] = {0, 0, 0, (std::pow(wanted.at(1, 0), 2) - std::pow(wanted.at(i, 0), 2)) / 2};
        for (int c = 0; c < dimension; ++c) {
            row[c] = coordinates[at(3 * i + c)] - first[c];
            row[3] += row[c] * row[c] / 2;
        }
        for (int b = 0; b < dimension; ++b)
            for (int c = 0; c < 4; ++c) A[b][c] += row[b] * row[c];
    }
    for (int b = 0; b < dimension; ++b) largest = std::max(largest, A[b][b]);
    for (int b = 0; b < dimension; ++b) {
        if (!(A[b][b] > 1e-3 * largest)) return false;
        for (int r = b + 1; r < dimension; ++r)
            for (int c = 3; c >= b; --c) A[r][c] -= A[r][b] / A[b][b] * A[b][c];
    }
    for (int b = dimension - 1; b >= 0; --b) {
        double x = A[b][3];
        for (int c = b + 1; c < dimension; ++c) x -= A[b][c] * (coordinates[at(c)] - first[c]);
        coordinates[at(b)] = first[b] + x / A[b][b];
    }
    return true;
}

Misfit fit_coordinates(const Distances &wanted, int dimension, std::vector<double> &coordinates) {
    for (std::size_t e = 0; e < coordinates.size(); ++e)
        if (static_cast<int>(e % 3) >= dimension) coordinates[e] = 0;
    const Misfit misfit = misfit_of(wanted, coordinates);
    if (misfit.error <= rounding) return misfit;
    Fit(wanted, dimension, coordinates).run();
    return misfit_of(wanted, coordinates);
}

std::vector<double> each_once(std::vector<double> lengths) {
    std::sort(lengths.begin(), lengths.end());
    const auto alike = [](double a, double b) { return b - a <= 8 * epsilon * b; };
    lengths.erase(std::unique(lengths.begin(), lengths.end(), alike), lengths.end());
    if (!lengths.empty() && lengths.front() == 0) lengths.erase(lengths.begin());
    return lengths;
}

Decimals::Decimals(const Distances &wanted, double tolerance, const MoleculeLengths &all)
    : open_(wanted.n < 5 ? of_few : of_many), most_(rounding) {
    const std::vector<double> values = each_once(wanted.length);  // 0: none is held
    if (values.empty()) return;
    const double least = values.front();
    const int of_lengths = decimals_of(values, 12, false, 3e-4, all);
    const Roundings singles = roundings_of(values);
    // Coordinates leave few distances with decimals of their own: those along an axis.
    const bool may_be_coordinates = of_lengths < 0 && 2 * singles.count < static_cast<std::ptrdiff_t>(values.size());
    int of_coordinates = may_be_coordinates ? decimals_of(values, 6, true, 3e-4, all) : -1;
    if (of_coordinates >= 0 && wanted.n < 5 && are_flat_on_grid(wanted, of_coordinates)) of_coordinates = -1;
    // Two rounded bonds say nothing of a third distance that is given in full: the angle may be nearly 180 degrees.
    const auto n_values = static_cast<std::ptrdiff_t>(values.size());
    const bool most_are = wanted.n == 3 ? singles.count == n_values : 2 * singles.count > n_values;
    const double of_single = of_coordinates < 0 && most_are ? singles.coarsest : 0;
    if (of_lengths >= 0) open_ = std::max(open_, std::pow(10.0, -std::max(of_lengths, few_decimals)) / least);
    if (of_coordinates >= 0)
        open_ = std::max(open_, 2 * std::pow(10.0, -2 * std::max(of_coordinates, few_decimals)) / (least * least));
    open_ = std::max(open_, of_single / least);
    are_full_ = of_lengths < 0 && of_coordinates < 0 && of_single == 0;
    if (are_full_ && wanted.n < 5) highest_ = of_heights(wanted);
    const double with_zeros = most_are ? std::max(open_, singles.with_zeros / least) : open_;
    if (tolerance > 0) most_ = std::max(tolerance, std::min(with_zeros, 10 * tolerance));
}

FittedGroup look_at(const Distances &wanted, double tolerance, const MoleculeLengths &all) {
    // A group whose square of a height is above this part of the largest square is far from flat, for any tolerance.
    constexpr double high = 0.05;
    const std::int64_t n = wanted.n;
    const int most = static_cast<int>(std::min<std::int64_t>(3, n - 2));
    std::vector<double> squares(wanted.length);
    for (double &x : squares) x *= x;
    FittedGroup group{FittedGroup::independent, most, {}, {}};
    for (int d = 1; d <= most; ++d) {
        const double left = coordinates_in(d, n, squares.data(), group.coordinates);
        const bool impossible = d == 3 || (d == most && left < 0);  // they fit no place in space
        if (!impossible && left > high) continue;
        const Decimals decimals(wanted, tolerance, all);
        group.dimension = d;
        group.misfit = fit_coordinates(wanted, d, group.coordinates);
        const bool must = impossible && !decimals.allow_position(group.misfit);
        group.kind = decimals.allow(left, group.misfit) || (must && group.misfit.error <= decimals.most())
                         ? FittedGroup::dependent
                     : must && n > 3 ? FittedGroup::impossible
                                     : FittedGroup::independent;
        if (group.kind != FittedGroup::independent) return group;
    }
    return group;
}

}  // namespace holonomic::rigid
