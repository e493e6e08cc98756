/* What multipliers do, once they are found: impulses of the atoms, virials of the bonds. */
#include <string.h>

#include "check.h"

int main(void)
{
    const double mass[3] = {0, 1, 2}, length[2] = {1, 1}, dt = 0.01; /* the first atom is held fixed */
    const double r[3][3] = {{0, 0, 0}, {1, 0, 0}, {1.6, 0.8, 0}}, before[3][3] = {{0, 0, 0}, {0.5, 1, 0}, {-1, 0.3, 2}};
    const hol_const_view view = hol_const_view_rows(r[0]);
    double v[3][3], moved[3][3], lambda[2], tension[2], impulse[3][3], of_bond[2][6], virial[9], again[9];
    hol_chains *chains = NULL;

    ok(hol_chains_create(3, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 2, 0, length));

    /* The velocity level: g is the impulse m dv, of the fixed atom that of what holds it. */
    memcpy(v, before, sizeof v);
    ok(hol_project_velocities(chains, r[0], v[0], lambda, virial));
    ok(hol_reactions(chains, r[0], HOL_BOX, lambda, tension, impulse[0], HOL_WRITE, of_bond[0], again));
    shows("impulse of atom 1", impulse[1][0], mass[1] * (v[1][0] - before[1][0]));
    shows("impulse of atom 2", impulse[2][1], mass[2] * (v[2][1] - before[2][1]));
    shows("and of the wall", impulse[0][0], -impulse[1][0] - impulse[2][0]);
    shows("tension of bond 1", tension[1], 2 * lambda[1]);
    shows("virial xy of bond 1", of_bond[1][1], -2 * lambda[1] * 0.6 * 0.8); /* xx xy xz yy yz zz */
    shows("of both bonds", of_bond[0][0] + of_bond[1][0], virial[0]);
    shows("the same", again[0], virial[0]);

    /* The position level: with the positions before the drift, g times dt^2 w is the displacement. */
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c) moved[i][c] = r[i][c] + dt * before[i][c];
    ok(hol_project_positions(chains, r[0], moved[0], NULL, dt, lambda, 0, NULL, NULL));
    ok(hol_reactions_view(chains, &view, HOL_REFERENCE_BOX, lambda, NULL, NULL, HOL_WRITE, of_bond[0], NULL));
    ok(hol_reactions(chains, r[0], HOL_REFERENCE_BOX, lambda, NULL, impulse[0], HOL_WRITE, NULL, NULL));
    shows("x of atom 2", moved[2][0], r[2][0] + dt * before[2][0] + dt * dt * impulse[2][0] / mass[2]);
    hol_chains_destroy(chains);
    return 0;
}
