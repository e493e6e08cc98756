#include <algorithm>

#include "molecule.h"
#include "molecule_dice.hpp"

namespace stress
{

namespace
{

const double pi = 3.14159265358979323846;

std::size_t at(std::int64_t i)
{
    return static_cast<std::size_t>(i);
}

void add_atom(hostile_molecule &m, const point &r)
{
    m.r.insert(m.r.end(), r.begin(), r.end());
    m.w.push_back(1);
}

point where(const hostile_molecule &m, std::size_t i)
{
    return {m.r[3 * i], m.r[3 * i + 1], m.r[3 * i + 2]};
}

void add_bond(hostile_molecule &m, std::int64_t i, std::int64_t j)
{
    m.pairs.push_back(i);
    m.pairs.push_back(j);
}

double bond_length(const hostile_molecule &m, molecule_dice &d)
{
    if (!(m.features & LENGTHS_APART)) return d.uniform(0.7, 1.5);
    return m.shape == GRAPHS ? d.decades(-0.5, 0.5) : d.decades(-3, 3);
}

/** Which atom the next one of a tree is bonded to: any, mostly the last, or mostly one of the first. */
std::int64_t choose_parent(molecule_dice &d, int style, std::int64_t n)
{
    if (style == 0) return d.whole(0, n - 1);
    if (style == 1) return d.chance(0.7) ? n - 1 : d.whole(0, n - 1);
    return d.chance(0.6) ? d.whole(0, std::min<std::int64_t>(n - 1, 2)) : d.whole(0, n - 1);
}

}  // namespace

void draw_tree(hostile_molecule &m, molecule_dice &d)
{
    const bool soaks = m.seed >= first_of_soaks, star = soaks ? m.seed / 128 % 4 == 1 : m.seed >= first_star;
    const bool bushy = soaks ? m.seed / 128 % 4 == 0 : m.seed >= first_bush;
    const std::int64_t n = star ? d.whole(3, 5) : d.chance(0.02) ? d.whole(100, 300) : d.whole(1, 40);
    const int style = bushy ? 2 : static_cast<int>(d.whole(0, 2));
    const int valence = static_cast<int>(bushy ? d.whole(8, 40) : d.whole(2, 6));
    const double aligned = m.features & ALIGNED ? d.uniform(0.2, 1) : 0, fold = d.chance(0.5) ? 0 : d.uniform(0, 1);
    const double thickness = m.features & FLAT ? d.decades(-12, 0) : 1;
    std::vector<int> bonds{0};
    std::vector<point> along{d.direction()};
    add_atom(m, {0, 0, 0});
    while (static_cast<std::int64_t>(m.pairs.size()) < 2 * n) {
        const std::int64_t parent = star ? 0 : choose_parent(d, style, m.n_atoms());
        if (!star && bonds[at(parent)] >= valence) continue;
        point u = d.direction();
        if (d.chance(aligned)) {
            u = d.turned(along[at(parent)], d.chance(0.2) ? 0 : d.decades(-12, 0));
            if (d.chance(fold))
                for (double &x : u) x = -x;
        }
        u[2] *= thickness;
        const double size = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]), a = bond_length(m, d) / size;
        point r = where(m, at(parent));
        for (std::size_t x = 0; x < 3; ++x) r[x] += a * u[x], u[x] /= size;
        add_bond(m, parent, m.n_atoms());
        add_atom(m, r);
        ++bonds[at(parent)];
        bonds.push_back(1);
        along.push_back(u);
    }
}

/** Closed by taking the mean from bonds at random; pressed onto a line or a plane as a whole. */
void draw_ring(hostile_molecule &m, molecule_dice &d, std::int64_t size)
{
    std::vector<point> bond(at(size));
    point mean{0, 0, 0};
    const bool regular = d.chance(0.3);
    for (std::size_t k = 0; k < bond.size(); ++k) {
        const double phi = 2 * pi * static_cast<double>(k) / static_cast<double>(size), a = bond_length(m, d);
        bond[k] = d.direction();
        if (regular) bond[k] = {std::cos(phi), std::sin(phi), 0.1 * d.normal()};
        for (std::size_t x = 0; x < 3; ++x) {
            bond[k][x] *= regular ? 1 : a;
            mean[x] += bond[k][x] / static_cast<double>(size);
        }
    }
    const double line = m.features & ALIGNED ? d.decades(-12, 0) : 1, plane = m.features & FLAT ? d.decades(-12, 0) : 1;
    point r{0, 0, 0};
    for (std::int64_t k = 0; k < size; ++k) {
        add_atom(m, {r[0], r[1] * line, r[2] * line * plane});
        for (std::size_t x = 0; x < 3; ++x) r[x] += bond[at(k)][x] - mean[x];
        add_bond(m, k, (k + 1) % size);
    }
}

/** A chain whose angles are all rigid: each atom is bonded to the next and to the one behind that. */
void draw_strip(hostile_molecule &m, molecule_dice &d)
{
    const std::int64_t n = d.chance(0.05) ? d.whole(60, 200) : d.whole(4, 40);
    const double aligned = m.features & ALIGNED ? d.uniform(0.2, 1) : 0, fold = d.chance(0.5) ? 0 : d.uniform(0, 1);
    const double thickness = m.features & FLAT ? d.decades(-12, 0) : 1;
    point r{0, 0, 0}, u = d.direction();
    add_atom(m, r);
    for (std::int64_t i = 1; i < n; ++i) {
        const bool nearly = d.chance(aligned);
        u = d.turned(u, nearly ? d.decades(-5, 0) : d.uniform(0.5, 2));
        u[2] *= thickness;
        if (nearly && d.chance(fold))
            for (double &x : u) x = -x;
        const double size = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]), a = bond_length(m, d) / size;
        for (std::size_t x = 0; x < 3; ++x) r[x] += a * u[x], u[x] /= size;
        add_atom(m, r);
        add_bond(m, i - 1, i);
        if (i > 1) add_bond(m, i - 2, i);
    }
}

/** One of the shapes of molecule.h that have cycles, or a ring with trees on it; from first_strip on a strip, in soaks
 * half of the time. */
void draw_graph(hostile_molecule &m, molecule_dice &d)
{
    const bool bushy = m.seed >= first_bush && m.seed < first_of_soaks;
    if (m.seed >= first_strip && !bushy && (m.seed < first_of_soaks || m.seed / 64 % 2 == 0)) return draw_strip(m, d);
    static const molecule_kind kinds[] = {MOLECULE_BENZENE, MOLECULE_PUCKERED_BENZENE, MOLECULE_TRIANGLES,
                                          MOLECULE_ZIGZAG,  MOLECULE_TRIANGLES_179,    MOLECULE_FUSED_RINGS,
                                          MOLECULE_CUBE,    MOLECULE_LARIAT,           MOLECULE_PEPTIDE};
    const std::int64_t kind = bushy ? 9 : d.whole(0, 9);
    if (kind < 9) {
        const molecule_kind k = kinds[kind];
        const std::int64_t size =
            k == MOLECULE_PEPTIDE ? d.whole(3, 6) : d.whole(4, k == MOLECULE_FUSED_RINGS ? 8 : 30);
        molecule made = molecule_make(k, size, random_bits(&d.stream) >> 16);
        m.r.assign(made.r, made.r + 3 * made.n_atoms);
        m.w.assign(made.inverse_mass, made.inverse_mass + made.n_atoms);
        m.pairs.assign(made.pairs, made.pairs + 2 * made.n_bonds);
        molecule_free(&made);
        return;
    }
    draw_ring(m, d, d.whole(4, 20));
    const std::int64_t ring = m.n_atoms(), more = bushy ? d.whole(8, 40) : d.whole(1, 20);
    for (std::int64_t k = 0; k < more; ++k) {
        const std::int64_t near = bushy && d.chance(0.8) ? 2 : ring;
        const std::int64_t parent = d.chance(0.5) ? d.whole(0, near - 1) : d.whole(0, m.n_atoms() - 1);
        const double a = bond_length(m, d);
        point r = where(m, at(parent)), u = d.direction();
        for (std::size_t x = 0; x < 3; ++x) r[x] += a * u[x];
        add_bond(m, parent, m.n_atoms());
        add_atom(m, r);
    }
}

}  // namespace stress
