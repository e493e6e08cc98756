/* Other lengths and masses for molecules that are there: a step of a free-energy calculation, say. */
#include "check.h"

int main(void)
{
    const double mass[2] = {1, 1}, heavy[2] = {1, 3}, length = 1, longer = 1.2;
    const double r_ref[2][3] = {{0, 0, 0}, {1, 0, 0}};
    double r[2][3] = {{0, 0, 0}, {1, 0, 0}};
    hol_chains *chains = NULL;

    ok(hol_chains_create(2, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 1, 0, &length));
    ok(hol_project_positions(chains, r_ref[0], r[0], NULL, 1.0, NULL, 0, NULL, NULL)); /* a step with the first ones */
    ok(hol_chains_set_lengths(chains, &longer));
    ok(hol_chains_set_masses(chains, heavy));
    ok(hol_project_positions(chains, r_ref[0], r[0], NULL, 1.0, NULL, 0, NULL, NULL));
    shows("x of the light atom", r[0][0], -0.15);
    shows("x of the heavy atom", r[1][0], 1.05);
    hol_chains_destroy(chains);
    return 0;
}
