/** Bodies to be moved, and the forces on their atoms. */
#ifndef BENCH_BODIES_SCENE_HPP
#define BENCH_BODIES_SCENE_HPP

#include <cstdint>
#include <string>
#include <vector>

namespace bench {

/** Copies of a body, each turned and spinning in its own way. */
struct BodyScene {
    std::string name;
    std::int64_t n_bodies;
    std::vector<double> mass;    // [atoms of a body]
    std::vector<double> place;   // [atoms of a body][3]
    std::vector<double> r, v;    // [all atoms][3] at the start
    std::vector<double> spring;  // [atoms of a body][3], to where the atom was at the start; all 0: the bodies are free
    std::vector<double> anchor;  // [all atoms][3]

    std::int64_t atoms_each() const { return static_cast<std::int64_t>(mass.size()); }
    std::int64_t n_atoms() const { return n_bodies * atoms_each(); }
    bool is_free() const;
    void forces(const double *r, double *f) const;
    double potential(const double *r) const;
};

/// CO2, benzene, C60, and a free asymmetric top.
std::vector<BodyScene> body_scenes(std::int64_t n_bodies);

}  // namespace bench

#endif
