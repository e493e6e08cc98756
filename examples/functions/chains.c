/* Linear chains: which atoms are bonded, and what the handle then knows. */
#include "check.h"

int main(void)
{
    const double mass[10] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, length[3] = {1.5, 1.5, 1.5};
    const int64_t atoms[4] = {9, 7, 8, 6};
    int64_t offsets[4], along[4];
    hol_chains *chains = NULL;

    ok(hol_chains_create(10, mass, &chains));
    ok(hol_chains_add_block(chains, 2, 2, 0, length)); /* atoms 0-1-2 and 3-4-5 */
    ok(hol_chains_add(chains, 3, atoms, length));      /* 9-7-8-6 */

    shows("atoms", (double)hol_chains_n_atoms(chains), 10);
    shows("molecules", (double)hol_chains_n_molecules(chains), 3);
    shows("bonds", (double)hol_chains_n_bonds(chains), 7);
    ok(hol_chains_offsets(chains, offsets)); /* the bonds of chain 2 are 4, 5 and 6 in arrays per bond */
    shows("first bond of chain 2", (double)offsets[2], 4);
    ok(hol_chains_atoms(chains, 2, along));
    shows("first atom of chain 2", (double)along[0], 9);
    shows("degrees of freedom", (double)hol_chains_degrees_of_freedom(chains, 3), 3 * 10 - 7);
    printf("%lld bytes\n", (long long)hol_chains_memory(chains));
    hol_chains_destroy(chains);
    return 0;
}
