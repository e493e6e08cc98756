/* Constraint forces, tensions and virial of a pendulum of two beads that turns at unit rate. */
#include "check.h"

int main(void)
{
    const double mass[3] = {0, 1, 1}, length[2] = {1, 1}; /* the first atom is held fixed */
    const double r[3][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, v[3][3] = {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}};
    double lambda[2], tension[2], g[3][3], virial[3][3];
    hol_chains *chains = NULL;

    ok(hol_chains_create(3, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 2, 0, length));
    ok(hol_forces(chains, r[0], v[0], NULL, lambda, tension, g[0], HOL_WRITE, virial[0])); /* no applied forces */
    shows("inner tension", tension[0], 3);
    shows("outer tension", tension[1], 2);
    shows("lambda of the outer", lambda[1], 1);
    shows("force on the middle", g[1][0], -1);
    shows("virial xx", virial[0][0], -5);
    hol_chains_destroy(chains);
    return 0;
}
