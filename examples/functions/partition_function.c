/* What rigid bonds contribute to the free energy of a trimer: the mean of the root of the metric determinant. */
#include "check.h"

int main(void)
{
    double log_he, log_rigid, log_volume;
    ok(hol_partition_function(2, NULL, &log_he, &log_rigid, &log_volume)); /* equal masses */
    /* the mean of (1 - c^2 / 4)^(+-1/2) over c in -1 .. 1 */
    shows("ln < det^(-1/2) >", log_he, log(M_PI / 3));
    shows("ln < det^(+1/2) >", log_rigid, log(sqrt(3.0) / 4 + M_PI / 6));
    shows("ln of the volume", log_volume, log(0.5));
    return 0;
}
