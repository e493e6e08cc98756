/** Two ways to move rigid bodies by a step: atoms with the library's projections, and quaternions. */
#ifndef BENCH_BODIES_MOVERS_HPP
#define BENCH_BODIES_MOVERS_HPP

#include <memory>
#include <vector>

#include "bodies/scene.hpp"

namespace bench {

class Mover {
public:
    virtual ~Mover() = default;
    /// Half a kick by the forces at the present positions, and the drift.
    virtual void first_half(const double *f, double dt) = 0;
    /// Half a kick by the forces at the new positions.
    virtual void second_half(const double *f, double dt) = 0;
    virtual const double *positions() const = 0;
    virtual double kinetic() const = 0;
};

/// Velocity Verlet of all atoms, positions and velocities projected (RATTLE).
std::unique_ptr<Mover> by_the_library(const BodyScene &s);

/**
 * NO_SQUISH (T. F. Miller et al., J. Chem. Phys. 116, 8649 (2002)), velocity Verlet: kicks of centre and quaternion,
 * free rotation as rotations about the axes 3, 2, 1, 2, 3. Bodies side by side in the lanes of vectors.
 */
std::unique_ptr<Mover> by_quaternions(const BodyScene &s);

}  // namespace bench

#endif
