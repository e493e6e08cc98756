/* Positions onto the constraints after a drift: SHAKE, the first half of RATTLE. */
#include "check.h"

int main(void)
{
    const double mass[2] = {1, 1}, length = 1, dt = 0.1;
    double r_ref[2][3] = {{0, 0, 0}, {1, 0, 0}}, v[2][3] = {{0, -1, 0}, {0, 1, 0}}, r[2][3], lambda, virial[3][3];
    const hol_const_view before = hol_const_view_rows(r_ref[0]);
    const hol_view after = hol_view_rows(r[0]);
    hol_report report;
    hol_chains *chains = NULL;

    ok(hol_chains_create(2, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 1, 0, &length));
    for (int i = 0; i < 2; ++i)
        for (int c = 0; c < 3; ++c) r[i][c] = r_ref[i][c] + dt * v[i][c];
    ok(hol_project_positions(chains, r_ref[0], r[0], v[0], dt, &lambda, 0, virial[0], &report));
    shows("length", hypot(r[1][0] - r[0][0], r[1][1] - r[0][1]), 1);
    shows("x, half of it", r[1][0] - 0.5, 0.5 * sqrt(1 - 0.04));
    shows("error left", report.max_error, 0);
    printf("%lld solves\n", (long long)report.iterations);

    ok(hol_project_positions_view(chains, &before, &after, NULL, dt, &lambda, 0, NULL, &report));
    shows("moved again", (double)report.n_corrected, 0); /* it is there already */
    hol_chains_destroy(chains);
    return 0;
}
