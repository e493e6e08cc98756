#include "molecule_reference.hpp"

#include "random.h"

namespace stress
{

namespace
{

constexpr long double singular = 1e-60L;       // a pivot below it is taken for zero
constexpr long double singular_tree = 1e-80L;  // the same in trees

}  // namespace

std::vector<double> right_hand_side(const hostile_molecule &m)
{
    random_stream stream = random_seed(m.seed + 11);
    std::vector<double> rhs;
    for (double a : m.length) rhs.push_back(a * a * random_normal(&stream));
    return rhs;
}

molecule_reference::molecule_reference(const hostile_molecule &m)
{
    const molecule_problem p = m.problem();
    regular =
        molecule_metric_make(&p, &metric) == 0 && metric.least_pivot > (m.shape == TREES ? singular_tree : singular);
    if (!regular) return;
    forces.there = molecule_forces(&p, &forces.s) == 0;
    solve.there = molecule_solve(&p, right_hand_side(m).data(), &solve.s) == 0;
    velocities.there = molecule_velocities(&p, &velocities.s) == 0;
    if (m.dt > 0)
        positions.there = molecule_positions(&p, m.drifted().data(), nullptr, m.length.data(), m.dt, &positions.s) == 0;
}

molecule_reference::molecule_reference(molecule_reference &&other) noexcept
    : regular(other.regular), metric(other.metric), forces(std::move(other.forces)), solve(std::move(other.solve)),
      velocities(std::move(other.velocities)), positions(std::move(other.positions))
{
    other.metric = molecule_metric{};
}

molecule_reference::~molecule_reference()
{
    molecule_metric_free(&metric);
}

}  // namespace stress
