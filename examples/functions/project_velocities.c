/* Velocities onto the constraints: the second half of RATTLE. */
#include "check.h"

int main(void)
{
    const double mass[2] = {1, 3}, length = 1;
    double r[2][3] = {{0, 0, 0}, {1, 0, 0}}, v[2][3] = {{0, 1, 0}, {4, 0, 0}}, lambda, virial[3][3];
    const hol_const_view at = hol_const_view_rows(r[0]);
    const hol_view moving = hol_view_rows(v[0]);
    hol_chains *chains = NULL;

    ok(hol_chains_create(2, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 1, 0, &length));
    ok(hol_project_velocities(chains, r[0], v[0], &lambda, virial[0]));
    shows("vx of both", v[0][0], 3); /* the momentum is kept */
    shows("relative vx", v[1][0] - v[0][0], 0);
    shows("vy is left alone", v[0][1], 1);
    v[1][0] = 7;
    ok(hol_project_velocities_view(chains, &at, &moving, NULL, NULL));
    shows("by views", v[0][0], 6);
    hol_chains_destroy(chains);
    return 0;
}
