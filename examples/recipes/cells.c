/**
 * Cells that are no parallelepiped: the truncated octahedron and the rhombic dodecahedron fill space as lattices do,
 * and a lattice is three vectors. Those go into the box, whatever cell the program puts its atoms back into.
 */
#include "../sampling/noise.h"
#include "recipe.h"

enum { WATERS = 500, ATOMS = 3 * WATERS };

typedef struct cell {
    const char *name;
    double volume; /* over that of a cube with the same distance between images */
    double box[9]; /* for images at a distance of 1 */
} cell;

static const double hh = 1.63299316185545;

/* Molecules anywhere in space, in any direction. */
static void place_waters(double *r, noise *random)
{
    const double half = hh / 2, height = sqrt(1 - half * half);
    for (long m = 0; m < WATERS; ++m) {
        double u[3], w[3], along = 0, size = 0;
        noise_direction(random, u);
        noise_direction(random, w);
        for (int c = 0; c < 3; ++c) along += u[c] * w[c];
        for (int c = 0; c < 3; ++c) w[c] -= along * u[c];
        for (int c = 0; c < 3; ++c) size += w[c] * w[c];
        for (int c = 0; c < 3; ++c) {
            const double centre = 100 * noise_uniform(random), side = half * w[c] / sqrt(size);
            r[9 * m + c] = centre;
            r[9 * m + 3 + c] = centre + height * u[c] + side;
            r[9 * m + 6 + c] = centre + height * u[c] - side;
        }
    }
}

/* Puts each atom by itself to the image that is nearest to the origin: into the Wigner-Seitz cell of the lattice,
 * which is the truncated octahedron, the dodecahedron or the prism. */
static void wrap(double *r, const double *box)
{
    for (long i = 0; i < ATOMS; ++i) {
        double *const x = r + 3 * i;
        for (int row = 2; row >= 0; --row) {
            const double n = nearbyint(x[row] / box[4 * row]);
            for (int c = 0; c < 3; ++c) x[c] -= n * box[3 * row + c];
        }
        double best[3] = {x[0], x[1], x[2]}, least = INFINITY;
        for (int k = 0; k < 27; ++k) {
            double y[3], distance = 0;
            for (int c = 0; c < 3; ++c) {
                y[c] = x[c] + (k % 3 - 1) * box[c] + (k / 3 % 3 - 1) * box[3 + c] + (k / 9 - 1) * box[6 + c];
                distance += y[c] * y[c];
            }
            if (!(distance < least)) continue;
            least = distance;
            for (int c = 0; c < 3; ++c) best[c] = y[c];
        }
        for (int c = 0; c < 3; ++c) x[c] = best[c];
    }
}

int main(void)
{
    const cell cells[] = {
        {"truncated octahedron", 4 / sqrt(27), {1, 0, 0, 1 / 3.0, sqrt(8) / 3, 0, -1 / 3.0, sqrt(2) / 3, sqrt(6) / 3}},
        {"rhombic dodecahedron", sqrt(0.5), {1, 0, 0, 0, 1, 0, 0.5, 0.5, sqrt(0.5)}},
        {"hexagonal prism", sqrt(0.75), {1, 0, 0, 0.5, sqrt(0.75), 0, 0, 0, 1}}};
    const int64_t bonds[6] = {0, 1, 0, 2, 1, 2};
    const double lengths[3] = {1, 1, hh};
    double mass[ATOMS], whole[3 * ATOMS], r[3 * ATOMS], v[3 * ATOMS], T[ATOMS], T_whole[ATOMS];
    noise random = noise_start(2);
    for (long i = 0; i < ATOMS; ++i) mass[i] = i % 3 ? 1 : 16;
    for (int which = 0; which < 3; ++which) {
        const cell *const c = &cells[which];
        double box[9];
        hol_chains *chains;
        for (int i = 0; i < 9; ++i) box[i] = 20 * c->box[i]; /* images are 20 apart */
        agrees(c->name, box[0] * box[4] * box[8] / 8000, c->volume, 1e-14);
        ok(hol_chains_create(ATOMS, mass, &chains));
        ok(hol_chains_add_molecules(chains, WATERS, 3, 0, 3, bonds, lengths));
        place_waters(whole, &random);
        for (long i = 0; i < 3 * ATOMS; ++i) r[i] = whole[i];
        for (long i = 0; i < 3 * ATOMS; ++i) v[i] = noise_normal(&random);
        wrap(r, box);
        double cut = 0;
        for (long i = 0; i < ATOMS; ++i) cut += fabs(r[3 * i] - r[3 * (i - i % 3)]) > 5;
        printf("%g atoms lie at another face than their molecule's first\n", cut);
        ok(hol_chains_set_box(chains, box));
        ok(hol_chains_check(chains, r, HOL_BOX)); /* every bond has its length */
        hol_worst worst;
        ok(hol_violation(chains, r, NULL, &worst));
        agrees("largest error of a bond", worst.length, 0, 1e-12);
        ok(hol_forces(chains, r, v, NULL, NULL, T, NULL, HOL_WRITE, NULL));
        ok(hol_chains_set_box(chains, NULL));
        ok(hol_forces(chains, whole, v, NULL, NULL, T_whole, NULL, HOL_WRITE, NULL));
        double difference = 0, largest = 0;
        for (long k = 0; k < ATOMS; ++k) {
            difference = fmax(difference, fabs(T[k] - T_whole[k]));
            largest = fmax(largest, fabs(T_whole[k]));
        }
        agrees("tensions, against whole molecules", difference / largest, 0, 1e-12);
        hol_chains_destroy(chains);
    }
    return 0;
}
