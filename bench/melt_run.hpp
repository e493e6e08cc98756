/**
 * Molecular dynamics of a melt of bead-rod chains with purely repulsive (WCA) beads, for the energy drift: velocity
 * Verlet with the constraints of the method that is measured (RATTLE).
 */
#ifndef BENCH_MELT_RUN_HPP
#define BENCH_MELT_RUN_HPP

#include <utility>
#include <vector>

#include "method.hpp"
#include "problem.hpp"

namespace bench {

/// What constrains positions and velocities in a run. Both work on the arrays of State, with Problem::r as reference.
struct Constraints {
    Method positions, velocities;
};

class MeltRun {
public:
    /// Chains on a lattice path in a periodic box at bead density 0.85, kT = 1.
    MeltRun(std::int64_t n_chains, std::int64_t n_bonds, double dt);

    const Problem &problem() const { return problem_; }
    void step(const Constraints &constraints);
    void rescale();
    double kinetic() const;
    double energy() const { return kinetic() + potential_; }
    double constraint_seconds() const { return seconds_; }  ///< since the last start_clock
    void start_clock() { seconds_ = 0; }

    /// The phase point: what a run starts from.
    struct Point {
        std::vector<double> r, v;
    };
    Point save() const { return {problem_.r, state_.v}; }
    void load(const Point &point);

private:
    void timed(const Method &method);
    void list_pairs();
    void forces();
    double image(double x) const;

    Problem problem_;
    double side_, potential_ = 0, seconds_ = 0;
    State state_;
    std::vector<double> f_, at_list_;
    std::vector<std::pair<std::size_t, std::size_t>> pairs_;
};

}  // namespace bench

#endif
