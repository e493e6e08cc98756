/* Multipliers of a right-hand side of one's own: what pushes a stretched bond back with sigma'' = -k sigma? */
#include "check.h"

int main(void)
{
    const double mass[2] = {1, 1}, length = 1, k = 100;
    double r[2][3] = {{0, 0, 0}, {1.1, 0, 0}}, lambda, g[2][3], again;
    const hol_const_view view = hol_const_view_rows(r[0]);
    const double sigma = 1.1 * 1.1 - 1, rhs = k * sigma;
    hol_chains *chains = NULL;

    ok(hol_chains_create(2, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 1, 0, &length));
    ok(hol_solve(chains, r[0], &rhs, &lambda, g[0], HOL_WRITE, NULL));
    shows("lambda", lambda, rhs / (4 * 2 * 1.1 * 1.1)); /* Z = 4 (w_0 + w_1) d.d */
    shows("sigma''", 2 * 1.1 * (g[1][0] - g[0][0]), -k * sigma);
    ok(hol_solve_view(chains, &view, &rhs, &again, NULL, HOL_WRITE, NULL));
    shows("by a view", again, lambda);
    hol_chains_destroy(chains);
    return 0;
}
