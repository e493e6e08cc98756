/* What a call that fails says, in words and in numbers; and which library runs. */
#include <string.h>

#include "check.h"

int main(void)
{
    const double mass[3] = {1, 1, 1}, length[2] = {1, -1};
    int64_t molecule, bond, atom, n_bad;
    hol_chains *chains = NULL;

    printf("holonomic %s, instruction set %s\n", hol_version(), hol_instruction_set());
    ok(hol_chains_create(3, mass, &chains));
    const int status = hol_chains_add_block(chains, 1, 2, 0, length);
    printf("%s: %s\n", hol_status_name(status), hol_error_message());
    hol_error_location(&molecule, &bond, &atom, &n_bad);
    shows("bond", (double)bond, 1);
    shows("atom (does not apply)", (double)atom, -1);
    shows("molecules", (double)hol_chains_n_molecules(chains), 0); /* nothing was added */

    /* With the numbers by which the program knows its atoms. */
    const int64_t labels[3] = {90208, 90209, 90210};
    const double r[9] = {0, 0, 0, 1, 0, 0, 1, 1, NAN}, one[2] = {1, 1};
    ok(hol_chains_add_block(chains, 1, 2, 0, one));
    ok(hol_chains_set_labels(chains, labels, NULL));
    shows("not finite", hol_forces(chains, r, NULL, NULL, NULL, NULL, NULL, HOL_WRITE, NULL), HOL_ERR_NOT_FINITE);
    printf("%s\n", hol_error_message());
    if (!strstr(hol_error_message(), "atom 2 (label 90210)")) return 1;

    /* What became of each molecule, if that is to be kept. */
    int outcome[1], iterations[1];
    ok(hol_chains_set_outcomes(chains, 1));
    hol_forces(chains, r, NULL, NULL, NULL, NULL, NULL, HOL_WRITE, NULL);
    ok(hol_outcomes(chains, outcome, iterations));
    shows("the molecule", outcome[0], HOL_ERR_NOT_FINITE);
    hol_chains_destroy(chains);
    return strcmp(hol_status_name(status), "HOL_ERR_VALUE") != 0;
}
