#include "bond_matrix.hpp"

#include <cmath>

namespace reference
{

quad3 row(const double *array, std::size_t i)
{
    if (!array) return {quad(0), quad(0), quad(0)};
    return {quad(array[3 * i]), quad(array[3 * i + 1]), quad(array[3 * i + 2])};
}

namespace
{

/** The shortest of d + n0 h0 + n1 h1 + n2 h2, by repeated search among the neighbouring cells. */
quad3 shortest_image(quad3 d, const double *box)
{
    for (bool moved = true; moved;) {
        moved = false;
        quad3 best = d;
        for (int n0 = -1; n0 <= 1; ++n0)
            for (int n1 = -1; n1 <= 1; ++n1)
                for (int n2 = -1; n2 <= 1; ++n2) {
                    const quad3 image = d + quad(n0) * row(box, 0) + quad(n1) * row(box, 1) + quad(n2) * row(box, 2);
                    if (dot(image, image) < dot(best, best)) {
                        best = image;
                        moved = true;
                    }
                }
        d = best;
    }
    return d;
}

}  // namespace

exact_chain::exact_chain(const solution_problem &p)
{
    const std::size_t n = static_cast<std::size_t>(p.n_bonds);
    for (std::size_t i = 0; i <= n; ++i) {
        if (p.inverse_mass)
            w.push_back(p.inverse_mass[i]);
        else
            w.push_back(p.mass[i] > 0 && std::isfinite(p.mass[i]) ? 1 / quad(p.mass[i]) : quad(0));
    }
    for (std::size_t k = 0; k < n; ++k) {
        quad3 bond = row(p.r, k + 1) - row(p.r, k);
        d.push_back(p.box ? shortest_image(bond, p.box) : bond);
    }
}

tridiagonal bond_matrix(const exact_chain &c)
{
    const std::size_t n = c.n_bonds();
    tridiagonal z(n);
    for (std::size_t k = 0; k < n; ++k) {
        z.diagonal[k] = 4 * (c.w[k] + c.w[k + 1]) * dot(c.d[k], c.d[k]);
        if (k + 1 < n) z.upper[k] = z.lower[k + 1] = -4 * c.w[k + 1] * dot(c.d[k], c.d[k + 1]);
    }
    return z;
}

tridiagonal scaled_bond_matrix(const exact_chain &c)
{
    tridiagonal z = bond_matrix(c);
    std::vector<quad> scale;
    for (quad x : z.diagonal) scale.push_back(1 / square_root(x));
    for (std::size_t k = 0; k < z.size(); ++k) {
        z.diagonal[k] = 1;
        if (k + 1 < z.size()) z.upper[k] = z.lower[k + 1] = z.upper[k] * scale[k] * scale[k + 1];
    }
    return z;
}

}  // namespace reference
