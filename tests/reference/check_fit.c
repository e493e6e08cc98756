#include <holonomic.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check_cases.h"
#include "random.h"
#include "worst.h"

long double check_fit(const char *name, hol_chains *chains, int64_t n_atoms, int64_t n_bonds, const int64_t *pairs,
                      const double *length, const double *r)
{
    const size_t size = 3 * (size_t)n_atoms;
    double *const off = malloc(sizeof *off * 2 * size), *const least = malloc(sizeof *least * (size_t)n_atoms);
    int status = off && least ? hol_chains_check(chains, r, HOL_BOX) : HOL_ERR_MEMORY;
    if (status == HOL_OK) {
        double *const moved = off + size;
        random_stream stream = random_seed(17);
        for (int64_t i = 0; i < n_atoms; ++i) least[i] = HUGE_VAL;
        for (int64_t k = 0; k < n_bonds; ++k)
            for (int e = 0; e < 2; ++e) {
                const int64_t i = pairs ? pairs[2 * k + e] : k + e;
                least[i] = fmin(least[i], length[k]);
            }
        /* Both ends of a bond by so much in three directions make 1e-3 of its length. */
        for (size_t i = 0; i < size; ++i)
            off[i] = r[i] + (least[i / 3] < HUGE_VAL ? 2.8e-4 * least[i / 3] * (2 * random_uniform(&stream) - 1) : 0);
        memcpy(moved, off, sizeof *off * size);
        hol_chains_set_checks(chains, HOL_ALWAYS);
        status = hol_chains_check(chains, off, HOL_BOX);
        /* Whether a bad case's lengths can be reached is another matter. */
        const int step = hol_project_positions(chains, off, moved, NULL, 1e-3, NULL, 0, NULL, NULL);
        if (step == HOL_ERR_LENGTHS) status = step;
        hol_chains_set_checks(chains, HOL_AT_START);
    }
    free(off);
    free(least);
    return status == HOL_OK ? 0 : print_failure(name, "refused for its lengths", status);
}
