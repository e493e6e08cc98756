/* The bare algebra of a matrix with ones on its diagonal and -gamma beside it. */
#include "check.h"

int main(void)
{
    const double gamma[2] = {0.5, 0.5}, b[3] = {1, 0, 0};
    double omega2[3], log_det, x[3], value, band[3][2];

    ok(hol_tridiagonal_pivots(3, gamma, omega2));
    shows("Omega_3^2", omega2[2], 2.0 / 3);
    ok(hol_tridiagonal_log_det(3, gamma, &log_det));
    shows("ln det", log_det, log(0.5));
    ok(hol_tridiagonal_solve(3, gamma, b, x));
    shows("x_1", x[0], 1.5);
    ok(hol_tridiagonal_inverse_entry(3, gamma, 0, 2, &value));
    shows("inverse, 0 2", value, 0.5);
    ok(hol_tridiagonal_inverse_band(3, gamma, 1, band[0]));
    shows("inverse, 1 1", band[1][0], 2);
    return 0;
}
