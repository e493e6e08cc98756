/* Where a program begins: what is mistaken there is an error at the first call, and crude positions need a word. */
#include "check.h"

int main(void)
{
    /* A rigid water, whose second hydrogen was put back into a cell of 20 by itself. */
    const double mass[3] = {16, 1, 1}, length[3] = {1, 1, 1.633};
    const int64_t bonds[6] = {0, 1, 0, 2, 1, 2};
    const double box[9] = {20, 0, 0, 0, 20, 0, 0, 0, 20};
    double r[9] = {19.7, 5, 5, 19.1226, 5.8165, 5, 19.1226 - 20, 4.1835, 5};
    hol_chains *chains;
    ok(hol_chains_create(3, mass, &chains));
    ok(hol_chains_add_molecules(chains, 1, 3, 0, 3, bonds, length));

    /* No box: the bond is 20 long. Nothing is moved. */
    shows("status", hol_project_positions(chains, r, r, NULL, 1, NULL, 0, NULL, NULL), HOL_ERR_LENGTHS);
    printf("%s\n", hol_error_message());
    shows("x of the hydrogen", r[6], 19.1226 - 20);
    ok(hol_chains_set_box(chains, box));
    ok(hol_chains_check(chains, r, HOL_BOX)); /* on request; project_positions does it by itself in its first call */
    ok(hol_project_positions(chains, r, r, NULL, 1, NULL, 0, NULL, NULL));

    /* A crude model, built by hand: by a call of its own, or, if it is nearly right, projected with checks off. */
    const double model[9] = {10, 5, 5, 10.8, 5.5, 5, 9.2, 5.5, 5};
    for (int i = 0; i < 9; ++i) r[i] = model[i];
    const hol_const_view view = hol_const_view_rows(r);
    shows("status", hol_chains_check_view(chains, &view, HOL_BOX), HOL_OK); /* 0.94 and 1.6: near enough */
    r[3] = 10.6;
    shows("status", hol_chains_check_view(chains, &view, HOL_BOX), HOL_ERR_LENGTHS); /* 0.78 is not */
    ok(hol_chains_set_checks(chains, HOL_NEVER));
    hol_report report;
    ok(hol_project_positions(chains, r, r, NULL, 1, NULL, 0, NULL, &report));
    ok(hol_chains_set_checks(chains, HOL_AT_START));
    ok(hol_chains_check(chains, r, HOL_BOX));

    /* What the reference of that call was like, and what it has left. */
    double error;
    int64_t molecule, bond;
    ok(hol_reference_error(chains, &error, &molecule, &bond));
    printf("the reference was off by %.2g in bond %lld; what is left is %.2g\n", error, (long long)bond,
           report.max_error);
    shows("bond", (double)bond, 0);
    const double crude[9] = {10, 5, 5, 14, 5.5, 5, 10.3, 4.8, 5.1};
    for (int i = 0; i < 9; ++i) r[i] = crude[i];
    ok(hol_impose(chains, r, &report));
    const hol_view movable = hol_view_rows(r);
    ok(hol_impose_view(chains, &movable, NULL)); /* right already */
    hol_worst worst;
    ok(hol_violation(chains, r, NULL, &worst));
    shows("lengths after hol_impose", worst.length < 1e-14, 1);
    hol_chains_destroy(chains);
    return 0;
}
