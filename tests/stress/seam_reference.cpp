#include "seam_reference.hpp"

#include <cmath>
#include <optional>

#include "random.h"

namespace stress
{

namespace
{

using molecule = reference::exact_molecule<quad>;
using factor = reference::sparse_factor<quad>;
using vec = molecule::vec;
using reference::absolute;
using reference::add_times;
using reference::difference;
using reference::product;
using reference::product_of_sizes;

quad largest(const vec &x)
{
    quad most = 0;
    for (const quad c : x) most = absolute(c) > most ? absolute(c) : most;
    return most;
}

quads size_of_errors(const factor &a, const quads &s)
{
    constexpr int draws = 10;
    random_stream stream = random_seed(9);
    quads sum(s.size(), 0);
    for (int n = 0; n < draws; ++n) {
        quads signs = s;
        for (quad &x : signs)
            if (random_bits(&stream) >> 63) x = -x;
        const quads e = a.solve(signs);
        for (std::size_t k = 0; k < s.size(); ++k) sum[k] += e[k] * e[k] / draws;
    }
    for (quad &x : sum) x = reference::square_root(x);
    return sum;
}

/** From t = factor 2 lambda. */
seam_solution solution_of(const molecule &m, std::size_t n_bonds, const quads &t, const quads &scale, quad multiple)
{
    seam_solution out;
    out.lambda.assign(n_bonds, 0), out.lambda_scale.assign(n_bonds, 0), out.g_scale.assign(m.w.size(), 0);
    for (std::size_t k = 0; k < m.bonds.size(); ++k) {
        const auto &b = m.bonds[k];
        out.lambda[b.number] = t[k] / (2 * multiple);
        out.lambda_scale[b.number] = scale[k] / (2 * multiple);
        const quad pull = scale[k] / multiple * largest(b.d);
        out.g_scale[b.i] += pull, out.g_scale[b.j] += pull;
    }
    for (const vec &g : m.forces(t))
        for (const quad x : g) out.g.push_back(x / multiple);
    return out;
}

/** x + multiple w G. */
void move(const molecule &m, const std::vector<double> &from, quad multiple, seam_solution &s)
{
    for (std::size_t i = 0; i < m.w.size(); ++i) {
        vec x = molecule::row(from.data(), i);
        for (std::size_t c = 0; c < 3; ++c) x[c] += multiple * m.w[i] * s.g[3 * i + c];
        s.moved.insert(s.moved.end(), x.begin(), x.end());
        s.moved_scale.push_back(largest(x) + largest(molecule::row(from.data(), i)) + multiple * m.w[i] * s.g_scale[i]);
    }
}

/** Adds what the products of the matrix with the multipliers are rounded by. */
void add_products(const molecule &m, const std::vector<vec> &left, const quads &t, quads &s)
{
    for (std::size_t i = 0; i < m.w.size(); ++i)
        for (const auto &k : m.ends[i])
            for (const auto &l : m.ends[i])
                s[k.bond] += m.w[i] * product_of_sizes(left[k.bond], m.bonds[l.bond].d) * absolute(t[l.bond]);
}

/** The drifted bonds, moved by these multipliers. */
std::vector<vec> bonds_after(const molecule &m, const std::vector<double> &drifted, const quads &t)
{
    const std::vector<vec> g = m.forces(t);
    std::vector<vec> d;
    for (const auto &b : m.bonds) {
        d.push_back(difference(molecule::row(drifted.data(), b.j), molecule::row(drifted.data(), b.i)));
        add_times(d.back(), m.w[b.j], g[b.j]);
        add_times(d.back(), quad(-m.w[b.i]), g[b.i]);
    }
    return d;
}

seam_solution forces_of(const seam_molecule &x, const molecule &m, const factor &a)
{
    const molecule_problem p = x.problem();
    quads b, s;
    for (const auto &k : m.bonds) {
        const vec fi = molecule::row(p.f, k.i), fj = molecule::row(p.f, k.j);
        const vec dv = difference(molecule::row(p.v, k.j), molecule::row(p.v, k.i));
        b.push_back(m.w[k.j] * product(k.d, fj) - m.w[k.i] * product(k.d, fi) + product(dv, dv));
        s.push_back(m.w[k.j] * product_of_sizes(k.d, fj) + m.w[k.i] * product_of_sizes(k.d, fi) + product(dv, dv));
    }
    const quads t = a.solve(b);
    add_products(m, m.vectors(), t, s);
    return solution_of(m, x.length.size(), t, size_of_errors(a, s), 1);
}

seam_solution velocities_of(const seam_molecule &x, const molecule &m, const factor &a)
{
    const molecule_problem p = x.problem();
    quads b, s;
    for (const auto &k : m.bonds) {
        const vec vi = molecule::row(p.v, k.i), vj = molecule::row(p.v, k.j);
        b.push_back(product(k.d, difference(vj, vi)));
        s.push_back(product_of_sizes(k.d, vi) + product_of_sizes(k.d, vj));
    }
    const quads t = a.solve(b);
    add_products(m, m.vectors(), t, s);
    seam_solution out = solution_of(m, x.length.size(), t, size_of_errors(a, s), 1);
    move(m, x.v, 1, out);
    return out;
}

}  // namespace

linear_solutions exact_linear(const seam_molecule &x)
{
    const molecule m(x.problem());
    const factor a(m.matrix(m.vectors()));
    return {forces_of(x, m, a), velocities_of(x, m, a)};
}

seam_solution exact_positions(const seam_molecule &x)
{
    const molecule m(x.problem());
    const quad multiple = quad(x.dt) * quad(x.dt);
    quads t(m.bonds.size(), 0), error(t), s;
    std::optional<factor> a;
    quad before = 0;
    for (int turn = 0; turn < 20; ++turn) {
        const std::vector<vec> d = bonds_after(m, x.drifted, t);
        quad worst = 0;
        for (std::size_t k = 0; k < t.size(); ++k) {
            const quad square = quad(x.length[m.bonds[k].number]) * x.length[m.bonds[k].number];
            error[k] = (product(d[k], d[k]) - square) / 2;
            worst = absolute(error[k]) > worst * square ? absolute(error[k]) / square : worst;
        }
        if (worst > 1e-6 * before || worst < 1e-25) a.emplace(m.matrix(d));  // else those before will do
        before = worst;
        if (worst < 1e-25) {
            for (std::size_t k = 0; k < t.size(); ++k) {
                const vec &from = m.r[m.bonds[k].i], &to = m.r[m.bonds[k].j];
                const quad extent = largest(from) + largest(to), length = x.length[m.bonds[k].number];
                s.push_back(length * (length + extent));
            }
            add_products(m, d, t, s);
            seam_solution out = solution_of(m, x.length.size(), t, size_of_errors(*a, s), multiple);
            move(m, x.drifted, multiple, out);
            return out;
        }
        const quads change = a->solve(error);
        for (std::size_t k = 0; k < t.size(); ++k) t[k] += change[k];
    }
    return {};
}

}  // namespace stress
