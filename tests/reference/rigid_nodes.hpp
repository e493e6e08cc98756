// A molecule with rigid bodies as nodes: points and vectors of which its atoms are combinations, and products of
// combinations that are held.
#ifndef HOLONOMIC_TESTS_REFERENCE_RIGID_NODES_HPP
#define HOLONOMIC_TESTS_REFERENCE_RIGID_NODES_HPP

#include <algorithm>
#include <map>

#include "rigid_frame.hpp"
#include "rigid_solution.hpp"
#include "sparse_factor.hpp"

namespace reference
{

namespace rigid_nodes
{

using real = wide_float<320>;
using vec = vector3<real>;

const real zero_pivot = real(1).scaled(-200);  // least pivots below it are zero

inline vec row_of(const std::vector<double> &array, std::size_t i)
{
    return {real(array[3 * i]), real(array[3 * i + 1]), real(array[3 * i + 2])};
}

inline real largest(const vec &x)
{
    real most(0);
    for (const real &c : x)
        if (absolute(c) > most) most = absolute(c);
    return most;
}

inline vec sizes(const vec &x)
{
    return {absolute(x[0]), absolute(x[1]), absolute(x[2])};
}

struct share {
    std::size_t of;  // node or atom
    real factor;
};
using combination = std::vector<share>;

/** Half of <left, right> = target, each a combination of nodes. */
struct constraint {
    combination left, right;
    real target, scale, reach;
    std::ptrdiff_t bond;  // -1: of a body
};

inline vec at(const combination &c, const std::vector<vec> &nodes)
{
    vec sum{};
    for (const share &s : c) add_times(sum, s.factor, nodes[s.of]);
    return sum;
}

enum class kind { points, vectors };

/** A site off the plane of a body: + z first x second. */
struct lifted {
    std::size_t atom;
    combination first, second;
    real z;
};

class node_system
{
public:
    std::vector<real> w;               // of nodes
    std::vector<combination> of_atom;  // nodes of an atom
    std::vector<combination> of_node;  // atoms of a node
    std::vector<bool> in_body;         // atoms
    std::vector<lifted> sites;
    std::vector<constraint> rows;

    node_system(const rigid_problem &p, kind which) : of_atom(p.n_atoms()), in_body(p.n_atoms(), false)
    {
        for (const std::vector<std::size_t> &atoms : p.bodies) {
            const rigid_frame<real> frame(p, atoms, which == kind::vectors);
            which == kind::points ? add_points(p, atoms, frame) : add_vectors(p, atoms, frame);
        }
        for (const loose_part &part : p.parts) add_part(p, part, which == kind::vectors);
        for (std::size_t i = 0; i < p.n_atoms(); ++i) {
            if (in_body[i]) continue;
            of_atom[i] = {{w.size(), real(1)}};
            of_node.push_back({{i, real(1)}});
            w.push_back(p.mass[i] > 0 ? real(1) / real(p.mass[i]) : real(0));
        }
        for (std::size_t k = 0; k < p.pairs.size(); ++k)
            if (p.implied.empty() || !p.implied[k]) add_bond(p, k);
    }

    std::vector<vec> nodes(const std::vector<double> &array) const
    {
        std::vector<vec> q(w.size());
        for (std::size_t n = 0; n < q.size(); ++n)
            for (const share &s : of_node[n]) add_times(q[n], s.factor, row_of(array, s.of));
        return q;
    }
    /** Sums of sizes of what adds up to nodes. */
    std::vector<vec> node_sizes(const std::vector<double> &array) const
    {
        std::vector<vec> q(w.size());
        for (std::size_t n = 0; n < q.size(); ++n)
            for (const share &s : of_node[n]) add_times(q[n], absolute(s.factor), sizes(row_of(array, s.of)));
        return q;
    }
    std::vector<vec> forces(const std::vector<double> &array, bool of_sizes) const
    {
        std::vector<vec> q(w.size());
        for (std::size_t a = 0; a < of_atom.size(); ++a)
            for (const share &s : of_atom[a])
                add_times(q[s.of], of_sizes ? absolute(s.factor) : s.factor,
                          of_sizes ? sizes(row_of(array, a)) : row_of(array, a));
        return q;
    }

    /** What the forces on sites off planes do at q, on top of those above. */
    void add_lifted(const rigid_problem &p, const std::vector<vec> &q, bool of_sizes, std::vector<vec> &to) const
    {
        for (const lifted &site : sites) {
            vec f = row_of(p.f, site.atom), first = at(site.first, q), second = at(site.second, q), on[2];
            if (of_sizes) {
                on[0] = product_sizes(second, f), on[1] = product_sizes(f, first);
            } else {
                on[0] = cross_product(second, f), on[1] = cross_product(f, first);
            }
            for (int which = 0; which < 2; ++which)
                for (const share &s : which ? site.second : site.first)
                    add_times(to[s.of], of_sizes ? absolute(s.factor * site.z) : s.factor * site.z, on[which]);
        }
    }
    static vec product_sizes(const vec &a, const vec &b)
    {
        vec out;
        for (std::size_t x = 0; x < 3; ++x)
            out[x] = absolute(a[(x + 1) % 3] * b[(x + 2) % 3]) + absolute(a[(x + 2) % 3] * b[(x + 1) % 3]);
        return out;
    }

    struct gradient {
        std::size_t node;
        vec g;
    };
    using gradients = std::vector<std::vector<gradient>>;
    gradients differentiate(const std::vector<vec> &q) const
    {
        gradients all;
        for (const constraint &k : rows) {
            std::map<std::size_t, vec> sum;
            const vec left = at(k.left, q), right = at(k.right, q);
            for (const share &s : k.left) add_times(sum[s.of], s.factor.scaled(-1), right);
            for (const share &s : k.right) add_times(sum[s.of], s.factor.scaled(-1), left);
            all.emplace_back();
            for (const auto &[node, g] : sum) all.back().push_back({node, g});
        }
        return all;
    }
    sparse_matrix<real> matrix(const gradients &left, const gradients &right) const
    {
        std::vector<std::vector<std::pair<std::size_t, const vec *>>> of(w.size());
        for (std::size_t l = 0; l < right.size(); ++l)
            for (const gradient &g : right[l]) of[g.node].push_back({l, &g.g});
        sparse_matrix<real> a(rows.size());
        for (std::size_t k = 0; k < left.size(); ++k) {
            a[k][k];
            for (const gradient &g : left[k])
                if (w[g.node] > real(0))
                    for (const auto &[l, other] : of[g.node]) a[k][l] += w[g.node] * product(g.g, *other);
        }
        return a;
    }

private:
    void add_points(const rigid_problem &p, const std::vector<std::size_t> &atoms, const rigid_frame<real> &frame)
    {
        const std::size_t k = frame.rank + 1, first = w.size();
        std::vector<std::array<real, 3>> q(k);
        if (k == 2) q = {{real(1)}, {real(-1)}};
        if (k == 3) {
            const real s = square_root(real(2)), t = square_root(real(1.5));
            q = {{s, real(0)}, {-s.scaled(-1), t}, {-s.scaled(-1), -t}};
        }
        if (k == 4)
            q = {{real(1), real(1), real(1)},
                 {real(1), real(-1), real(-1)},
                 {real(-1), real(1), real(-1)},
                 {real(-1), real(-1), real(1)}};
        const real parts(static_cast<int>(k));
        std::array<combination, 2> axes;  // of a plane: sums over points of q / 3
        for (std::size_t d = 0; k == 3 && d < 2; ++d)
            for (std::size_t b = 0; b < k; ++b) axes[d].push_back({first + b, q[b][d] / parts});
        add_sites(atoms, frame, axes);
        for (std::size_t b = 0; b < k; ++b) {
            w.push_back(parts / frame.mass);
            of_node.emplace_back();
        }
        for (std::size_t a = 0; a < atoms.size(); ++a) {
            in_body[atoms[a]] = true;
            for (std::size_t b = 0; b < k; ++b) {
                real c(1);
                for (std::size_t d = 0; d < frame.rank; ++d) c += q[b][d] * frame.y[a][d];
                c /= parts;
                of_atom[atoms[a]].push_back({first + b, c});
                if (p.mass[atoms[a]] > 0)
                    of_node[first + b].push_back({atoms[a], parts / frame.mass * real(p.mass[atoms[a]]) * c});
            }
        }
        for (std::size_t b = 0; b < k; ++b)
            for (std::size_t c = 0; c < b; ++c) {
                vec apart{};
                for (std::size_t d = 0; d < frame.rank; ++d) add_times(apart, q[b][d] - q[c][d], frame.vectors[d]);
                const combination d = {{first + b, real(1)}, {first + c, real(-1)}};
                const real square = product(apart, apart);
                rows.push_back({d, d, square, square, square_root(square), -1});
            }
    }

    void add_sites(const std::vector<std::size_t> &atoms, const rigid_frame<real> &frame,
                   const std::array<combination, 2> &axes)
    {
        for (std::size_t a = 0; a < atoms.size(); ++a)
            if (frame.z[a] != real(0)) sites.push_back({atoms[a], axes[0], axes[1], frame.z[a]});
    }

    /** Coordinates of unit mass: those of the atoms that lead, whitened by a Cholesky factor of their masses, from the
     * first or from the last one on. */
    void add_part(const rigid_problem &p, const loose_part &part, bool from_last)
    {
        const std::vector<std::vector<real>> leads = leaders(part);
        const std::size_t n = part.atoms.size(), m = leads[0].size();
        std::vector<std::vector<real>> y(n, std::vector<real>(m)), l(m, std::vector<real>(m));
        for (std::size_t a = 0; a < n; ++a)
            for (std::size_t c = 0; c < m; ++c) y[a][c] = leads[a][from_last ? m - 1 - c : c];
        for (std::size_t c = 0; c < m; ++c)
            for (std::size_t d = 0; d <= c; ++d) {
                for (std::size_t a = 0; a < n; ++a) l[c][d] += real(p.mass[part.atoms[a]]) * y[a][c] * y[a][d];
                for (std::size_t e = 0; e < d; ++e) l[c][d] -= l[c][e] * l[d][e];
                l[c][d] = c == d ? square_root(l[c][d]) : l[c][d] / l[d][d];
            }
        for (auto &row : y)  // L y' = y
            for (std::size_t c = 0; c < m; ++c) {
                for (std::size_t e = 0; e < c; ++e) row[c] -= l[c][e] * row[e];
                row[c] /= l[c][c];
            }
        const std::size_t first = w.size();
        w.insert(w.end(), m, real(1));
        of_node.resize(first + m);
        for (std::size_t a = 0; a < n; ++a) {
            const std::size_t atom = part.atoms[a];
            in_body[atom] = true;
            for (std::size_t c = 0; c < m; ++c) {
                of_atom[atom].push_back({first + c, y[a][c]});
                if (p.mass[atom] > 0) of_node[first + c].push_back({atom, real(p.mass[atom]) * y[a][c]});
            }
        }
    }

    /** Atoms as sums of those that lead, by Gauss and Jordan's elimination; coefficients add up to 0 as the library has
     * it, by the largest one. */
    static std::vector<std::vector<real>> leaders(const loose_part &part)
    {
        const std::size_t n = part.atoms.size();
        std::vector<std::vector<real>> rows;
        for (const std::vector<double> &c : part.relations) {
            std::size_t most = 0;
            real sum(0);
            for (std::size_t a = 0; a < n; ++a)
                if (std::fabs(c[a]) > std::fabs(c[most])) most = a;
            rows.emplace_back();
            for (const double x : c) rows.back().push_back(real(x) / real(c[most])), sum += rows.back().back();
            rows.back()[most] -= sum;
        }
        std::vector<std::ptrdiff_t> row_of(n, -1);
        for (std::size_t step = 0; step < rows.size(); ++step) {
            std::size_t row = step, column = 0;
            for (std::size_t k = step; k < rows.size(); ++k)
                for (std::size_t a = 0; a < n; ++a)
                    if (absolute(rows[k][a]) > absolute(rows[row][column])) row = k, column = a;
            std::swap(rows[step], rows[row]);
            row_of[column] = static_cast<std::ptrdiff_t>(step);
            const real pivot = rows[step][column];
            for (real &x : rows[step]) x /= pivot;
            for (std::size_t k = 0; k < rows.size(); ++k) {
                const real factor = rows[k][column];
                for (std::size_t a = 0; a < n && k != step; ++a) rows[k][a] -= factor * rows[step][a];
            }
        }
        std::vector<std::vector<real>> of(n);
        for (std::size_t a = 0; a < n; ++a)
            for (std::size_t lead = 0; lead < n; ++lead)
                if (row_of[lead] < 0)
                    of[a].push_back(row_of[a] < 0 ? real(a == lead ? 1 : 0)
                                                  : -rows[static_cast<std::size_t>(row_of[a])][lead]);
        return of;
    }

    void add_vectors(const rigid_problem &p, const std::vector<std::size_t> &atoms, const rigid_frame<real> &frame)
    {
        const std::size_t first = w.size();
        add_sites(atoms, frame, {{{{first + 1, real(1)}}, {{first + 2, real(1)}}}});
        for (std::size_t d = 0; d <= frame.rank; ++d) {
            w.push_back(real(1) / frame.mass);
            of_node.emplace_back();
        }
        for (std::size_t a = 0; a < atoms.size(); ++a) {
            in_body[atoms[a]] = true;
            for (std::size_t d = 0; d <= frame.rank; ++d) {
                const real y = d == 0 ? real(1) : frame.y[a][d - 1];
                of_atom[atoms[a]].push_back({first + d, y});
                if (p.mass[atoms[a]] > 0)
                    of_node[first + d].push_back({atoms[a], real(p.mass[atoms[a]]) * y / frame.mass});
            }
        }
        for (std::size_t d = 0; d < frame.rank; ++d)
            for (std::size_t e = d; e < frame.rank; ++e) {
                const real l = length(frame.vectors[d]), m = length(frame.vectors[e]);
                rows.push_back({{{first + 1 + d, real(1)}},
                                {{first + 1 + e, real(1)}},
                                product(frame.vectors[d], frame.vectors[e]),
                                l * m,
                                l + m,
                                -1});
            }
    }

    void add_bond(const rigid_problem &p, std::size_t k)
    {
        std::map<std::size_t, real> sum;
        for (int e = 0; e < 2; ++e)
            for (const share &s : of_atom[p.pairs[k][static_cast<std::size_t>(e)]])
                sum[s.of] += e == 1 ? s.factor : -s.factor;
        combination d;
        for (const auto &[node, factor] : sum) d.push_back({node, factor});
        const real a(p.length[k]);
        rows.push_back({d, d, a * a, a * a, a, static_cast<std::ptrdiff_t>(k)});
    }
};

}  // namespace rigid_nodes

}  // namespace reference

#endif
