// Hostile bodies and the bonds at them, in space: thin and light ones, massless sites, fixed atoms, loops.
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

point at(const std::vector<double> &array, std::size_t i)
{
    return {array[3 * i], array[3 * i + 1], array[3 * i + 2]};
}

class maker
{
public:
    maker(hostile_body &m, molecule_dice &d) : m_(m), d_(d), lift_{random_seed(m.seed + 37)}
    {
    }

    void run()
    {
        switch (m_.shape) {
            case LONE:
                add_body(d_.chance(0.05) ? d_.whole(30, 100) : d_.whole(2, 12));
                break;
            case JOINED:
                d_.chance(0.2) ? stretch() : grow(d_.whole(1, d_.chance(0.1) ? 12 : 4), 0.5);
                break;
            case LOOPS:
                grow(d_.whole(3, 7), 0.2);
                close();
                break;
            default:
                crowd();
        }
        shift();
    }

private:
    hostile_body &m_;
    molecule_dice &d_, lift_;  // the latter for sites off planes alone

    bool has(unsigned feature) const
    {
        return (m_.features & feature) != 0;
    }
    double thinness()
    {
        return d_.chance(0.3) ? 0 : d_.chance(0.2) ? d_.decades(-14, -9.5) : d_.decades(-7, 0);
    }

    double draw_mass(std::int64_t style, double odd)
    {
        if (style == 0) return d_.decades(-6, 6);
        return d_.uniform(1, 3) * (style == 1 && d_.chance(0.3) ? odd : 1);
    }

    std::size_t add_atom(double mass, const point &r)
    {
        m_.p.mass.push_back(mass);
        m_.p.r.insert(m_.p.r.end(), r.begin(), r.end());
        m_.p.place.insert(m_.p.place.end(), 3, 0.0);
        return m_.p.n_atoms() - 1;
    }

    /** With its first atom at the origin. */
    std::size_t add_body(std::int64_t n)
    {
        rigid_problem &p = m_.p;
        const double size = has(BODY_SIZES_APART) ? d_.decades(-2, 2) : 1, second = has(BODY_LINE) ? thinness() : 1,
                     third = has(BODY_PLANE) ? thinness() : 1,
                     offset = has(BODY_FAR_OFF) ? d_.decades(0, 4) : d_.uniform(0, 3), odd = d_.decades(-6, 6);
        const std::int64_t style = has(BODY_MASSES_APART) ? d_.whole(0, 1) : 2;
        const turn of_places(d_), of_space(d_);
        const bool flat = second > 1e-3 && third < 1e-9;
        std::vector<std::array<long double, 3>> x;
        for (std::int64_t a = 0; a < n; ++a)
            x.push_back({size * static_cast<long double>(d_.normal()),
                         size * second * static_cast<long double>(d_.normal()),
                         size * second * third * static_cast<long double>(d_.normal())});
        const std::size_t first = p.n_atoms(), massive = x.size();
        const std::int64_t sites = has(BODY_SITES) ? d_.whole(1, 2) : 0;
        for (std::int64_t s = 0; s < sites; ++s) {
            std::array<long double, 3> site{};
            long double whole = 0;
            std::vector<long double> weight;
            for (std::size_t a = 0; a < massive; ++a) weight.push_back(d_.normal() + 0.5L), whole += weight.back();
            if (std::fabs(whole) < 0.5L) weight[0] += 2, whole += 2;
            for (std::size_t a = 0; a < massive; ++a)
                for (std::size_t c = 0; c < 3; ++c) site[c] += weight[a] / whole * x[a][c];
            if (flat && lift_.chance(0.5)) site[2] += size * (lift_.chance(0.5) ? 1 : -1) * lift_.decades(-6, 1);
            x.push_back(site);
        }
        p.bodies.emplace_back();
        const point away = d_.direction();
        for (std::size_t a = 0; a < x.size(); ++a) {
            long double place[3], here[3];
            const long double from[3] = {x[a][0] - x[0][0], x[a][1] - x[0][1], x[a][2] - x[0][2]};
            of_places.apply(x[a].data(), place);
            of_space.apply(from, here);
            const std::size_t i =
                add_atom(a < massive ? draw_mass(style, odd) : 0,
                         {static_cast<double>(here[0]), static_cast<double>(here[1]), static_cast<double>(here[2])});
            for (std::size_t c = 0; c < 3; ++c)
                p.place[3 * i + c] = static_cast<double>(place[c] + offset * static_cast<long double>(away[c]));
            p.bodies.back().push_back(i);
        }
        return first;
    }

    std::size_t any_of(const std::vector<std::size_t> &list)
    {
        return list[static_cast<std::size_t>(d_.whole(0, static_cast<std::int64_t>(list.size()) - 1))];
    }

    /** Where the other end of a bond at an atom goes. */
    point beyond(std::size_t atom, double length)
    {
        point u = d_.direction();
        if (has(BODY_ALIGNED))
            for (const std::vector<std::size_t> &body : m_.p.bodies) {
                if (std::find(body.begin(), body.end(), atom) == body.end()) continue;
                point c{};
                double size = 0;
                for (const std::size_t a : body)
                    for (std::size_t x = 0; x < 3; ++x)
                        c[x] += (m_.p.r[3 * atom + x] - m_.p.r[3 * a + x]) / static_cast<double>(body.size());
                for (const double y : c) size += y * y;
                if (size > 0)
                    for (std::size_t x = 0; x < 3; ++x) u[x] = c[x] / std::sqrt(size);
                u = d_.turned(u, d_.decades(-12, 0));
            }
        point r = at(m_.p.r, atom);
        for (std::size_t x = 0; x < 3; ++x) r[x] += length * u[x];
        return r;
    }

    double draw_length()
    {
        return has(BODY_SIZES_APART) ? d_.decades(-2, 2) : d_.uniform(0.5, 2);
    }

    void join(std::size_t i, std::size_t j)
    {
        m_.p.pairs.push_back({i, j});
    }

    std::size_t add_tail(std::size_t from, double fixed)
    {
        const std::int64_t style = has(BODY_MASSES_APART) ? 0 : 2;
        const bool held = has(BODY_HELD_FIXED) && d_.chance(fixed);
        const std::size_t i = add_atom(held ? -1 : draw_mass(style, 1), beyond(from, draw_length()));
        join(from, i);
        return i;
    }

    void add_joined_body(std::size_t from)
    {
        const point there = beyond(from, draw_length());
        const std::size_t first = add_body(d_.whole(2, 8));
        std::vector<std::size_t> &atoms = m_.p.bodies.back();
        const std::size_t end = any_of(atoms);
        const point here = at(m_.p.r, end);
        for (std::size_t i = first; i < m_.p.n_atoms(); ++i)
            for (std::size_t x = 0; x < 3; ++x) m_.p.r[3 * i + x] += there[x] - here[x];
        join(from, end);
    }

    bool can_join(std::size_t atom) const
    {
        return m_.p.mass[atom] >= 0;
    }

    /** Bodies and bonds between two fixed atoms, on a line but for 1e-12 .. 1e-2. */
    void stretch()
    {
        m_.features |= BODY_HELD_FIXED | BODY_ALIGNED;
        const double bend = d_.decades(-12, -2);
        const point line = d_.direction();
        std::size_t last = add_atom(-1, {});
        const auto next = [&] {
            point r = at(m_.p.r, last);
            const point u = d_.turned(line, bend);
            const double length = draw_length();
            for (std::size_t x = 0; x < 3; ++x) r[x] += length * u[x];
            return r;
        };
        for (std::int64_t b = d_.whole(1, 4); b > 0; --b) {
            const point start = next();
            const std::size_t first = add_body(d_.whole(2, 6));
            const std::size_t other = m_.p.bodies.back()[1];
            // mirrored, so that its second atom is on the line
            point n = at(m_.p.r, other);
            const point along = d_.turned(line, bend);
            const double apart = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            double square = 0;
            for (std::size_t x = 0; x < 3; ++x) n[x] -= apart * along[x], square += n[x] * n[x];
            for (const std::size_t a : m_.p.bodies.back()) {
                const double part =
                    square > 0
                        ? 2 * (n[0] * m_.p.r[3 * a] + n[1] * m_.p.r[3 * a + 1] + n[2] * m_.p.r[3 * a + 2]) / square
                        : 0;
                for (std::size_t x = 0; x < 3; ++x) m_.p.r[3 * a + x] += start[x] - part * n[x];
            }
            mirror_if_it_matters(m_.p, m_.p.bodies.size() - 1);
            join(last, first);
            last = other;
        }
        const point end = next();
        join(last, add_atom(-1, end));
    }

    /** A tree of bodies, with tails of atoms. */
    void grow(std::int64_t bodies, double tails)
    {
        add_body(d_.whole(2, 8));
        for (std::int64_t b = 1; b < bodies; ++b) {
            // most in a row, so that loops go round
            std::size_t from = any_of(d_.chance(0.7) ? m_.p.bodies.back() : m_.p.bodies[0]);
            if (d_.chance(0.3)) {
                const std::size_t between = add_tail(from, 0);
                from = between;
            }
            add_joined_body(from);
        }
        for (std::int64_t t = d_.whole(0, 6); t > 0 && (bodies == 1 || d_.chance(tails) || t == 1); --t) {
            std::size_t from = any_of(
                m_.p.bodies[static_cast<std::size_t>(d_.whole(0, static_cast<std::int64_t>(m_.p.bodies.size()) - 1))]);
            for (std::int64_t steps = d_.whole(1, 3); steps > 0 && can_join(from); --steps) from = add_tail(from, 0.4);
        }
        if (m_.p.pairs.empty()) add_tail(0, 0.4);
    }

    /** A few bonds more, between the first body and the last and between any two. */
    void close()
    {
        const std::vector<std::vector<std::size_t>> &bodies = m_.p.bodies;
        std::set<std::pair<std::size_t, std::size_t>> known;
        for (const auto &pair : m_.p.pairs) known.insert(std::minmax(pair[0], pair[1]));
        const std::int64_t n = static_cast<std::int64_t>(bodies.size());
        // Few, or nearly as many as there are freedoms left, or more.
        const std::int64_t most = 6 * n - 6 - static_cast<std::int64_t>(m_.p.pairs.size());
        for (std::int64_t more = d_.chance(0.7) ? d_.whole(1, n - 1) : most - d_.whole(-1, 4), k = 0; k < more; ++k) {
            const std::size_t b = static_cast<std::size_t>(k == 0 ? 0 : d_.whole(0, n - 1)),
                              c = static_cast<std::size_t>(k == 0 ? n - 1 : d_.whole(0, n - 1));
            if (b == c) continue;
            const std::size_t i = any_of(bodies[b]), j = any_of(bodies[c]);
            if (known.insert(std::minmax(i, j)).second) join(i, j);
        }
    }

    void crowd()
    {
        const std::int64_t n = d_.whole(10, 60), bonds = d_.chance(0.1) ? 100 : d_.whole(10, 40);
        add_body(n);
        std::int64_t held = 0;
        const std::vector<std::size_t> body = m_.p.bodies[0];
        for (std::int64_t k = 0; k < bonds; ++k) {
            const std::size_t from = any_of(body);
            if (d_.chance(0.1))
                add_joined_body(from);
            else if (m_.p.mass[add_tail(from, held < 3 ? 0.2 : 0)] < 0)
                ++held;
        }
    }

    void shift()
    {
        if (!has(BODY_FAR_OFF)) return;
        for (std::size_t x = 0; x < 3; ++x) {
            const double offset = (d_.chance(0.5) ? 1 : -1) * d_.decades(0, 8);
            for (std::size_t i = 0; i < m_.p.n_atoms(); ++i) m_.p.r[3 * i + x] += offset;
        }
    }
};

}  // namespace

void place_bodies(hostile_body &m, molecule_dice &d)
{
    maker(m, d).run();
}

}  // namespace stress
