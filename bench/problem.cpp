#include "problem.hpp"

#include <holonomic.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "random.h"

namespace bench {
namespace {

const double degree = 3.14159265358979323846 / 180;

/// Turns u by an angle about an axis chosen at random.
void turn(random_stream &s, double u[3], double angle) {
    double e[3], along = 0, size = 0;
    random_direction(&s, e);
    for (int x = 0; x < 3; ++x) along += e[x] * u[x];
    for (int x = 0; x < 3; ++x) {
        e[x] -= along * u[x];
        size += e[x] * e[x];
    }
    size = std::sqrt(size);
    double norm = 0;
    for (int x = 0; x < 3; ++x) {
        u[x] = std::cos(angle) * u[x] + std::sin(angle) * e[x] / size;
        norm += u[x] * u[x];
    }
    norm = std::sqrt(norm);
    for (int x = 0; x < 3; ++x) u[x] /= norm;
}

/// One of the two axes across the last one, either way.
void turn_to_axis(random_stream &s, double u[3]) {
    const auto step = random_integer(&s, 1, 2);
    int axis = 0;
    for (int x = 1; x < 3; ++x)
        if (std::abs(u[x]) > std::abs(u[axis])) axis = x;
    const double sign = random_uniform(&s) < 0.5 ? -1 : 1;
    for (int x = 0; x < 3; ++x) u[x] = x == (axis + step) % 3 ? sign : 0;
}

void next_direction(const Recipe &recipe, random_stream &s, bool first, double u[3]) {
    if (recipe.orthogonal) return turn_to_axis(s, u);
    if (recipe.flat) {
        const double angle = 360 * degree * random_uniform(&s);
        u[0] = std::cos(angle), u[1] = std::sin(angle), u[2] = 0;
        return;
    }
    if (first || recipe.name == "coil" || recipe.name == "melt" || recipe.name == "fixed_ends")
        random_direction(&s, u);
    else if (recipe.name == "tetrahedral")
        turn(s, u, std::acos(1.0 / 3));
    else if (recipe.name == "straight5" || recipe.name == "light_joints")
        turn(s, u, degree * (recipe.turn_from + (recipe.turn_to - recipe.turn_from) * random_uniform(&s)));
    else
        throw std::invalid_argument("there is no problem " + recipe.name);
}

void masses_and_lengths(const Recipe &recipe, random_stream &s, Problem &p) {
    const std::size_t n = p.n();
    p.mass.assign(n + 1, 1.0);
    p.length.assign(n, 1.0);
    if (recipe.name == "light_joints")
        for (std::size_t i = 1; i <= n; i += 2) p.mass[i] = recipe.light;
    if (recipe.name == "fixed_ends") p.mass.front() = p.mass.back() = 0;
    if (recipe.general_masses)
        for (double &m : p.mass) m = std::pow(10, recipe.decades * (random_uniform(&s) - 0.5));
    if (recipe.general_lengths)
        for (double &a : p.length) a = 0.7 + 0.8 * random_uniform(&s);
    if (recipe.fixed_every > 0)
        for (std::size_t i = 0; i <= n; i += static_cast<std::size_t>(recipe.fixed_every)) p.mass[i] = 0;
    for (double m : p.mass) p.w.push_back(m > 0 ? 1 / m : 0);
}

/// Velocities and forces of the size that belongs to kT = 1, except that light joints move like the others.
void motion(const Recipe &recipe, random_stream &s, Problem &p) {
    for (std::size_t c = 0; c < p.n_chains(); ++c)
        for (std::size_t i = 0; i <= p.n(); ++i) {
            const bool light = p.name == "light_joints";
            const double size = p.w[i] == 0 ? 0 : light ? 1 : std::sqrt(p.w[i]);
            for (std::size_t x = 0; x < 3; ++x) {
                const double here = recipe.flat && x == 2 ? 0 : 1;
                p.raw_v.push_back(here * size * random_normal(&s));
                p.f.push_back(here * random_normal(&s) / (p.w[i] == 0 ? 1 : light ? p.w[i] : std::sqrt(p.w[i])));
            }
        }
}

void project(Problem &p) {
    hol_chains *chains = nullptr;
    std::vector<double> mass(p.atoms());
    for (std::size_t i = 0; i < mass.size(); ++i) mass[i] = p.mass[i % (p.n() + 1)];
    int status = hol_chains_create(static_cast<std::int64_t>(p.atoms()), mass.data(), &chains);
    const std::unique_ptr<hol_chains, decltype(&hol_chains_destroy)> owner(chains, hol_chains_destroy);
    if (status == HOL_OK) status = hol_chains_add_block(chains, p.chains, p.bonds, 0, p.length.data());
    if (status == HOL_OK) status = hol_project_velocities(chains, p.r.data(), p.v.data(), nullptr, nullptr);
    if (status != HOL_OK) throw std::runtime_error("problem " + p.name + ": " + hol_error_message());
}

}  // namespace

Problem make_problem(const Recipe &recipe) {
    Problem p;
    p.name = recipe.name;
    p.chains = recipe.chains;
    p.bonds = recipe.bonds;
    p.one_by_one = recipe.one_by_one;
    random_stream s = random_seed(recipe.seed);
    masses_and_lengths(recipe, s, p);
    // The chains of a melt start anywhere in a box at the density of a bead-rod melt, 0.85; others at the origin.
    const std::size_t atoms = p.n_chains() * (p.n() + 1);
    const double side = p.name == "melt" ? std::cbrt(static_cast<double>(atoms) / 0.85) : 0;
    p.r.reserve(3 * atoms);
    for (std::size_t c = 0; c < p.n_chains(); ++c) {
        double u[3] = {1, 0, 0}, at[3];
        for (double &x : at) x = side * (random_uniform(&s) - 0.5);
        if (recipe.flat) at[2] = 0;
        p.r.insert(p.r.end(), at, at + 3);
        for (std::size_t k = 0; k < p.n(); ++k) {
            next_direction(recipe, s, k == 0, u);
            for (std::size_t x = 0; x < 3; ++x) p.r.push_back(*(p.r.end() - 3) + p.length[k] * u[x]);
        }
    }
    motion(recipe, s, p);
    p.v = p.raw_v;
    project(p);
    p.drifted.resize(p.r.size());
    for (std::size_t i = 0; i < p.r.size(); ++i) p.drifted[i] = p.r[i] + p.dt * p.v[i];
    return p;
}

namespace {

Recipe kind(const std::string &name, std::int64_t n_chains, std::int64_t n_bonds) {
    Recipe recipe;
    recipe.name = name;
    recipe.chains = n_chains;
    recipe.bonds = n_bonds;
    if (name == "light_joints") recipe.turn_from = 20, recipe.turn_to = 60;
    return recipe;
}

}  // namespace

Recipe single(const std::string &name, std::int64_t n_bonds, std::int64_t pool) {
    Recipe recipe = kind(name, std::clamp<std::int64_t>(pool / n_bonds, 1, 2000), n_bonds);
    recipe.one_by_one = true;
    return recipe;
}

Recipe batch(const std::string &name, std::int64_t n_chains, std::int64_t n_bonds) {
    return kind(name, n_chains, n_bonds);
}

Recipe with_joints(Recipe recipe, double light, double turn_from, double turn_to) {
    recipe.light = light;
    recipe.turn_from = turn_from;
    recipe.turn_to = turn_to;
    return recipe;
}

}  // namespace bench
