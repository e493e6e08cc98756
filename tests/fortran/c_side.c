/* What the header says of constants and layouts, for the Fortran side to compare. */
#include <stddef.h>

#include "holonomic.h"

int64_t c_layout(int which);

int64_t c_layout(int which)
{
    static const int64_t list[] = {
        HOL_OK,
        HOL_ERR_NULL,
        HOL_ERR_VALUE,
        HOL_ERR_INDEX,
        HOL_ERR_SHARED_ATOM,
        HOL_ERR_MEMORY,
        HOL_ERR_NOT_FINITE,
        HOL_ERR_DEGENERATE,
        HOL_ERR_NO_CONVERGENCE,
        HOL_ERR_NOT_DEFINITE,
        HOL_ERR_INTERNAL,
        HOL_DOUBLE,
        HOL_FLOAT,
        HOL_WRITE,
        HOL_ADD,
        HOL_UNIT_DIAGONAL,
        HOL_PHYSICAL,
        HOL_SHAPE_CHAIN,
        HOL_SHAPE_TREE,
        HOL_SHAPE_RING,
        HOL_SHAPE_TRIANGLE,
        HOL_SHAPE_OTHER,
        sizeof(hol_view),
        offsetof(hol_view, x),
        offsetof(hol_view, y),
        offsetof(hol_view, z),
        offsetof(hol_view, stride),
        offsetof(hol_view, element),
        offsetof(hol_view, reserved),
        sizeof(hol_report),
        offsetof(hol_report, iterations),
        offsetof(hol_report, n_corrected),
        offsetof(hol_report, n_failed),
        offsetof(hol_report, molecule),
        offsetof(hol_report, bond),
        offsetof(hol_report, max_error),
        sizeof(hol_worst),
        offsetof(hol_worst, length),
        offsetof(hol_worst, length_molecule),
        offsetof(hol_worst, length_bond),
        offsetof(hol_worst, rate),
        offsetof(hol_worst, rate_molecule),
        offsetof(hol_worst, rate_bond),
    };
    const int count = (int)(sizeof list / sizeof list[0]);
    return which < count ? list[which] : -1;
}
