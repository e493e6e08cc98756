#include "melt_run.hpp"

#include <algorithm>
#include <cmath>

#include "random.h"
#include "stopwatch.hpp"

namespace bench {
namespace {

const double cutoff_square = 1.2599210498948732;  // 2^(1/3): the WCA potential ends at 2^(1/6)
const double list_radius = 1.45;

/// Site number `step` of a path that visits a cubic lattice, each site a neighbour of the one before.
void lattice_site(std::size_t step, std::size_t side, double *r) {
    const std::size_t z = step / (side * side), y = step / side % side, x = step % side;
    const std::size_t turned = z % 2 ? side - 1 - y : y, row = z * side + y;
    r[0] = static_cast<double>(row % 2 ? side - 1 - x : x);
    r[1] = static_cast<double>(turned);
    r[2] = static_cast<double>(z);
}

Problem start(std::int64_t n_chains, std::int64_t n_bonds, double dt) {
    Problem p;
    p.name = "melt";
    p.chains = n_chains;
    p.bonds = n_bonds;
    p.dt = dt;
    p.mass.assign(p.n() + 1, 1);
    p.w = p.mass;
    p.length.assign(p.n(), 1);
    p.r.resize(3 * p.n_chains() * (p.n() + 1));
    p.v.resize(p.r.size());
    random_stream s = random_seed(3);
    const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(p.atoms()))));
    for (std::size_t i = 0; i < p.atoms(); ++i) lattice_site(i, side, &p.r[3 * i]);
    for (double &v : p.v) v = random_normal(&s);
    p.f = p.raw_v = p.v;
    p.drifted = p.r;
    return p;
}

}  // namespace

MeltRun::MeltRun(std::int64_t n_chains, std::int64_t n_bonds, double dt)
    : problem_(start(n_chains, n_bonds, dt)), side_(std::cbrt(static_cast<double>(problem_.atoms()) / 0.85)),
      state_(problem_, Level::position), f_(problem_.r.size()) {
    list_pairs();
    forces();
}

double MeltRun::image(double x) const { return x - side_ * std::nearbyint(x / side_); }

/// Pairs within reach, by cells.
void MeltRun::list_pairs() {
    const std::vector<double> &r = problem_.r;
    const auto cells = static_cast<std::size_t>(side_ / list_radius);
    std::vector<std::vector<std::size_t>> members(cells * cells * cells);
    auto cell = [&](double x) {
        const double part = x / side_ - std::floor(x / side_);
        return std::min(static_cast<std::size_t>(part * static_cast<double>(cells)), cells - 1);
    };
    pairs_.clear();
    for (std::size_t i = 0; i < problem_.atoms(); ++i) {
        const std::size_t at[3] = {cell(r[3 * i]), cell(r[3 * i + 1]), cell(r[3 * i + 2])};
        for (std::size_t n = 0; n < 27; ++n) {
            const std::size_t x = (at[0] + n / 9 + cells - 1) % cells, y = (at[1] + n / 3 % 3 + cells - 1) % cells,
                              z = (at[2] + n % 3 + cells - 1) % cells;
            for (std::size_t j : members[(x * cells + y) * cells + z]) {
                const bool bonded = i - j == 1 && i % (problem_.n() + 1) != 0;
                double square = 0;
                for (std::size_t k = 0; k < 3; ++k) square += std::pow(image(r[3 * i + k] - r[3 * j + k]), 2);
                if (!bonded && square < list_radius * list_radius) pairs_.emplace_back(i, j);
            }
        }
        members[(at[0] * cells + at[1]) * cells + at[2]].push_back(i);
    }
    at_list_ = r;
}

void MeltRun::forces() {
    const std::vector<double> &r = problem_.r;
    const double margin = (list_radius - std::sqrt(cutoff_square)) / 2;
    for (std::size_t i = 0; i < r.size(); i += 3) {
        double square = 0;
        for (std::size_t x = i; x < i + 3; ++x) square += (r[x] - at_list_[x]) * (r[x] - at_list_[x]);
        if (square > margin * margin) {
            list_pairs();
            break;
        }
    }
    std::fill(f_.begin(), f_.end(), 0.0);
    potential_ = 0;
    for (const auto &pair : pairs_) {
        const std::size_t i = 3 * pair.first, j = 3 * pair.second;
        const double d[3] = {image(r[i] - r[j]), image(r[i + 1] - r[j + 1]), image(r[i + 2] - r[j + 2])};
        const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (square >= cutoff_square) continue;
        const double inverse6 = 1 / (square * square * square);
        potential_ += 4 * inverse6 * (inverse6 - 1) + 1;
        const double push = 24 * inverse6 * (2 * inverse6 - 1) / square;
        for (std::size_t x = 0; x < 3; ++x) {
            f_[i + x] += push * d[x];
            f_[j + x] -= push * d[x];
        }
    }
}

void MeltRun::timed(const Method &method) {
    const Stopwatch watch(1);
    method.call(state_);
    seconds_ += watch.seconds();
}

void MeltRun::step(const Constraints &constraints) {
    const double dt = problem_.dt;
    std::vector<double> &drifted = problem_.drifted, &v = state_.v;
    for (std::size_t i = 0; i < v.size(); ++i) {
        v[i] += dt / 2 * f_[i];
        state_.r[i] = drifted[i] = problem_.r[i] + dt * v[i];
    }
    timed(constraints.positions);
    for (std::size_t i = 0; i < v.size(); ++i) {
        v[i] += (state_.r[i] - drifted[i]) / dt;
        problem_.r[i] = state_.r[i];
    }
    forces();
    for (std::size_t i = 0; i < v.size(); ++i) v[i] += dt / 2 * f_[i];
    timed(constraints.velocities);
}

double MeltRun::kinetic() const {
    double sum = 0;
    for (double v : state_.v) sum += v * v;
    return sum / 2;
}

void MeltRun::rescale() {
    const double freedom = static_cast<double>(3 * problem_.atoms() - problem_.all_bonds());
    const double factor = std::sqrt(freedom / 2 / kinetic());
    for (double &v : state_.v) v *= factor;
}

void MeltRun::load(const Point &point) {
    problem_.r = state_.r = point.r;
    state_.v = point.v;
    list_pairs();
    forces();
}

}  // namespace bench
