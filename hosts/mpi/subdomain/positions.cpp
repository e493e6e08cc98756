// Positions: Newton's method with the factors of the reference, and with new ones where these converge slowly.
#include <cmath>
#include <limits>

#include "subdomain.hpp"

namespace holonomic_subdomain {

namespace {

constexpr int most_steps = 50;
/** New factors cost as much as three or four steps with those that are there, and save as many. */
constexpr double slow = 0.01;
/** Roundings of the coordinates that are no matter for new factors any more. */
constexpr double close = 1e4;

/** The larger of worst and D.D - a^2 in units of what the rounding of the two atoms' coordinates does to it. */
HOL_SUBDOMAIN_INLINE double larger(double worst, double sigma, double a, const double *i, const double *j) {
    double extent = a;
    for (int c = 0; c < 3; ++c) extent = std::max(extent, std::max(std::fabs(i[c]), std::fabs(j[c])));
    const double unit = std::numeric_limits<double>::epsilon() * a * extent;
    return std::fabs(sigma) <= worst * unit ? worst : std::fabs(sigma) / unit;  // a NaN is taken
}

}  // namespace

/** sigma = D.D - a^2 of each bond inside, and bond vectors; gives the largest, in roundings of the coordinates. */
HOL_SUBDOMAIN_CLONES double Subdomain::excess(const double *r, double *sigma) {
    double worst = 0;
    for (int k = 0; k < n_bonds(); ++k) {
        const double *i = r + 3 * static_cast<std::size_t>(graph_.bonds[k].from),
                     *j = r + 3 * static_cast<std::size_t>(graph_.bonds[k].to), a = lengths_[k];
        now_[k] = box_.between(i, j);
        sigma[k] = is_fixed(k) ? 0 : (dot(now_[k], now_[k]) - product_of(a, a)).hi;
        worst = larger(worst, sigma[k], a, i, j);
    }
    return worst;
}

/** The same of cut bonds. */
double Subdomain::cut_excess(const double *ends, std::vector<double> &sigma) {
    double worst = 0;
    std::vector<TwiceVector> vectors(cut_lengths_.size());
    for (int k = 0; k < n_cut(); ++k, ends += 6) {
        const double a = cut_lengths_[k];
        vectors[k] = box_.between(ends, ends + 3);
        sigma[k] = cut_is_fixed(k) ? 0 : (dot(vectors[k], vectors[k]) - product_of(a, a)).hi;
        worst = larger(worst, sigma[k], a, ends, ends + 3);
    }
    for (const End &end : ends_) now_[end.row] = vectors[end.cut];
    return worst;
}

/** What multipliers do to the atoms, along the bonds of the reference. */
HOL_SUBDOMAIN_CLONES void Subdomain::move(std::vector<double> &r, const std::vector<double> &multipliers,
                                          double factor) const {
    for (int i = 0; i < n_atoms(); ++i) {
        Four sum = {0, 0, 0, 0};
        for (const Graph::At *at = graph_.begin(i); at != graph_.end(i); ++at)
            sum += at->sign * multipliers[at->row] * d_[at->row].hi;
        sum *= graph_.w[i] * factor;
        for (int c = 0; c < 3; ++c) r[3 * static_cast<std::size_t>(i) + c] -= sum[c];
    }
}

Found Subdomain::positions(std::vector<double> &r, double dt) {
    const std::size_t n = cut_lengths_.size();
    const double square = dt * dt;
    t_.assign(graph_.n_rows, 0.0);
    t_cut_.assign(n, 0.0);
    now_.resize(graph_.n_rows);
    std::vector<double> cut_sigma(n);
    Factors *factors = &reference_;
    Found found;
    double before = HUGE_VAL;
    for (;; ++found.steps) {
        std::vector<double> shared = of_ends({r.data()});
        shared.resize(6 * n + n_interface_ + processes.n_ranks(), 0.0);
        processes.alone([&] {
            dt_.assign(graph_.n_rows, 0.0);
            shared[6 * n + n_interface_ + processes.rank()] = excess(r.data(), dt_.data());
            for (double &x : dt_) x *= 0.5 / square;
            gather(*factors, dt_, shared.data() + 6 * n);
        });
        processes.add_up(shared);
        double worst = cut_excess(shared.data(), cut_sigma);
        for (std::size_t k = 6 * n + n_interface_; k < shared.size(); ++k)
            if (!(shared[k] <= worst)) worst = shared[k];
        // A few roundings of the two atoms' coordinates; some more if no step makes it less.
        if (worst <= 4 || (worst <= 32 && worst >= before / 2)) break;
        if (found.steps == most_steps || !std::isfinite(worst))
            throw Failure{HOL_ERR_NO_CONVERGENCE,
                          "bond lengths of a divided molecule can't be reached from these positions"};
        std::vector<double> solution(shared.begin() + static_cast<std::ptrdiff_t>(6 * n),
                                     shared.begin() + static_cast<std::ptrdiff_t>(6 * n + n_interface_));
        if (worst > slow * before && worst > close) {
            factors = &anew_;
            solution = factorize(anew_, now_, &dt_);
        }
        before = worst;
        for (std::size_t k = 0; k < n; ++k) solution[k] += cut_sigma[k] / (2 * square);
        factors->interface.solve(solution.data());
        for (std::size_t k = 0; k < n; ++k) t_cut_[k] += solution[k];
        processes.alone([&] {
            scatter(*factors, solution.data(), dt_);
            move(r, dt_, square);
            for (std::size_t k = 0; k < t_.size(); ++k) t_[k] += dt_[k];
        });
    }
    processes.alone([&] { react(found); });
    processes.largest(0);  // whether all are through
    return found;
}

}  // namespace holonomic_subdomain
