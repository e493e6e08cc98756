#include <holonomic.h>
#include <stdio.h>

int main(void) /* three beads hang from a fixed atom (mass 0): what holds them? */
{
    const double mass[4] = {0, 1, 1, 1}; /* one per atom */
    const double length[3] = {1, 1, 1};  /* one per bond */
    const double r[4][3] = {{0, 0, 0}, {0, 0, -1}, {0, 0, -2}, {0, 0, -3}};
    const double f[4][3] = {{0, 0, 0}, {0, 0, -10}, {0, 0, -10}, {0, 0, -10}};
    double tension[3];
    hol_chains *chains = NULL;
    if (hol_chains_create(4, mass, &chains) || hol_chains_add_block(chains, 1, 3, 0, length) ||
        hol_forces(chains, r[0], NULL, f[0], NULL, tension, NULL, HOL_WRITE, NULL)) {
        fprintf(stderr, "%s\n", hol_error_message());
        return 1;
    }
    printf("tensions: %g %g %g\n", tension[0], tension[1], tension[2]); /* 30 20 10 */
    hol_chains_destroy(chains);
    return 0;
}
