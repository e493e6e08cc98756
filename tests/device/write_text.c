/*
 * Writes the source of a plan's kernels to standard output; with `table` an array of them behind it.
 *
 *     write_text PRECISION [table]
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene.h"

int main(int argc, char **argv)
{
    static scene s;
    scene_make(&s);
    hol_device_plan *const plan = scene_plan(&s, (hol_device_precision)atoi(argv[1]));
    const int table = argc > 2 && strcmp(argv[2], "table") == 0;
    if (table) puts("#pragma GCC system_header"); /* no warnings of it */
    puts(hol_device_plan_source(plan));
    if (table) {
        puts(
            "static const struct { decltype(&hol_positions_0) positions; decltype(&hol_velocities_0) velocities; } "
            "kernels[] = {");
        for (int64_t k = 0; k < hol_device_plan_n_launches(plan); ++k) {
            const char *positions, *velocities;
            if (hol_device_plan_launch(plan, k, &positions, &velocities, NULL, NULL) != HOL_OK) return 1;
            printf("    {&%s, &%s},\n", positions, velocities);
        }
        puts("};");
    }
    hol_device_plan_destroy(plan);
    hol_chains_destroy(s.chains);
    return 0;
}
