#include "seam_molecule.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "random.h"

namespace stress
{

namespace
{

std::size_t at(std::int64_t i)
{
    return static_cast<std::size_t>(i);
}

/** Grows a run of so many atoms from one. Returns the last. */
std::int64_t grow(seam_graph &g, std::int64_t from, std::int64_t length)
{
    for (std::int64_t k = 0; k < length; ++k) {
        const std::int64_t last = static_cast<std::int64_t>(g.parent.size());
        g.parent.push_back(k == 0 ? from : last - 1);
    }
    return static_cast<std::int64_t>(g.parent.size()) - 1;
}

/** Runs between branch atoms, at which `subtrees` of them begin. */
void grow_runs(seam_graph &g, const std::vector<std::int64_t> &lengths, std::int64_t subtrees)
{
    std::vector<std::int64_t> ends{0};
    std::size_t next = 0;
    for (std::size_t e = 0; next < lengths.size(); ++e)
        for (std::int64_t b = 0; b < subtrees && next < lengths.size(); ++b)
            ends.push_back(grow(g, ends[e], lengths[next++]));
}

/** Grid points keep right angles and straight joints exact. */
double on_grid(double x)
{
    return std::ldexp(std::nearbyint(std::ldexp(x, 24)), -24);
}

const seam_kind *kind_at(const std::vector<put_at> &puts, std::int64_t atom)
{
    for (const put_at &p : puts)
        if (p.atom == atom) return &p.kind;
    return nullptr;
}

void draw_positions(const seam_graph &g, const std::vector<put_at> &puts, random_stream &s, seam_molecule &m)
{
    std::vector<double> u(3 * g.parent.size(), 0);  // of the bond to the parent
    for (std::size_t i = 1; i < g.parent.size(); ++i) {
        const std::size_t p = at(g.parent[i]);
        double d[3];
        random_direction(&s, d);
        for (std::size_t x = 0; x < 3; ++x) d[x] = on_grid(d[x]);
        const seam_kind *const here = kind_at(puts, static_cast<std::int64_t>(i)), *const there =
                                                                                       p ? kind_at(puts, g.parent[i])
                                                                                         : nullptr;
        if (here && *here == SQUARE_SEAM) d[0] = 1, d[1] = d[2] = 0;
        if (there && *there == SQUARE_SEAM) d[0] = 0;
        if (there && *there == STRAIGHT_SEAM) std::copy_n(u.begin() + static_cast<std::ptrdiff_t>(3 * p), 3, d);
        for (std::size_t x = 0; x < 3; ++x) {
            u[3 * i + x] = d[x];
            m.r[3 * i + x] = m.r[3 * p + x] + d[x];
        }
    }
}

void put_masses_and_pulls(const seam_graph &g, const std::vector<put_at> &puts, seam_molecule &m)
{
    for (const put_at &p : puts) {
        const std::size_t i = at(p.atom), j = at(g.walk(p.atom, 1));
        if (p.kind == FIXED_SEAM) m.mass[i] = 0;
        if (p.kind == UNEQUAL_SEAM) m.mass[i] = 0x1p20, m.mass[j] = 0x1p-20;
        for (std::size_t x = 0; x < 3 && p.kind == PULLED_SEAM; ++x) m.f[3 * i + x] *= 1e10, m.v[3 * i + x] *= 1e3;
    }
    for (std::size_t i = 0; i < m.mass.size(); ++i) {
        m.w[i] = m.mass[i] > 0 ? 1 / m.mass[i] : 0;
        for (std::size_t x = 0; x < 3; ++x) m.v[3 * i + x] *= std::sqrt(m.w[i]);
    }
}

/** Lengths, and a step in which no bond moves by more than a hundredth of its own. */
void complete(seam_molecule &m)
{
    m.dt = 1;
    for (std::size_t k = 0; k < m.pairs.size() / 2; ++k) {
        long double d = 0, dv = 0;
        for (std::size_t x = 0; x < 3; ++x) {
            const std::size_t i = 3 * at(m.pairs[2 * k]) + x, j = 3 * at(m.pairs[2 * k + 1]) + x;
            d += (static_cast<long double>(m.r[j]) - m.r[i]) * (static_cast<long double>(m.r[j]) - m.r[i]);
            dv += (static_cast<long double>(m.v[j]) - m.v[i]) * (static_cast<long double>(m.v[j]) - m.v[i]);
        }
        m.length.push_back(static_cast<double>(std::sqrt(d)));
        if (dv > 0) m.dt = std::min(m.dt, static_cast<double>(0.01L * std::sqrt(d / dv)));
    }
    for (std::size_t i = 0; i < m.r.size(); ++i) m.drifted.push_back(m.r[i] + m.dt * m.v[i]);
}

}  // namespace

const char *seam_shape_name(int shape)
{
    static const char *const names[N_SEAM_SHAPES] = {"arms", "paths", "tiles of a tree", "tiles"};
    return names[shape];
}

const char *seam_kind_name(int kind)
{
    static const char *const names[N_SEAM_KINDS] = {"a fixed atom", "a right angle", "a straight joint",
                                                    "heavy beside light", "a large force"};
    return names[kind];
}

std::int64_t seam_graph::walk(std::int64_t atom, int steps) const
{
    if (steps < 0) return neighbours[at(atom)].front();
    for (; steps > 0; --steps) atom = neighbours[at(atom)].back();
    return atom;
}

seam_graph make_seam_graph(seam_shape shape)
{
    seam_graph g;
    g.parent.push_back(-1);
    std::vector<std::pair<std::int64_t, std::int64_t>> bonds;
    if (shape == ARMS) grow_runs(g, {90, 60, 700, 42, 1200, 150, 41, 300, 1100, 50, 45, 64}, 3);
    if (shape == PATHS) grow_runs(g, {1400, 600, 130, 900, 800, 200, 1500, 129}, 3);
    if (shape == TREE_TILES) {
        std::vector<std::int64_t> lengths;
        for (std::int64_t n = 0, k = 0; n < 17500; n += lengths.back(), ++k) lengths.push_back(1 + k * k % 31);
        grow_runs(g, lengths, 2);
    }
    if (shape ==
        TILES)  // every fourth atom hangs at the one before it; every tenth of the others closes a ring of five
        for (std::int64_t i = 1, last = 0, behind = 0, number = 0; i < 16000; ++i) {
            g.parent.push_back(last);
            if (i % 4 == 3) continue;
            last = i;
            if (number % 10 == 4) bonds.emplace_back(behind, i);
            if (number++ % 10 == 0) behind = i;
        }
    for (std::size_t i = 1; i < g.parent.size(); ++i) bonds.emplace_back(g.parent[i], static_cast<std::int64_t>(i));
    std::sort(bonds.begin(), bonds.end());
    g.neighbours.resize(g.parent.size());
    for (const auto &b : bonds) {
        g.pairs.insert(g.pairs.end(), {b.first, b.second});
        g.neighbours[at(b.first)].push_back(b.second);
        g.neighbours[at(b.second)].push_back(b.first);
    }
    for (auto &n : g.neighbours) std::sort(n.begin(), n.end());
    return g;
}

molecule_problem seam_molecule::problem() const
{
    return {static_cast<std::int64_t>(w.size()),
            static_cast<std::int64_t>(length.size()),
            pairs.data(),
            w.data(),
            r.data(),
            v.data(),
            f.data(),
            nullptr};
}

seam_molecule make_seam_molecule(const seam_graph &g, const std::vector<put_at> &puts, std::uint64_t seed)
{
    seam_molecule m;
    random_stream s = random_seed(seed);
    const std::size_t n = g.parent.size();
    m.pairs = g.pairs;
    m.r.assign(3 * n, 0), m.w.resize(n);
    draw_positions(g, puts, s, m);
    for (std::size_t i = 0; i < n; ++i) m.mass.push_back(static_cast<double>(UINT64_C(1) << random_integer(&s, 0, 3)));
    for (std::size_t i = 0; i < 3 * n; ++i) m.v.push_back(random_normal(&s)), m.f.push_back(random_normal(&s));
    put_masses_and_pulls(g, puts, m);
    complete(m);
    return m;
}

}  // namespace stress
