// Rings of six atoms and more that lengths hold in a plane, benzene's among them: the distances between neighbours and
// between next neighbours are held, so that all angles are, and what these turn makes one full circle. A closed polygon
// that leaves its plane, or is not convex, turns more (Fenchel 1929, doi:10.1007/BF01454836).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/rigid/fit.hpp"

namespace holonomic::rigid {

// Graph: for_partners(atom, each) calls each(partner); with_fewer(i, j) is the one that has fewer of them; square(i, j)
// is their squared distance, -1 where none is held; lengths_around(i) are those of its molecule.
template <class Graph>
class PlanarRing {
public:
    using Atom = typename Graph::Atom;

    // From its lowest atom on. steps: how many may still be looked at.
    PlanarRing(const Graph &graph, Atom first, Atom second, double tolerance, std::int64_t &steps)
        : graph_(graph), ring_{first, second}, tolerance_(tolerance), steps_(steps) {}

    // Then ring() goes around, and coordinates() has [..][3] of it.
    bool find() { return extend(0); }
    const std::vector<Atom> &ring() const { return ring_; }
    const std::vector<double> &coordinates() const { return coordinates_; }

private:
    static constexpr double circle = 6.283185307179586;
    static constexpr std::size_t most = 16;
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    // An angle is off by some four times what the lengths are, and these by what their decimals leave open.
    double margin() const {
        const std::int64_t n = static_cast<std::int64_t>(ring_.size());
        return 40 * tolerance_ * static_cast<double>(n) + rounded(n);
    }
    static double rounded(std::int64_t n) { return 16 * epsilon * static_cast<double>(n); }

    std::vector<double> turned() const {
        std::vector<double> x(3 * ring_.size(), 0.0);
        double angle = 0;
        for (std::size_t i = 1; i < ring_.size(); ++i) {
            const double length = std::sqrt(graph_.square(ring_[i - 1], ring_[i]));
            x[3 * i] = x[3 * i - 3] + length * std::cos(angle);
            x[3 * i + 1] = x[3 * i - 2] + length * std::sin(angle);
            if (i + 1 < ring_.size()) angle += turn(ring_[i - 1], ring_[i], ring_[i + 1]);
        }
        return x;
    }

    // By how much a way from i over j to k turns at j; infinity if it is not held.
    double turn(Atom i, Atom j, Atom k) const {
        const double a = graph_.square(i, j), b = graph_.square(j, k), c = graph_.square(i, k);
        if (!(a > 0 && b > 0 && c > 0)) return std::numeric_limits<double>::infinity();
        return std::acos(std::max(-1.0, std::min(1.0, (c - a - b) / (2 * std::sqrt(a * b)))));
    }

    bool closes(double turned) {
        const std::size_t n = ring_.size();
        if (n < 6) return false;
        const double whole =
            turned + turn(ring_[n - 2], ring_[n - 1], ring_[0]) + turn(ring_[n - 1], ring_[0], ring_[1]);
        return std::fabs(whole - circle) <= margin() && fits_plane(whole - circle);
    }

    // Angles of full digits that turn by more are independent.
    bool fits_plane(double excess) {
        const std::int64_t n = static_cast<std::int64_t>(ring_.size());
        Distances wanted(n);
        for (std::int64_t i = 0; i < n; ++i)
            for (std::int64_t j = 0; j < i; ++j) {
                const double square =
                    graph_.square(ring_[static_cast<std::size_t>(i)], ring_[static_cast<std::size_t>(j)]);
                if (square > 0) wanted.at(i, j) = wanted.at(j, i) = std::sqrt(square);
            }
        coordinates_ = turned();
        const Misfit misfit = fit_coordinates(wanted, 2, coordinates_);
        const Decimals decimals(wanted, tolerance_, [&] { return graph_.lengths_around(ring_[0]); });
        return decimals.are_full() ? excess <= rounded(n) && misfit.error <= decimals.most() : decimals.allow(misfit);
    }

    bool extend(double turned) {
        if (closes(turned)) return true;
        if (ring_.size() == most || --steps_ < 0) return false;
        bool found = false;
        const Atom last = ring_.back(), before = ring_[ring_.size() - 2];
        graph_.for_partners(graph_.with_fewer(last, before), [&](Atom atom) {
            if (found || atom < ring_[0] || std::find(ring_.begin(), ring_.end(), atom) != ring_.end()) return;
            const double next = turned + turn(before, last, atom);
            if (next > circle + margin()) return;
            ring_.push_back(atom);
            found = extend(next);
            if (!found) ring_.pop_back();
        });
        return found;
    }

    const Graph &graph_;
    std::vector<Atom> ring_;
    std::vector<double> coordinates_;
    const double tolerance_;
    std::int64_t &steps_;
};

// For all rings of a molecule, or of a list.
inline std::int64_t steps_for_rings(std::int64_t n_bonds) { return 4096 + 16 * n_bonds; }

}  // namespace holonomic::rigid
