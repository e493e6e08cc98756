// Atoms between which linear relations hold: sites by a base, groups that share atoms, atoms that are one point,
// centroids that coincide; with bonds that make some of them flat, straight or rigid.
#include <algorithm>
#include <cmath>
#include <set>

#include "hostile_body.hpp"

namespace stress
{

namespace
{

class related_maker
{
public:
    related_maker(hostile_body &m, molecule_dice &d) : m_(m), d_(d)
    {
    }

    /** False if it is no molecule: try again. */
    bool run()
    {
        const std::int64_t groups = d_.whole(1, 3);
        for (std::int64_t g = 0; g < groups; ++g) add_group();
        const std::int64_t tails = d_.whole(0, 4);
        for (std::int64_t t = 0; t < tails; ++t) add_tail();
        m_.p.parts.push_back({all_related(), {}});
        const std::vector<std::size_t> &atoms = m_.p.parts[0].atoms;
        for (const relation &one : relations_) {
            m_.p.parts[0].relations.emplace_back(atoms.size());
            for (std::size_t i = 0; i < one.atoms.size(); ++i) {
                const auto place = std::lower_bound(atoms.begin(), atoms.end(), one.atoms[i]) - atoms.begin();
                m_.p.parts[0].relations.back()[static_cast<std::size_t>(place)] += one.c[i];
            }
        }
        if (m_.features & BODY_FAR_OFF)
            for (std::size_t x = 0; x < 3; ++x) {
                const double offset = d_.normal() * d_.decades(0, 6);
                for (std::size_t i = 0; i < m_.p.n_atoms(); ++i) m_.p.r[3 * i + x] += offset;
            }
        return true;
    }

private:
    struct relation {
        std::vector<std::size_t> atoms;
        std::vector<double> c;
    };
    hostile_body &m_;
    molecule_dice &d_;
    std::vector<relation> relations_;

    bool has(unsigned feature) const
    {
        return (m_.features & feature) != 0;
    }
    double draw_mass()
    {
        return has(BODY_MASSES_APART) ? d_.decades(-4, 4) : d_.uniform(1, 3);
    }
    std::size_t add_atom(double mass, const point &r)
    {
        m_.p.mass.push_back(mass);
        m_.p.r.insert(m_.p.r.end(), r.begin(), r.end());
        m_.p.place.insert(m_.p.place.end(), 3, 0.0);
        return m_.p.n_atoms() - 1;
    }
    std::size_t any()
    {
        return static_cast<std::size_t>(d_.whole(0, static_cast<std::int64_t>(m_.p.n_atoms()) - 1));
    }
    std::vector<std::size_t> all_related() const
    {
        std::set<std::size_t> atoms;
        for (const relation &one : relations_) atoms.insert(one.atoms.begin(), one.atoms.end());
        return {atoms.begin(), atoms.end()};
    }
    void join(std::size_t i, std::size_t j)
    {
        for (const auto &pair : m_.p.pairs)
            if (std::minmax(pair[0], pair[1]) == std::minmax(i, j)) return;
        m_.p.pairs.push_back({i, j});
    }

    /** A base of two to four atoms, the first one of another group, nearly flat to 1e-5; sites of it. */
    void add_group()
    {
        const std::int64_t n = d_.whole(2, 4);
        const double thin = has(BODY_PLANE) ? d_.decades(-5, 0) : 1;
        const point axis = d_.direction(), normal = d_.normal_to(axis);
        std::vector<std::size_t> base;
        point start{};
        if (m_.p.n_atoms() > 0) {
            base.push_back(any());
            for (std::size_t x = 0; x < 3; ++x) start[x] = m_.p.r[3 * base[0] + x];
        }
        while (base.size() < static_cast<std::size_t>(n)) {
            point r = start;
            const point u = d_.direction();
            const double along = d_.uniform(0.5, 2) * (d_.chance(0.5) ? 1 : -1);
            const double out = n > 2 ? thin * d_.normal() : 0;
            for (std::size_t x = 0; x < 3; ++x)
                r[x] += along * (n == 3 ? axis[x] : u[x]) + out * (n == 3 ? normal[x] : 0);
            base.push_back(add_atom(draw_mass(), r));
        }
        const std::int64_t sites = d_.whole(1, 4);
        for (std::int64_t s = 0; s < sites; ++s) {
            relation one{base, {}};
            double rest = 1;
            for (std::size_t b = 1; b < base.size(); ++b) one.c.push_back(d_.normal()), rest -= one.c.back();
            one.c.insert(one.c.begin(), rest);
            point r;
            for (std::size_t x = 0; x < 3; ++x) {
                long double sum = 0;
                for (std::size_t b = 0; b < base.size(); ++b)
                    sum += static_cast<long double>(one.c[b]) * m_.p.r[3 * base[b] + x];
                r[x] = static_cast<double>(sum);
            }
            one.atoms.push_back(add_atom(has(BODY_SITES) && d_.chance(0.5) ? 0 : draw_mass(), r));
            one.c.push_back(-1);
            relations_.push_back(one);
        }
        if (d_.chance(0.2)) {  // an atom at the same point as one of the base
            const std::size_t of = base.back();
            const point r = {m_.p.r[3 * of], m_.p.r[3 * of + 1], m_.p.r[3 * of + 2]};
            relations_.push_back({{of, add_atom(draw_mass(), r)}, {1, -1}});
        }
        if (d_.chance(0.7))  // rigid, or a part of it
            for (std::size_t a = 0; a < base.size(); ++a)
                for (std::size_t b = 0; b < a; ++b)
                    if (d_.chance(0.9)) join(base[b], base[a]);
    }

    /** A chain from a massive atom, to a fixed one now and then. */
    void add_tail()
    {
        std::size_t from = any();
        for (std::int64_t steps = d_.whole(1, 3); steps > 0 && m_.p.mass[from] >= 0; --steps) {
            point r = {m_.p.r[3 * from], m_.p.r[3 * from + 1], m_.p.r[3 * from + 2]};
            const point u = d_.direction();
            const double length = d_.uniform(0.5, 2);
            for (std::size_t x = 0; x < 3; ++x) r[x] += length * u[x];
            const std::size_t next = add_atom(has(BODY_HELD_FIXED) && d_.chance(0.3) ? -1 : draw_mass(), r);
            join(from, next);
            from = next;
        }
    }
};

}  // namespace

hostile_body make_related(std::uint64_t seed)
{
    molecule_dice d{random_seed(seed * UINT64_C(0x9e3779b97f4a7c15) + 41)};
    const double share = d.uniform(0, 0.6);
    unsigned features = 0;
    for (const unsigned bit :
         {BODY_MASSES_APART, BODY_SITES, BODY_PLANE, BODY_FAR_OFF, BODY_HELD_FIXED, BODY_ONE_PULLED, BODY_CONSISTENT})
        if (d.chance(share)) features |= bit;
    for (;;) {
        hostile_body m;
        m.seed = seed;
        m.shape = RELATED;
        m.features = features;
        if (!related_maker(m, d).run() || !set_lengths(m)) continue;
        draw_motion(m, d);
        return m;
    }
}

}  // namespace stress
