/**
 * @file molecule_dice.hpp
 * Random numbers as the makers of hostile molecules want them, and how one class of molecules is drawn.
 */
#ifndef STRESS_MOLECULE_DICE_HPP
#define STRESS_MOLECULE_DICE_HPP

#include <array>
#include <cmath>

#include "hostile_molecule.hpp"
#include "random.h"

namespace stress
{

using point = std::array<double, 3>;

struct molecule_dice {
    random_stream stream;

    double uniform(double low, double high)
    {
        return low + (high - low) * random_uniform(&stream);
    }
    double decades(double low, double high)
    {
        return std::pow(10.0, uniform(low, high));
    }
    bool chance(double p)
    {
        return random_uniform(&stream) < p;
    }
    std::int64_t whole(std::int64_t low, std::int64_t high)
    {
        return random_integer(&stream, low, high);
    }
    double normal()
    {
        return random_normal(&stream);
    }
    point direction()
    {
        point u;
        random_direction(&stream, u.data());
        return u;
    }
    point normal_to(const point &u)
    {
        for (;;) {
            point e = direction();
            const double along = e[0] * u[0] + e[1] * u[1] + e[2] * u[2], square = 1 - along * along;
            if (square < 0.1) continue;
            for (std::size_t x = 0; x < 3; ++x) e[x] = (e[x] - along * u[x]) / std::sqrt(square);
            return e;
        }
    }
    /** u turned by an angle in a random direction. */
    point turned(const point &u, double angle)
    {
        const point n = normal_to(u);
        point out;
        for (std::size_t x = 0; x < 3; ++x) out[x] = std::cos(angle) * u[x] + std::sin(angle) * n[x];
        return out;
    }
};

/** Topology and positions of a molecule whose shape and features are set; masses follow. */
void draw_tree(hostile_molecule &m, molecule_dice &d);
void draw_ring(hostile_molecule &m, molecule_dice &d, std::int64_t size);
void draw_graph(hostile_molecule &m, molecule_dice &d);

/** Three directions at right angles. */
struct turn {
    point axis[3];

    explicit turn(molecule_dice &d)
    {
        axis[0] = d.direction();
        axis[1] = d.normal_to(axis[0]);
        for (std::size_t x = 0; x < 3; ++x) {
            const std::size_t y = (x + 1) % 3, z = (x + 2) % 3;
            axis[2][x] = axis[0][y] * axis[1][z] - axis[0][z] * axis[1][y];
        }
    }
    /** In long double, so that what is flat stays flat to one rounding. */
    void apply(const long double *from, long double *to) const
    {
        for (std::size_t x = 0; x < 3; ++x) to[x] = axis[0][x] * from[0] + axis[1][x] * from[1] + axis[2][x] * from[2];
    }
};

}  // namespace stress

#endif
