/* Distances as topologies have them: CO2 with three decimals, all bonds and angles of ethane; two pairs with one
 * centre, and two pairs with a site in the middle. */
#include <math.h>
#include "check.h"

/* Of two atoms. */
static double distance(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

int main(void)
{
    const double mass[21] = {12, 12, 1, 1, 1, 1, 1, 1, 16, 12, 16, 1, 2, 3, 4, 1, 1, 0, 1, 1, 0},
                 middle[3] = {0.5, 0.5, -1};
    const int64_t three = 3, site[3] = {0, 1, 2};
    const int64_t co2[6] = {8, 9, 9, 10, 8, 10}, four = 4, pairs[4] = {11, 12, 13, 14};
    const double rounded[3] = {1.162, 1.162, 2.325}, one_centre[4] = {1, 1, -1, -1};
    double r[8][3] = {{0, 0, 0}, {1.54, 0, 0}}, length[19], largest;
    int64_t ethane[38], bond, n = 0, n_implied = 0;
    unsigned char implied[22];
    hol_chains *chains = NULL;

    ok(hol_chains_create(21, mass, &chains));

    for (int h = 0; h < 6; ++h) {
        const double turn = 1.0471975511965976 * (2 * h + h / 3);
        r[2 + h][0] = h < 3 ? -0.363 : 1.903;
        r[2 + h][1] = 1.027 * cos(turn);
        r[2 + h][2] = 1.027 * sin(turn);
    }
    for (int i = 0; i < 8; ++i)
        for (int j = i + 1; j < 8; ++j) {
            if (i >= 2 && i / 5 != j / 5) continue; /* hydrogens of different carbons */
            length[n] = distance(r[i], r[j]);
            ethane[2 * n] = i, ethane[2 * n++ + 1] = j;
        }
    ok(hol_chains_add_bonds(chains, n, ethane, length));
    shows("degrees of freedom", (double)hol_chains_degrees_of_freedom(chains, 3), 57 - 17);

    ok(hol_chains_set_length_tolerance(chains, 1e-3));
    ok(hol_chains_add_bonds(chains, 3, co2, rounded)); /* straight, but for the decimals */
    ok(hol_chains_adjustment(chains, &largest, &bond));
    shows("adjusted by less than", ceil(1e3 * largest), 1);
    shows("beside ethane", (double)(bond >= n), 1);
    ok(hol_chains_implied(chains, implied));
    for (int k = 0; k < n; ++k) n_implied += implied[k];
    shows("implied by others", (double)n_implied, (double)(n - 17));

    ok(hol_chains_add_linear(chains, 1, &four, pairs, one_centre, 0, NULL, NULL));
    shows("degrees of freedom", (double)hol_chains_degrees_of_freedom(chains, 3), 57 - 17 - 4 - 3);

    ok(hol_chains_add_linear_molecules(chains, 2, 3, 15, 1, &three, site, middle, 0, NULL, NULL));
    shows("sites have none of their own", (double)hol_chains_degrees_of_freedom(chains, 3), 57 - 17 - 4 - 3);
    hol_chains_destroy(chains);
    return 0;
}
