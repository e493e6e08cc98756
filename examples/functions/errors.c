/* What a call that fails says, in words and in numbers; and which library runs. */
#include <string.h>

#include "check.h"

int main(void)
{
    const double mass[3] = {1, 1, 1}, length[2] = {1, -1};
    int64_t chain, bond, atom, n_bad;
    hol_chains *chains = NULL;

    printf("holonomic %s, instruction set %s\n", hol_version(), hol_instruction_set());
    ok(hol_chains_create(3, mass, &chains));
    const int status = hol_chains_add_block(chains, 1, 2, 0, length);
    printf("%s: %s\n", hol_status_name(status), hol_error_message());
    hol_error_location(&chain, &bond, &atom, &n_bad);
    shows("bond", (double)bond, 1);
    shows("atom (does not apply)", (double)atom, -1);
    shows("molecules", (double)hol_chains_n_chains(chains), 0); /* nothing was added */
    hol_chains_destroy(chains);
    return strcmp(hol_status_name(status), "HOL_ERR_VALUE") != 0;
}
