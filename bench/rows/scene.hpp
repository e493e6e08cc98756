/**
 * What a row is measured on: molecules, the order of their atoms, a box, and the state of the atoms.
 */
#ifndef BENCH_ROWS_SCENE_HPP
#define BENCH_ROWS_SCENE_HPP

#include <memory>
#include <string>
#include <vector>

#include "../molecules/kind.hpp"
#include "library.hpp"

namespace rows {

enum class Boxed { no, orthorhombic, triclinic };

/// How atoms stand in the arrays.
enum class Order {
    consecutive,
    apart,  ///< the first atoms of all molecules, then their second ones, and so on
    any
};

struct Recipe {
    std::vector<bench::Kind> kinds;  ///< in turns
    std::int64_t molecules = 1;
    bool linear = false;  ///< added as chains, not as bonds
    Order order = Order::consecutive;
    Boxed box = Boxed::no;
};

struct Scene {
    Recipe recipe;
    std::vector<double> mass;            ///< [atoms]
    std::vector<std::int64_t> place;     ///< [atoms] where each stands in the arrays
    std::vector<std::int64_t> pairs;     ///< [bonds][2], atoms as they stand in the arrays
    std::vector<double> length;          ///< [bonds]
    std::vector<double> r, v, moved, f;  ///< [atoms][3]; v of any direction, moved by velocities along the bonds
    double box[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    double dt = 0.005;

    std::size_t atoms() const { return mass.size(); }
    std::size_t bonds() const { return length.size(); }
};

using Handle = std::unique_ptr<hol_chains, void (*)(hol_chains *)>;

/// The molecules of a scene, as this library knows them.
Handle make_handle(const Library &library, const Scene &scene);
/// Always the same for the same recipe, but for the rounding of the library that moves the atoms.
Scene make_scene(const Recipe &recipe, const Library &library);

/// How the masses and lengths of a chain are chosen.
struct Chain {
    double mass = 1;
    bool general_masses = false, general_lengths = false;  ///< along the chain: over two decades; 0.7 .. 1.5
};
/// So many chains of so many bonds; `kinds` of them where masses or lengths are general.
Recipe chains(std::int64_t molecules, std::int64_t bonds, const Chain &chain = {}, std::int64_t kinds = 1);
Recipe molecules(std::int64_t molecules, const std::vector<bench::Kind> &kinds);

}  // namespace rows

#endif
