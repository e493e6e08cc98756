#include "hostile_molecule.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "molecule_dice.hpp"
#include "molecule_solution.h"

namespace stress
{

namespace
{

std::size_t at(std::int64_t i)
{
    return static_cast<std::size_t>(i);
}

/** Sets a mass whose reciprocal is the stored inverse mass to the last bit. */
void set_mass(hostile_molecule &m, std::size_t i, double mass)
{
    for (int attempt = 0; attempt < 100; ++attempt, mass = std::nextafter(mass, HUGE_VAL)) {
        m.w[i] = 1 / mass;
        m.mass[i] = 1 / m.w[i];
        if (1 / m.mass[i] == m.w[i]) return;
    }
}

/** Graphs keep the masses of their shape unless they are to be apart. */
void draw_movable_masses(hostile_molecule &m, molecule_dice &d)
{
    const double half = m.shape == GRAPHS ? 3 : 12, odd = d.decades(-half, half);
    const std::int64_t style = m.features & MASSES_APART ? d.whole(0, 2) : 3, special = d.whole(0, m.n_atoms() - 1);
    m.mass.resize(m.w.size());
    for (std::size_t i = 0; i < m.w.size(); ++i) {
        double mass = m.shape == GRAPHS ? 1 / m.w[i] : d.uniform(1, 3);
        if (style == 0) mass = d.decades(-half, half);
        if (style == 1) mass *= d.chance(0.5) ? 1 : odd;
        if (style == 2 && i == at(special)) mass *= odd;
        set_mass(m, i, mass);
    }
}

void draw_masses(hostile_molecule &m, molecule_dice &d)
{
    draw_movable_masses(m, d);
    if (!(m.features & HELD_FIXED)) return;
    const std::size_t special = at(d.whole(0, m.n_atoms() - 1));
    const double share = d.decades(-1.5, -0.3);
    for (std::size_t i = 0; i < m.w.size(); ++i)
        if (i != special && d.chance(share)) m.w[i] = m.mass[i] = 0;
}

void draw_motion(hostile_molecule &m, molecule_dice &d)
{
    const std::size_t n = m.w.size(), special = at(d.whole(0, m.n_atoms() - 1));
    const bool at_rest = d.chance(0.2), still = m.features & ONE_PULLED && d.chance(0.7);
    m.v.assign(3 * n, 0);
    m.f.assign(3 * n, 0);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t x = 0; x < 3; ++x) {
            const double v = d.normal() * std::sqrt(m.w[i]), f = d.normal();
            if (!at_rest && !still) m.v[3 * i + x] = v;
            if (!(m.features & ONE_PULLED) || i == special) m.f[3 * i + x] = f;
        }
}

void project(hostile_molecule &m)
{
    molecule_solution s;
    const molecule_problem p = m.problem();
    if (molecule_velocities(&p, &s)) return;
    for (std::size_t i = 0; i < m.v.size(); ++i) m.v[i] = static_cast<double>(s.moved[i]);
    molecule_solution_free(&s);
}

void draw_shape(hostile_molecule &m, molecule_dice &d)
{
    m.pairs.clear(), m.w.clear(), m.r.clear();
    if (m.shape == TREES) draw_tree(m, d);
    if (m.shape == RINGS) draw_ring(m, d, d.chance(0.05) ? d.whole(100, 200) : d.whole(4, 40));
    if (m.shape == TRIANGLES) draw_ring(m, d, 3);
    if (m.shape == GRAPHS) draw_graph(m, d);
    if (!(m.features & FAR_OFF)) return;
    for (std::size_t x = 0; x < 3; ++x) {
        const double offset = (d.chance(0.5) ? 1 : -1) * d.decades(0, 6);
        for (std::size_t i = 0; i < m.w.size(); ++i) m.r[3 * i + x] += offset;
    }
}

/** Numbers of the atoms at random: the library orders by them. */
void renumber(hostile_molecule &m, molecule_dice &d)
{
    const std::vector<double> old = m.r, w = m.w;
    std::vector<std::size_t> place(m.w.size());
    for (std::size_t i = 0; i < place.size(); ++i) place[i] = i;
    for (std::size_t i = place.size() - 1; i > 0; --i)
        std::swap(place[i], place[at(d.whole(0, static_cast<std::int64_t>(i)))]);
    for (std::size_t i = 0; i < place.size(); ++i) {
        m.w[place[i]] = w[i];
        std::copy_n(old.begin() + static_cast<std::ptrdiff_t>(3 * i), 3,
                    m.r.begin() + static_cast<std::ptrdiff_t>(3 * place[i]));
    }
    for (std::int64_t &i : m.pairs) i = static_cast<std::int64_t>(place[at(i)]);
}

}  // namespace

const char *class_name(int c)
{
    static const char *const names[N_CLASSES] = {"trees", "rings", "triangles", "graphs"};
    return names[c];
}

const char *molecule_feature_name(int bit)
{
    static const char *const names[n_molecule_features] = {"masses apart", "held fixed", "lengths apart", "aligned",
                                                           "flat",         "far off",    "one pulled",    "consistent"};
    return names[bit];
}

molecule_problem hostile_molecule::problem() const
{
    return {n_atoms(), n_bonds(), pairs.data(), w.data(), r.data(), v.data(), f.data(), nullptr};
}

std::vector<double> hostile_molecule::drifted() const
{
    std::vector<double> out = r;
    for (std::size_t i = 0; i < r.size(); ++i) out[i] += dt * v[i];
    return out;
}

std::string hostile_molecule::words() const
{
    std::string all = class_name(shape);
    for (int bit = 0; bit < n_molecule_features; ++bit)
        if (features >> bit & 1u) all += std::string(", ") + molecule_feature_name(bit);
    return all;
}

/**
 * Three atoms on a line and four in a plane that are all bonded to each other, to the rounding of their lengths, would
 * be taken as rigid bodies, and their bonds would not be independent: the longest becomes a little shorter.
 */
void keep_apart(hostile_molecule &m)
{
    std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> bonds;
    std::map<std::int64_t, std::vector<std::int64_t>> partners; /* of higher number */
    for (std::size_t k = 0; k < m.length.size(); ++k) {
        const auto ends = std::minmax(m.pairs[2 * k], m.pairs[2 * k + 1]);
        bonds[{ends.first, ends.second}] = k;
        partners[ends.first].push_back(ends.second);
    }
    const auto joined = [&](std::int64_t i, std::int64_t j) { return bonds.count(std::minmax(i, j)) > 0; };
    const auto height =
        [&](const std::vector<std::int64_t> &atoms) { /* of the last, over the others' line or plane */
                                                      long double d[3][3], size = 1;
                                                      for (std::size_t a = 1; a < atoms.size(); ++a) {
                                                          long double square = 0;
                                                          for (std::size_t x = 0; x < 3; ++x) {
                                                              d[a - 1][x] =
                                                                  static_cast<long double>(
                                                                      m.r[3 * static_cast<std::size_t>(atoms[a]) + x]) -
                                                                  m.r[3 * static_cast<std::size_t>(atoms[0]) + x];
                                                              square += d[a - 1][x] * d[a - 1][x];
                                                          }
                                                          size *= std::sqrt(square);
                                                      }
                                                      long double c[3], square = 0, product = 0;
                                                      for (std::size_t x = 0; x < 3; ++x) {
                                                          c[x] = d[0][(x + 1) % 3] * d[1][(x + 2) % 3] -
                                                                 d[0][(x + 2) % 3] * d[1][(x + 1) % 3];
                                                          square += c[x] * c[x];
                                                          if (atoms.size() == 4) product += c[x] * d[2][x];
                                                      }
                                                      return (atoms.size() == 3 ? std::sqrt(square)
                                                                                : std::fabs(product)) /
                                                             size;
        };
    const auto shorten = [&](const std::vector<std::int64_t> &atoms) {
        if (height(atoms) > 1e-6L) return;
        std::size_t longest = bonds.at(std::minmax(atoms[0], atoms[1]));
        for (const std::int64_t i : atoms)
            for (const std::int64_t j : atoms)
                if (i < j && m.length[bonds.at({i, j})] > m.length[longest]) longest = bonds.at({i, j});
        m.length[longest] *= 1 - 1e-13;
    };
    for (const auto &of : partners)
        for (std::size_t a = 0; a < of.second.size(); ++a)
            for (std::size_t b = 0; b < a; ++b) {
                const std::int64_t j = of.second[a], k = of.second[b];
                if (!joined(j, k)) continue;
                shorten({of.first, j, k});
                for (std::size_t c = 0; c < b; ++c)
                    if (joined(j, of.second[c]) && joined(k, of.second[c])) shorten({of.first, j, k, of.second[c]});
            }
}

bool set_lengths(hostile_molecule &m)
{
    m.length.assign(m.pairs.size() / 2, 0);
    for (std::size_t k = 0; k < m.length.size(); ++k) {
        long double square = 0;
        for (std::size_t x = 0; x < 3; ++x) {
            const long double d =
                static_cast<long double>(m.r[3 * at(m.pairs[2 * k + 1]) + x]) - m.r[3 * at(m.pairs[2 * k]) + x];
            square += d * d;
        }
        m.length[k] = static_cast<double>(std::sqrt(square));
        if (!(m.length[k] > 0)) return false;
    }
    keep_apart(m);
    return true;
}

void set_time_step(hostile_molecule &m, double drift)
{
    double dt = HUGE_VAL;
    for (std::size_t k = 0; k < m.length.size(); ++k) {
        double square = 0;
        for (std::size_t x = 0; x < 3; ++x) {
            const double d = m.v[3 * at(m.pairs[2 * k + 1]) + x] - m.v[3 * at(m.pairs[2 * k]) + x];
            square += d * d;
        }
        if (square > 0) dt = std::min(dt, drift * m.length[k] / std::sqrt(square));
    }
    m.dt = std::isfinite(dt) ? dt : 0;
}

hostile_molecule make_hostile_molecule(std::uint64_t seed)
{
    hostile_molecule m;
    m.seed = seed;
    m.shape = static_cast<molecule_class>(seed % N_CLASSES);
    molecule_dice d{random_seed(seed * UINT64_C(0x9e3779b97f4a7c15) + 7)};
    const double share = d.uniform(0, 0.7);  // between ordinary molecules and those that have everything
    for (int bit = 0; bit < n_molecule_features; ++bit)
        if (d.chance(share)) m.features |= 1u << bit;
    do draw_shape(m, d);
    while (!set_lengths(m));  // the coordinates' rounding may swallow a bond
    renumber(m, d);
    draw_masses(m, d);
    draw_motion(m, d);
    if (m.features & CONSISTENT) project(m);
    set_time_step(m, d.decades(-9, -1.5));
    return m;
}

hostile_molecule make_sibling(const hostile_molecule &of, std::uint64_t seed)
{
    hostile_molecule m = of;
    m.seed = seed;
    molecule_dice d{random_seed(seed * UINT64_C(0x9e3779b97f4a7c15) + 13)};
    for (std::size_t i = 0; i < m.w.size(); ++i) {
        for (std::size_t x = 0; x < 3; ++x) m.r[3 * i + x] = of.r[3 * i + (x + 1) % 3];
        if (of.w[i] == 0) m.w[i] = 1;  // for now
    }
    draw_movable_masses(m, d);
    for (std::size_t i = 0; i < m.w.size(); ++i)
        if (of.w[i] == 0) m.w[i] = m.mass[i] = 0;
    set_lengths(m);
    draw_motion(m, d);
    if (m.features & CONSISTENT) project(m);
    set_time_step(m, d.decades(-9, -1.5));
    return m;
}

}  // namespace stress
