/* Elements of Z^-1, its condition, and how far given multipliers are from the exact ones. */
#include "check.h"

int main(void)
{
    const double mass[3] = {1, 1, 1}, length[2] = {1, 1};
    double r[3][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, f[3][3] = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}};
    const hol_const_view at = hol_const_view_rows(r[0]), pulled = hol_const_view_rows(f[0]);
    double value, row[2], band[2][2], matrix[2][2], condition, lambda[2], bound[2], relative;
    hol_chains *chains = NULL;
    hol_inverse *inverse = NULL, *same = NULL;

    ok(hol_chains_create(3, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 2, 0, length));
    ok(hol_inverse_create(chains, 0, r[0], &inverse)); /* Z~ = (1 -1/2; -1/2 1) */
    shows("rows", (double)hol_inverse_n_bonds(inverse), 2);
    ok(hol_inverse_entry(inverse, HOL_UNIT_DIAGONAL, 0, 1, &value));
    shows("(Z~^-1)_01", value, 2.0 / 3);
    ok(hol_inverse_row(inverse, HOL_PHYSICAL, 0, row));
    shows("(Z^-1)_00", row[0], 1.0 / 6);
    ok(hol_inverse_band(inverse, HOL_UNIT_DIAGONAL, 1, band[0]));
    shows("beside the diagonal", band[0][1], 2.0 / 3);
    ok(hol_inverse_matrix(inverse, HOL_UNIT_DIAGONAL, matrix[0]));
    shows("(Z~^-1)_11", matrix[1][1], 4.0 / 3);
    ok(hol_inverse_condition(inverse, &condition));
    shows("condition", condition, 3);

    ok(hol_forces(chains, r[0], NULL, f[0], lambda, NULL, NULL, HOL_WRITE, NULL));
    ok(hol_inverse_error_bound(inverse, NULL, f[0], lambda, bound, &relative));
    printf("multipliers are right to %.1g of the largest\n", relative);
    ok(hol_inverse_create_view(chains, 0, &at, &same));
    ok(hol_inverse_error_bound_view(same, NULL, &pulled, lambda, bound, &value));
    shows("by views", value, relative);
    hol_inverse_destroy(same);
    hol_inverse_destroy(inverse);
    hol_chains_destroy(chains);
    return relative > 1e-14;
}
