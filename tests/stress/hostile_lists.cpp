// Lists of distances that depend on each other, as topology files have them: all bonds and all angles of molecules
// whose centres are straight, flat, pyramids or tetrahedra, with lengths of some decimals.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "holonomic.h"
#include "hostile_body.hpp"
#include "molecule_results.hpp"
#include "wide_functions.hpp"

namespace stress
{

namespace
{

using real = reference::wide_float<320>;

class list_maker
{
public:
    list_maker(hostile_body &m, molecule_dice &d) : m_(m), d_(d)
    {
    }

    void run()
    {
        add_atom({0, 0, 0});
        add_centre(0, nullptr);
        const std::int64_t more = d_.whole(0, 3);
        for (std::int64_t k = 0; k < more; ++k) {
            const auto &end = ends_[static_cast<std::size_t>(d_.whole(0, static_cast<std::int64_t>(ends_.size()) - 1))];
            const std::array<std::size_t, 2> chosen = end;
            if (centres_.count(chosen[0]) > 0) continue;
            add_centre(chosen[0], &chosen[1]);
        }
        for (std::size_t i = 0; i < m_.p.r.size() / 3; ++i)
            m_.p.mass.push_back(m_.features & BODY_MASSES_APART ? d_.decades(-2, 2) : d_.uniform(1, 16));
        const double digits = std::pow(10.0, static_cast<double>(d_.whole(4, 9)));
        for (const auto &pair : m_.p.pairs) {
            const double length = distance(pair[0], pair[1]);
            m_.listed.push_back(full_ ? length : std::round(length * digits) / digits);
        }
    }

private:
    hostile_body &m_;
    molecule_dice &d_;
    const bool full_ = d_.chance(0.2);  // all digits
    std::set<std::size_t> centres_;
    std::vector<std::array<std::size_t, 2>> ends_;  // an atom of one bond, and its partner

    std::size_t add_atom(const point &r)
    {
        m_.p.r.insert(m_.p.r.end(), r.begin(), r.end());
        m_.p.place.insert(m_.p.place.end(), 3, 0.0);
        return m_.p.r.size() / 3 - 1;
    }
    double distance(std::size_t i, std::size_t j) const
    {
        long double square = 0;
        for (std::size_t x = 0; x < 3; ++x) {
            const long double d = static_cast<long double>(m_.p.r[3 * j + x]) - m_.p.r[3 * i + x];
            square += d * d;
        }
        return static_cast<double>(std::sqrt(square));
    }
    point at(std::size_t i) const
    {
        return {m_.p.r[3 * i], m_.p.r[3 * i + 1], m_.p.r[3 * i + 2]};
    }

    /** Neighbours of an atom, one of which may be there: on a line, in a plane, or in space. */
    void add_centre(std::size_t centre, const std::size_t *before)
    {
        centres_.insert(centre);
        const std::int64_t drawn = d_.whole(0, 3);
        const std::int64_t kind = !before && drawn == 2 ? 3 : drawn;  // a pyramid alone depends on nothing
        point u = d_.direction();
        std::vector<std::size_t> group{centre};
        if (before) {
            double size = 0;
            for (std::size_t x = 0; x < 3; ++x) {
                u[x] = m_.p.r[3 * *before + x] - m_.p.r[3 * centre + x];
                size += u[x] * u[x];
            }
            for (double &x : u) x /= std::sqrt(size);
            group.push_back(*before);
        }
        const point v = d_.normal_to(u);
        point w;
        for (std::size_t x = 0; x < 3; ++x) w[x] = u[(x + 1) % 3] * v[(x + 2) % 3] - u[(x + 2) % 3] * v[(x + 1) % 3];
        const std::int64_t neighbours = kind == 0 ? 2 : kind == 1 ? 3 : kind == 2 ? 3 : 4;
        // Degrees by which a pyramid is not flat, which lengths with all digits tell; 0: many.
        const double bend = kind == 2 && full_ && d_.chance(0.5) ? d_.decades(-3.2, 0.5) : 0;
        const double polar = (kind == 1 || bend > 0 ? 120 : 109.5) + d_.uniform(-4, 4), radian = std::acos(-1.0) / 180;
        for (std::int64_t k = 0; k < neighbours; ++k) {
            if (k == 0 && before) continue;
            const double turn = kind == 1  ? 180 * static_cast<double>(k - 1)
                                : bend > 0 ? 180 * static_cast<double>(k - 1) + (k == 1 ? bend : 0)
                                           : 120 * static_cast<double>(k) + d_.uniform(-8, 8);
            const double angle = k == 0 ? 0 : kind == 0 ? 180 : polar + d_.uniform(-3, 3), length = d_.uniform(1, 1.6);
            const double c = kind == 0 && k > 0 ? -1 : std::cos(angle * radian),
                         s = kind == 0 || k == 0 ? 0 : std::sin(angle * radian);
            const double t = kind == 1 ? 0 : std::sin(turn * radian),
                         q = kind == 1 ? (k == 1 ? 1 : -1) : std::cos(turn * radian);
            point r = at(centre);
            for (std::size_t x = 0; x < 3; ++x) r[x] += length * (c * u[x] + s * (q * v[x] + t * w[x]));
            group.push_back(add_atom(r));
            ends_.push_back({group.back(), centre});
        }
        for (std::size_t a = 0; a < group.size(); ++a)
            for (std::size_t b = 0; b < a; ++b) join(group[b], group[a]);
        m_.groups.push_back({group, kind == 0 ? 1 : kind == 1 ? 2 : 3});
    }
    void join(std::size_t i, std::size_t j)
    {
        for (const auto &pair : m_.p.pairs)
            if (std::minmax(pair[0], pair[1]) == std::minmax(i, j)) return;
        m_.p.pairs.push_back({i, j});
    }
};

class completion
{
public:
    explicit completion(hostile_body &m) : m_(m)
    {
    }
    void run()
    {
        impose();
        find_parts();
    }

private:
    hostile_body &m_;

    /** Positions of the lengths as the library adjusts them, which are near. */
    void impose()
    {
        std::vector<std::int64_t> pairs;
        for (const auto &pair : m_.p.pairs)
            for (const std::size_t end : pair) pairs.push_back(static_cast<std::int64_t>(end));
        hol_chains *chains = nullptr;
        int status = hol_chains_create(static_cast<std::int64_t>(m_.p.n_atoms()), m_.p.mass.data(), &chains);
        if (status == HOL_OK)
            status = hol_chains_add_bonds(chains, static_cast<std::int64_t>(m_.listed.size()), pairs.data(),
                                          m_.listed.data());
        if (status == HOL_OK) hol_impose(chains, m_.p.r.data(), nullptr);  // else the check names it
        hol_chains_destroy(chains);
    }

    using vec = reference::vector3<real>;
    vec wide(std::size_t i) const
    {
        return {real(m_.p.r[3 * i]), real(m_.p.r[3 * i + 1]), real(m_.p.r[3 * i + 2])};
    }

    /** Relations of each group by a base, of the positions; distances that are independent beside them, as gradients
     * of all at these positions have them; and the number of freedoms. */
    void find_parts()
    {
        std::map<std::size_t, std::vector<std::pair<std::size_t, double>>> followers;
        std::vector<std::vector<real>> rows;  // what has been kept, orthogonal
        const std::size_t n = m_.p.n_atoms();
        reference::loose_part part;
        for (std::size_t i = 0; i < n; ++i) part.atoms.push_back(i);
        const auto keep = [&](std::vector<real> row) {
            real before(0), after(0);
            for (const real &x : row) before += x * x;
            for (int pass = 0; pass < 2; ++pass)
                for (const std::vector<real> &other : rows) {
                    real along(0);
                    for (std::size_t e = 0; e < row.size(); ++e) along += row[e] * other[e];
                    for (std::size_t e = 0; e < row.size(); ++e) row[e] -= along * other[e];
                }
            for (const real &x : row) after += x * x;
            if (after < before * real(1e-16)) return false;
            const real size = reference::square_root(after);
            for (real &x : row) x /= size;
            rows.push_back(std::move(row));
            return true;
        };
        for (const auto &[group, dimension] : m_.groups) {
            const std::size_t base = static_cast<std::size_t>(dimension) + 1;
            for (std::size_t s = base; s < group.size(); ++s) {
                std::vector<double> c(n);
                const std::vector<double> of = coefficients(group, base, group[s]);
                for (std::size_t b = 0; b < base; ++b) c[group[b]] = of[b];
                c[group[s]] = -1;
                bool kept = true;
                for (std::size_t x = 0; x < 3; ++x) {
                    std::vector<real> row(3 * n);
                    for (std::size_t i = 0; i < n; ++i) row[3 * i + x] = real(c[i]);
                    kept = keep(row) && kept;
                }
                if (kept) part.relations.push_back(c);
            }
        }
        for (std::size_t k = 0; k < m_.p.pairs.size(); ++k) {
            const auto [i, j] = m_.p.pairs[k];
            const vec d = reference::difference(wide(j), wide(i));
            std::vector<real> row(3 * n);
            for (std::size_t x = 0; x < 3; ++x) row[3 * i + x] = -d[x], row[3 * j + x] = d[x];
            m_.p.implied.push_back(!keep(row));
        }
        m_.freedoms = static_cast<std::int64_t>(3 * n - rows.size());
        m_.p.parts = {part};
    }

    /** Of a base at whose combination an atom is, the atom from the first one: Gram and Schmidt's method. */
    std::vector<double> coefficients(const std::vector<std::size_t> &group, std::size_t base, std::size_t atom) const
    {
        std::vector<vec> axis, from;
        for (std::size_t b = 1; b < base; ++b) from.push_back(reference::difference(wide(group[b]), wide(group[0])));
        axis = from;
        for (std::size_t b = 0; b < axis.size(); ++b)
            for (std::size_t a = 0; a < b; ++a)
                reference::add_times(axis[b], -(product(axis[b], axis[a]) / product(axis[a], axis[a])), axis[a]);
        vec left = reference::difference(wide(atom), wide(group[0]));
        std::vector<double> c(base);
        real rest(1);
        for (std::size_t b = base - 1; b > 0; --b) {
            const real part = product(left, axis[b - 1]) / product(axis[b - 1], axis[b - 1]);
            reference::add_times(left, -part, from[b - 1]);
            c[b] = static_cast<double>(part);
            rest -= real(c[b]);
        }
        c[0] = static_cast<double>(rest);
        return c;
    }
};

}  // namespace

hostile_body make_listed(std::uint64_t seed)
{
    molecule_dice d{random_seed(seed * UINT64_C(0x9e3779b97f4a7c15) + 43)};
    unsigned features = 0;
    for (const unsigned bit : {BODY_MASSES_APART, BODY_ONE_PULLED})
        if (d.chance(0.3)) features |= bit;
    // What holds a group is not unique: of other velocities each choice makes another acceleration.
    features |= BODY_CONSISTENT;
    hostile_body m;
    m.seed = seed;
    m.shape = LISTED;
    m.features = features;
    list_maker(m, d).run();
    return m;
}

void complete_listed(hostile_body &m)
{
    completion(m).run();
    molecule_dice d{random_seed(m.seed * UINT64_C(0x9e3779b97f4a7c15) + 47)};
    set_lengths(m);
    draw_motion(m, d);
}

}  // namespace stress
