/* Constraints on a GPU: what a plan hands out. examples/device/steps.c launches it, by OpenCL. */
#include <string.h>

#include "check.h"

int main(void)
{
    /* Two waters, and carbon dioxide, which is a rigid body. */
    const double mass[9] = {16, 1, 1, 16, 1, 1, 12, 16, 16}, length[3] = {1, 1, 1.633},
                 straight[3] = {1.16, 1.16, 2.32};
    const int64_t water[6] = {0, 1, 0, 2, 1, 2}, dioxide[6] = {6, 7, 6, 8, 7, 8};
    hol_chains *chains = NULL;
    hol_device_plan *plan = NULL;
    ok(hol_chains_create(9, mass, &chains));
    ok(hol_chains_add_molecules(chains, 2, 3, 0, 3, water, length));
    ok(hol_chains_add_bonds(chains, 3, dioxide, straight));
    ok(hol_device_plan_create(chains, HOL_DEVICE_MIXED, -1, &plan));

    const char *const text = hol_device_plan_source(plan); /* for clCreateProgramWithSource, NVRTC or hipRTC */
    for (int which = HOL_DEVICE_INTEGERS; which <= HOL_DEVICE_FAILURES; ++which) {
        const void *data;
        int64_t bytes; /* of a buffer, to which data are copied unless they are NULL */
        ok(hol_device_plan_array(plan, (hol_device_array)which, &data, &bytes));
        if (which == HOL_DEVICE_FAILURES) shows("integers for failures", (double)bytes / 4, 4); /* 1 + 3 molecules */
    }
    shows("launches", (double)hol_device_plan_n_launches(plan), 1);
    const char *positions, *velocities;
    int64_t n_groups, group_size, left;
    ok(hol_device_plan_launch(plan, 0, &positions, &velocities, &n_groups, &group_size));
    shows("work-items", (double)(n_groups * group_size), 64);
    shows("a kernel that is in the text", strstr(text, positions) != NULL && strstr(text, velocities) != NULL, 1);
    shows("molecules for the host", (double)hol_device_plan_n_left(plan), 1);
    ok(hol_device_plan_left(plan, &left));
    shows("which", (double)left, 2);
    hol_device_plan_destroy(plan);
    hol_chains_destroy(chains);
    return 0;
}
