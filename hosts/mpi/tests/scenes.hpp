#ifndef HOLONOMIC_SUBDOMAIN_TESTS_SCENES_HPP
#define HOLONOMIC_SUBDOMAIN_TESTS_SCENES_HPP

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

/** A whole molecule, on its constraints, with velocities, forces and a process for each atom. */
struct Scene {
    std::vector<double> masses, r, v, f;
    std::vector<std::int64_t> pairs;
    std::vector<double> lengths;
    std::vector<int> owner;
    double time_step = 0.02;
    std::vector<double> box; /**< rows, or empty */
    bool stiff = false;      /**< a pull at one bond reaches all others */

    std::int64_t n_atoms() const { return static_cast<std::int64_t>(masses.size()); }
    std::int64_t n_bonds() const { return static_cast<std::int64_t>(lengths.size()); }
};

/** Builds molecules whose lengths are the distances that atoms happen to have. */
class Builder {
public:
    explicit Builder(unsigned seed) : random_(seed) {}

    double normal() { return normal_(random_); }
    double uniform() { return uniform_(random_); }
    std::array<double, 3> direction();

    int atom(double mass, const std::array<double, 3> &at);
    void bond(int a, int b) { scene.pairs.insert(scene.pairs.end(), {a, b}); }
    std::array<double, 3> at(int atom) const;
    /** Atoms beside a; gives the last: `stiff` 0 is a coil, 1 a rod. */
    int strand(int a, int n_bonds, double mass, double stiff, std::array<double, 3> along);

    /** Lengths, random velocities and forces, and owners by slabs along x (or by blocks of atoms). */
    Scene finish(int n_pieces, bool slabs);

    Scene scene;

private:
    std::mt19937_64 random_;
    std::normal_distribution<double> normal_;
    std::uniform_real_distribution<double> uniform_;
};

/** kind: chain, rod, protein, gel, taut or light, of about n_bonds bonds, or flat; layout: blocks, slabs, or slabs in a
 * box. */
Scene make_scene(const std::string &kind, int n_bonds, int n_pieces, const std::string &layout);

#endif
