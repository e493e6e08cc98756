/**
 * A polymer of rigid rings: benzene rings, each one body, joined by bonds from carbon to carbon opposite of it, in
 * motion at constant energy (RATTLE). Rings repel each other; everything else is held. The argument is the number of
 * steps.
 */
#include <holonomic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RINGS = 8, CARBONS = 6, ATOMS = RINGS * CARBONS };

static const double side = 1.39, bond = 1.48, dt = 1e-3; /* Angstrom, u, and what makes kT = 1 at 300 K of them */

static void must(int status)
{
    if (status == HOL_OK) return;
    fprintf(stderr, "%s\n", hol_error_message());
    exit(1);
}

/** Soft repulsion of atoms of different rings; returns the potential energy. */
static double forces(const double *r, double *f)
{
    const double range = 3.4, strength = 30;
    double energy = 0;
    memset(f, 0, sizeof *f * 3 * ATOMS);
    for (int i = 0; i < ATOMS; ++i)
        for (int j = i + 1; j < ATOMS; ++j) {
            if (j / CARBONS - i / CARBONS < 2) continue; /* of the same ring, or joined */
            double d[3], square = 0;
            for (int x = 0; x < 3; ++x) d[x] = r[3 * j + x] - r[3 * i + x], square += d[x] * d[x];
            const double left = range * range - square;
            if (left <= 0) continue;
            const double scale = strength / pow(range, 4);
            energy += scale * left * left;
            for (int x = 0; x < 3; ++x)
                f[3 * j + x] += 4 * scale * left * d[x], f[3 * i + x] -= 4 * scale * left * d[x];
        }
    return energy;
}

int main(int argc, char **argv)
{
    const int n_steps = argc > 1 ? atoi(argv[1]) : 2000;
    int64_t sizes[RINGS], atoms[ATOMS], pairs[2 * (RINGS - 1)];
    double mass[ATOMS], place[3 * ATOMS], lengths[RINGS - 1], r[3 * ATOMS], v[3 * ATOMS], f[3 * ATOMS], ref[3 * ATOMS];
    hol_chains *chains;
    /* Rings in a row along x, each turned about the row by another angle. */
    for (int i = 0; i < ATOMS; ++i) {
        const int ring = i / CARBONS;
        const double angle = acos(-1.0) / 3 * (i % CARBONS), turn = 0.7 * ring;
        double *x = place + 3 * i;
        x[0] = side * cos(angle), x[1] = side * sin(angle), x[2] = 0;
        r[3 * i] = x[0] + (2 * side + bond) * ring;
        r[3 * i + 1] = x[1] * cos(turn), r[3 * i + 2] = x[1] * sin(turn);
        atoms[i] = i;
        mass[i] = i % CARBONS == 0 || i % CARBONS == 3 ? 12 : 13;
    }
    for (int ring = 0; ring < RINGS; ++ring) {
        sizes[ring] = CARBONS;
        if (ring == 0) continue;
        pairs[2 * ring - 2] = CARBONS * (ring - 1); /* the carbon at +x of one, and that at -x of the next */
        pairs[2 * ring - 1] = CARBONS * ring + 3;
        lengths[ring - 1] = bond;
    }
    must(hol_chains_create(ATOMS, mass, &chains));
    must(hol_chains_add_rigid(chains, RINGS, sizes, atoms, place, RINGS - 1, pairs, lengths));
    for (int i = 0; i < 3 * ATOMS; ++i) v[i] = sin(1.0 + 7.3 * i * i); /* any numbers */
    must(hol_project_velocities(chains, r, v, NULL, NULL));
    double potential = forces(r, f), first = 0, worst = 0;
    for (int step = 0;; ++step) {
        double energy = potential;
        for (int i = 0; i < 3 * ATOMS; ++i) energy += 0.5 * mass[i / 3] * v[i] * v[i];
        if (step == 0) first = energy;
        worst = fmax(worst, fabs(energy / first - 1));
        if (step == n_steps) break;
        memcpy(ref, r, sizeof r);
        for (int i = 0; i < 3 * ATOMS; ++i) v[i] += dt / 2 * f[i] / mass[i / 3], r[i] += dt * v[i];
        must(hol_project_positions(chains, ref, r, v, dt, NULL, 0, NULL, NULL));
        potential = forces(r, f);
        for (int i = 0; i < 3 * ATOMS; ++i) v[i] += dt / 2 * f[i] / mass[i / 3];
        must(hol_project_velocities(chains, r, v, NULL, NULL));
    }
    hol_worst off;
    must(hol_violation(chains, r, v, &off));
    double end = 0;
    for (int x = 0; x < 3; ++x) end += pow(r[3 * (ATOMS - CARBONS) + x] - r[3 * 3 + x], 2);
    printf("rings                %d\n", RINGS);
    printf("degrees of freedom   %lld\n", (long long)hol_chains_degrees_of_freedom(chains, 3));
    printf("steps                %d\n", n_steps);
    printf("energy               %.6f\n", first);
    printf("largest energy error %.1e of it\n", worst);
    printf("largest length error %.1e\n", off.length);
    printf("largest |d.v|        %.1e\n", off.rate);
    printf("end to end           %.2f\n", sqrt(end));
    hol_chains_destroy(chains);
    return !(worst < 1e-3 && off.length < 1e-13 && off.rate < 1e-12);
}
