/* Options of a handle; each may be set again before any call. */
#include "check.h"

int main(void)
{
    const double mass[4] = {1, 1, 1, 1}, length = 1;
    const int64_t atoms[2] = {1, 2};
    const unsigned char active[2] = {1, 0};
    int64_t found[2];
    hol_chains *chains = NULL;

    ok(hol_chains_create(4, mass, &chains));
    ok(hol_chains_set_index_base(chains, 1)); /* as Fortran counts */
    ok(hol_chains_add(chains, 1, atoms, &length));
    ok(hol_chains_add_block(chains, 1, 1, 3, &length));
    ok(hol_chains_atoms(chains, 2, found));
    shows("first atom of chain 2", (double)found[0], 3);

    ok(hol_chains_set_threads(chains, 2));
    ok(hol_chains_set_tolerance(chains, 1e-10)); /* of hol_project_positions; 0: the rounding of the coordinates */
    ok(hol_chains_set_max_iterations(chains, 20));
    ok(hol_chains_set_memory_limit(chains, 1 << 30)); /* what cycles may fill; 0: a quarter of the machine's */
    ok(hol_chains_set_active(chains, active));        /* the second chain is left out of every call */
    shows("degrees of freedom", (double)hol_chains_degrees_of_freedom(chains, 3), 3 * 4 - 1);
    ok(hol_chains_set_active(chains, NULL));
    hol_chains_destroy(chains);
    return 0;
}
