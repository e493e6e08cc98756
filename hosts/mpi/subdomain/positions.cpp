// Positions: the interface's multipliers by Broyden's method, everything inside by the library's own.
#include <cmath>
#include <limits>
#include <numeric>

#include "subdomain.hpp"

namespace holonomic_subdomain {

namespace {

constexpr int most_steps = 50;

/** Broyden's method in steps: the next one from what the matrix at the start makes of the residual (Kelley 1995, 7.3).
 */
class Broyden {
public:
    /** z: -H_0 F; gives the step. */
    std::vector<double> next(std::vector<double> z) {
        for (std::size_t j = 0; j + 1 < steps_.size(); ++j) add(z, dot(steps_[j], z) / squares_[j], steps_[j + 1]);
        if (!steps_.empty()) {
            const double factor = 1 - dot(steps_.back(), z) / squares_.back();
            if (factor != 0)
                for (double &x : z) x /= factor;
        }
        const double square = dot(z, z);
        if (square > 0) steps_.push_back(z), squares_.push_back(square);
        return z;
    }

private:
    static double dot(const std::vector<double> &a, const std::vector<double> &b) {
        return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    }
    static void add(std::vector<double> &z, double factor, const std::vector<double> &s) {
        for (std::size_t k = 0; k < z.size(); ++k) z[k] += factor * s[k];
    }

    std::vector<std::vector<double>> steps_;
    std::vector<double> squares_;
};

}  // namespace

/** The bonds inside onto their lengths, along those of the reference. */
void Subdomain::project_inside(std::vector<double> &r, double dt) {
    if (!chains_) return;
    std::vector<double> lambda(lengths_.size(), 0.0);
    check(hol_project_positions(chains_.get(), r_.data(), r.data(), nullptr, dt, lambda.data(), 0, nullptr, nullptr));
    for (std::size_t k = 0; k < lambda.size(); ++k) t_[k] += 2 * lambda[k];
    ++n_passes_;
}

/** What multipliers of cut bonds do to their atoms. */
void Subdomain::pull(std::vector<double> &r, const std::vector<double> &multipliers) const {
    for (const End &end : ends_)
        for (int c = 0; c < 3; ++c)
            r[3 * static_cast<std::size_t>(end.atom) + c] -=
                graph_.w[end.atom] * end.sign() * multipliers[end.cut] * cut_d_[end.cut].hi[c];
}

/** sigma = D.D - a^2 of each cut bond; gives the largest, in units of what the rounding of coordinates does to it. */
double Subdomain::excess(const std::vector<double> &shared, std::vector<double> &sigma) const {
    double worst = 0;
    for (int k = 0; k < n_cut(); ++k) {
        const double *i = shared.data() + 6 * static_cast<std::size_t>(k), *j = i + 3, a = cut_lengths_[k];
        const TwiceVector d = box_.between(i, j);
        sigma[k] = cut_is_fixed(k) ? 0 : (dot(d, d) - product_of(a, a)).hi;
        double extent = a;
        for (int c = 0; c < 3; ++c) extent = std::max({extent, std::fabs(i[c]), std::fabs(j[c])});
        const double unit = std::numeric_limits<double>::epsilon() * a * extent;
        worst = std::max(worst, std::fabs(sigma[k]) / unit);
        if (!std::isfinite(sigma[k])) return HUGE_VAL;
    }
    return worst;
}

Found Subdomain::positions(std::vector<double> &r, double dt) {
    std::vector<double> shared, step(cut_lengths_.size());
    t_.assign(graph_.n_rows, 0.0);
    t_cut_.assign(cut_lengths_.size(), 0.0);
    processes.alone([&] {
        if (chains_) {
            check(hol_chains_set_reference_box(chains_.get(), reference_box_.rows()));
            check(hol_chains_set_box(chains_.get(), box_.rows()));
        }
        project_inside(r, dt);
    });
    Found found;
    Broyden broyden;
    double before = HUGE_VAL;
    for (;; ++found.steps) {
        shared = of_ends({r.data()});
        processes.add_up(shared);
        const double worst = excess(shared, step);
        // A few roundings of the two atoms' coordinates; some more if no step makes it less.
        if (worst <= 4 || (worst <= 32 && worst >= before / 2)) break;
        if (found.steps == most_steps || !std::isfinite(worst))
            throw Failure{HOL_ERR_NO_CONVERGENCE, "the lengths of cut bonds can't be reached from these positions"};
        before = worst;
        for (double &x : step) x /= 2 * dt * dt;
        step.resize(n_interface_, 0.0);
        interface_.solve(step.data());
        step.resize(cut_lengths_.size());
        step = broyden.next(step);
        processes.alone([&] {
            std::vector<double> scaled = step;
            for (std::size_t k = 0; k < step.size(); ++k) t_cut_[k] += step[k], scaled[k] *= dt * dt;
            pull(r, scaled);
            project_inside(r, dt);
        });
    }
    processes.alone([&] {
        for (const End &end : ends_) t_[end.row] = t_cut_[end.cut];
        react(found);
    });
    processes.largest(0);  // whether all are through
    return found;
}

}  // namespace holonomic_subdomain
