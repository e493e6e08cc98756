/* Metric determinant and Fixman potential of a rigid trimer with a right angle and of a straight one. */
#include "check.h"

int main(void)
{
    const double mass[3] = {1, 1, 1}, length[2] = {1, 1}, kT = 2;
    double bent[3][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, straight[3][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    const hol_const_view view = hol_const_view_rows(straight[0]);
    double log_det, log_det_z, energy, force[3][3];
    hol_chains *chains = NULL;

    ok(hol_chains_create(3, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 2, 0, length));
    ok(hol_metric(chains, bent[0], kT, &log_det, &log_det_z, &energy, force[0], HOL_WRITE));
    shows("bent: ln det Z~", log_det, 0); /* 1 - cos^2 / 4 */
    shows("bent: ln det Z", log_det_z, log(64));
    ok(hol_metric_view(chains, &view, kT, &log_det, NULL, &energy, NULL, HOL_WRITE));
    shows("straight: ln det Z~", log_det, log(0.75));
    shows("straight: U_F", energy, kT / 2 * log(0.75));
    hol_chains_destroy(chains);
    return 0;
}
