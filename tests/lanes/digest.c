/**
 * Prints what the calls give for chains of many lengths, one line each: the length, the place and a number that stands
 * for all bits of every array per atom, bond and chain. Sums over chains, which depend on what is added first, are left
 * out. Kernels between which the size of a call decides must print the same (same_bits.sh).
 *
 *   digest [LONGEST [SHORTEST]]        default 1400 and 1
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene.h"

/** FNV-1a over the bytes of n numbers. */
static uint64_t add(uint64_t hash, const double *a, int64_t n)
{
    const unsigned char *const bytes = (const unsigned char *)a;
    for (size_t i = 0; i < sizeof *a * (size_t)n; ++i) hash = (hash ^ bytes[i]) * UINT64_C(1099511628211);
    return hash;
}

static uint64_t digest(const scene *s, const answers *a)
{
    uint64_t hash = UINT64_C(14695981039346656037);
    for (int verb = 0; verb < 3; ++verb) hash = add(hash, a->lambda[verb], s->n_bonds);
    hash = add(hash, a->tension, s->n_bonds);
    const double *const per_atom[] = {a->g, a->projected, a->moved, a->pushed, a->fixman};
    for (int i = 0; i < 5; ++i) hash = add(hash, per_atom[i], 3 * s->n_atoms);
    hash = add(hash, a->log_det, s->n_chains);
    return add(hash, a->log_det_z, s->n_chains);
}

int main(int argc, char **argv)
{
    const int64_t longest = argc > 1 ? atoi(argv[1]) : 1400, shortest = argc > 2 ? atoi(argv[2]) : 1;
    const char *const wanted = getenv("HOLONOMIC_ISA");
    if (wanted && strcmp(wanted, hol_instruction_set()) != 0) return 77;
    for (int64_t n = shortest; n <= longest; n += n < 300 ? 1 : 1 + n / 64)
        for (int where = 0; where < PLACES; ++where)
            for (int plain = 0; plain < 2; ++plain) {
                scene s = scene_make(n <= 256 ? 21 : 2, n, (place)where, (int)((n + where) % 2));
                answers a = plain ? scene_plain_answers(&s) : scene_answers(&s);
                printf("%lld bonds, %s%s: %016llx\n", (long long)n, place_names[where], plain ? ", plain" : "",
                       (unsigned long long)digest(&s, &a));
                if (a.failed) printf("failed: %s\n", a.failed);
                answers_free(&a);
                scene_free(&s);
            }
    return 0;
}
