#include "hostile_body.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "molecule_dice.hpp"

namespace stress
{

namespace
{

using reference::rigid_problem;

double largest(const std::vector<double> &x)
{
    double most = 0;
    for (double y : x) most = std::max(most, std::fabs(y));
    return most;
}

double distance(const rigid_problem &p, std::size_t i, std::size_t j)
{
    long double square = 0;
    for (std::size_t x = 0; x < 3; ++x) {
        const long double d = static_cast<long double>(p.r[3 * j + x]) - p.r[3 * i + x];
        square += d * d;
    }
    return static_cast<double>(std::sqrt(square));
}

/** Renumbers atoms at random, so that bodies are no blocks of the arrays. */
void renumber(hostile_body &m, molecule_dice &d)
{
    const rigid_problem old = m.p;
    std::vector<std::size_t> to(old.n_atoms());
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = i;
    for (std::size_t i = to.size() - 1; i > 0; --i)
        std::swap(to[i], to[static_cast<std::size_t>(d.whole(0, static_cast<std::int64_t>(i)))]);
    for (std::size_t i = 0; i < to.size(); ++i) {
        m.p.mass[to[i]] = old.mass[i];
        for (std::size_t x = 0; x < 3; ++x) {
            m.p.r[3 * to[i] + x] = old.r[3 * i + x];
            m.p.place[3 * to[i] + x] = old.place[3 * i + x];
        }
    }
    for (auto &body : m.p.bodies)
        for (std::size_t &a : body) a = to[a];
    for (auto &pair : m.p.pairs)
        for (std::size_t &a : pair) a = to[a];
}

/** Rates at which centre and principal vectors of bodies change, over their lengths: what limits a step. */
double fastest(const rigid_problem &p)
{
    double most = 0;
    for (const auto &atoms : p.bodies) {
        const reference::body_shape shape = reference::shape_of_body(p, atoms);
        for (std::size_t k = 0; k < shape.length.size(); ++k) {
            point rate{};
            for (std::size_t a = 0; a < atoms.size(); ++a)
                for (std::size_t x = 0; x < 3; ++x) rate[x] += shape.share[a][k] * p.v[3 * atoms[a] + x];
            most =
                std::max(most, std::sqrt(rate[0] * rate[0] + rate[1] * rate[1] + rate[2] * rate[2]) / shape.length[k]);
        }
    }
    for (std::size_t k = 0; k < p.pairs.size(); ++k) {
        double square = 0;
        for (std::size_t x = 0; x < 3; ++x) {
            const double d = p.v[3 * p.pairs[k][1] + x] - p.v[3 * p.pairs[k][0] + x];
            square += d * d;
        }
        most = std::max(most, std::sqrt(square) / p.length[k]);
    }
    return most;
}

void roughen(hostile_body &m, molecule_dice &d)
{
    if (!(m.features & BODY_CRUDE)) return;
    double least = HUGE_VAL;
    for (const double a : m.p.length) least = std::min(least, a);
    for (const auto &atoms : m.p.bodies)
        for (const double l : reference::shape_of_body(m.p, atoms).length) least = std::min(least, l);
    least *= d.decades(-8, -2);
    for (const auto &atoms : m.p.bodies)
        for (const std::size_t a : atoms)
            for (std::size_t x = 0; x < 3; ++x) m.p.r[3 * a + x] += least * d.uniform(-1, 1);
}

/** Whether all bodies are what they are beyond doubt. */
bool is_clear(hostile_body &m)
{
    m.refused = false;
    for (std::size_t b = 0; b < m.p.bodies.size(); ++b) {
        const reference::body_facts facts = reference::facts_of_body(m.p, b);
        if (facts.flagged || facts.rank == 0) return false;
        m.refused = m.refused || facts.refused;
        for (const auto &pair : m.p.pairs)
            for (const std::size_t end : pair)
                m.refused = m.refused ||
                            std::find(facts.off_plane.begin(), facts.off_plane.end(), end) != facts.off_plane.end();
    }
    return true;
}

}  // namespace

void draw_motion(hostile_body &m, molecule_dice &d)
{
    rigid_problem &p = m.p;
    const std::size_t n = p.n_atoms();
    const std::size_t special = static_cast<std::size_t>(d.whole(0, static_cast<std::int64_t>(n) - 1));
    const bool at_rest = d.chance(0.15);
    p.v.assign(3 * n, 0);
    p.f.assign(3 * n, 0);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t x = 0; x < 3; ++x) {
            const double v = d.normal() / std::sqrt(p.mass[i] > 0 ? p.mass[i] : 1), f = d.normal();
            if (!at_rest && p.mass[i] >= 0) p.v[3 * i + x] = v;
            if (!(m.features & BODY_ONE_PULLED) || i == special) p.f[3 * i + x] = f;
        }
    if (m.features & BODY_CONSISTENT) {
        const reference::rigid_solution s = reference::solve_rigid(p, {}, {}, 0);
        if (s.regular)
            for (std::size_t i = 0; i < p.v.size(); ++i) p.v[i] = static_cast<double>(s.velocities.moved[i]);
    }
    const double rate = p.pairs.empty() && p.bodies.empty() ? 1 : fastest(p), drift = d.decades(-9, -1.5);
    m.dt = rate > 0 ? drift / rate : 0;
    if (!std::isfinite(m.dt)) m.dt = 0;
}

void mirror_if_it_matters(rigid_problem &p, std::size_t body)
{
    if (reference::facts_of_body(p, body).off_plane.empty()) return;
    for (const std::size_t atom : p.bodies[body]) p.place[3 * atom] *= -1;
}

bool set_lengths(hostile_body &m)
{
    m.p.length.clear();
    const double extent = largest(m.p.r);
    for (const auto &pair : m.p.pairs) {
        m.p.length.push_back(distance(m.p, pair[0], pair[1]));
        if (!(m.p.length.back() > 1e-10 * extent)) return false;  // all but rounding
    }
    return true;
}

const char *body_class_name(int c)
{
    static const char *const names[LISTED + 1] = {"lone bodies",    "joined bodies", "loops of bodies",
                                                  "crowded bodies", "relations",     "dependent lists"};
    return names[c];
}

std::vector<double> hostile_body::drifted() const
{
    std::vector<double> out = p.r;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += dt * p.v[i];
    return out;
}

std::vector<double> hostile_body::right_hand_side() const
{
    random_stream stream = random_seed(seed + 11);
    std::vector<double> rhs;
    for (double a : p.length) rhs.push_back(a * a * random_normal(&stream));
    return rhs;
}

std::string hostile_body::words() const
{
    static const char *const names[n_body_features] = {"masses apart", "sites",      "near a line", "near a plane",
                                                       "far off",      "held fixed", "sizes apart", "aligned",
                                                       "one pulled",   "consistent", "crude"};
    std::string all = body_class_name(shape);
    for (int bit = 0; bit < n_body_features; ++bit)
        if (features >> bit & 1u) all += std::string(", ") + names[bit];
    return all;
}

hostile_body make_hostile_body(std::uint64_t seed)
{
    molecule_dice d{random_seed(seed * UINT64_C(0x9e3779b97f4a7c15) + 29)};
    const double share = d.uniform(0, 0.6);  // between ordinary molecules and those that have everything
    unsigned features = 0;
    for (int bit = 0; bit < n_body_features; ++bit)
        if (d.chance(share)) features |= 1u << bit;
    for (;;) {
        hostile_body m;
        m.seed = seed;
        m.shape = static_cast<body_class>(seed % N_BODY_CLASSES);
        m.features = features;
        place_bodies(m, d);
        renumber(m, d);
        if (!is_clear(m) || !set_lengths(m)) continue;
        if (m.refused && d.chance(0.9)) continue;
        if (!m.refused) roughen(m, d);
        if (!set_lengths(m)) continue;
        draw_motion(m, d);
        return m;
    }
}

hostile_body make_twin(const hostile_body &of, std::uint64_t seed)
{
    hostile_body m = of;
    m.seed = seed;
    molecule_dice d{random_seed(seed * UINT64_C(0x9e3779b97f4a7c15) + 31)};
    const turn t(d);
    for (std::size_t i = 0; i < m.p.n_atoms(); ++i) {
        const long double from[3] = {of.p.r[3 * i], of.p.r[3 * i + 1], of.p.r[3 * i + 2]};
        long double to[3];
        t.apply(from, to);
        for (std::size_t x = 0; x < 3; ++x) m.p.r[3 * i + x] = static_cast<double>(to[x]);
    }
    if (m.shape != LISTED) draw_motion(m, d);
    return m;
}

}  // namespace stress
