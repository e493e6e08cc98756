/* Two rigid CO2 (116 pm, straight) in one call, a rod that hangs at a fixed atom by a bond, and the mass points of a
 * body that is given by its inertia tensor. */
#include "check.h"

int main(void)
{
    const double mass[9] = {16, 12, 16, 16, 12, 16, 1, 1, INFINITY}, length = 1;
    const double co2[3][3] = {{-1.16, 0, 0}, {0, 0, 0}, {1.16, 0, 0}}, rod[2][3] = {{0, 0, 0}, {1, 0, 0}};
    const int64_t three = 3, two = 2, within[3] = {0, 1, 2}, of_rod[2] = {6, 7}, bond[2] = {8, 6};
    const double r[9][3] = {{-1.16, 0, 0}, {0, 0, 0}, {1.16, 0, 0}, {5, -1.16, 0}, {5, 0, 0},
                            {5, 1.16, 0},  {1, 9, 0}, {2, 9, 0},    {0, 9, 0}};
    const double f[9][3] = {{0, 0, 3}, {0}, {0}, {0}, {0}, {0}, {0}, {5, 0, 0}, {0}};
    double tension, g[9][3];
    hol_chains *chains = NULL;

    ok(hol_chains_create(9, mass, &chains));
    ok(hol_chains_add_rigid_molecules(chains, 2, 3, 0, 1, &three, within, co2[0], 0, NULL, NULL));
    ok(hol_chains_add_rigid(chains, 1, &two, of_rod, rod[0], 1, bond, &length));
    shows("with bodies", (double)hol_chains_n_of_shape(chains, HOL_SHAPE_RIGID), 3);
    shows("degrees of freedom", (double)hol_chains_degrees_of_freedom(chains, 3), 5 + 5 + 5 - 1);
    ok(hol_forces(chains, r[0], NULL, f[0], NULL, &tension, g[0], HOL_WRITE, NULL));
    shows("force on the carbon", g[1][2], 12 * 3.0 / 44); /* its mass times what the centre is accelerated by */
    shows("tension", tension, 5);
    hol_chains_destroy(chains);

    const double inertia[9] = {2, 0, 0, 0, 3, 0, 0, 0, 4}; /* moments; products with the minus sign beside them */
    double masses[4], places[4][3], moment = 0;
    int64_t n_points;
    ok(hol_equimomental_points(8, NULL, inertia, &n_points, masses, places[0]));
    shows("mass points", (double)n_points, 4);
    for (int a = 0; a < 4; ++a) moment += masses[a] * (places[a][0] * places[a][0] + places[a][1] * places[a][1]);
    shows("moment of inertia about z", moment, 4);
    return 0;
}
