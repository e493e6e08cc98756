/* Two atoms of mass 1 turn about each other at distance 2 with relative speed 2: the tension is m/2 2^2 / 2 = 1. */
#include <holonomic.h>
#include <stdio.h>

int main(void)
{
    const double masses[2] = {1, 1}, length = 2;
    const double r[6] = {-1, 0, 0, 1, 0, 0}, v[6] = {0, -1, 0, 0, 1, 0};
    const int64_t atoms[2] = {0, 1};
    double tension = -1, g[6] = {0};
    hol_chains *chains;
    if (hol_chains_create(2, masses, &chains) != HOL_OK || hol_chains_add(chains, 1, atoms, &length) != HOL_OK ||
        hol_forces(chains, r, v, NULL, NULL, &tension, g, HOL_WRITE, NULL) != HOL_OK) {
        printf("%s\n", hol_error_message());
        return 1;
    }
    printf("holonomic %s\n", hol_version());
    printf("tension %.3f forces %.3f %.3f\n", tension, g[0], g[3]);
    printf("again: %s\n", hol_status_name(hol_chains_add(chains, 1, atoms, &length)));
    hol_chains_destroy(chains);
    return 0;
}
