#include <vector>

#include "bond_matrix.hpp"
#include "solution.h"

namespace reference
{
namespace
{

quad determinant(const tridiagonal &m)
{
    quad product = 1, pivot = 0;
    for (std::size_t k = 0; k < m.size(); ++k) {
        pivot = k == 0 ? m.diagonal[0] : m.diagonal[k] - m.lower[k] * m.upper[k - 1] / pivot;
        product *= pivot;
    }
    return product;
}

/** ln(1 + x) for |x| below 1e-3: the first ten terms leave less than 1e-33. */
quad log_near_one(quad x)
{
    quad sum = 0;
    for (int k = 10; k > 0; --k) sum = (k % 2 ? quad(1) : quad(-1)) / k + x * sum;
    return x * sum;
}

/** ln det Z~ with the atom moved by +step minus that with it moved by -step. */
quad difference(const exact_chain &c, std::size_t atom, std::size_t axis, quad step)
{
    quad det[2];
    for (int side = 0; side < 2; ++side) {
        exact_chain moved = c;
        const quad by = side == 0 ? step : -step;
        if (atom > 0) moved.d[atom - 1][axis] += by;
        if (atom < c.n_bonds()) moved.d[atom][axis] -= by;
        det[side] = determinant(scaled_bond_matrix(moved));
    }
    return log_near_one(det[0] / det[1] - 1);
}

}  // namespace
}  // namespace reference

extern "C" int solution_fixman_differences(const solution_problem *p, long double *force)
{
    using namespace reference;
    const exact_chain c(*p);
    for (std::size_t atom = 0; atom <= c.n_bonds(); ++atom) {
        quad shortest = atom < c.n_bonds() ? norm(c.d[atom]) : norm(c.d[atom - 1]);
        if (atom > 0 && norm(c.d[atom - 1]) < shortest) shortest = norm(c.d[atom - 1]);
        const quad h = shortest * quad(1e-8);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const quad slope = (8 * difference(c, atom, axis, h) - difference(c, atom, axis, 2 * h)) / (12 * h);
            force[3 * atom + axis] = static_cast<long double>(-slope / 2);
        }
    }
    return 0;
}
