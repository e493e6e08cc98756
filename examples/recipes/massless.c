/*
 * A water of TIP4P whose massless site M is pulled by a spring. Kicks by f/m lose the force on M; kicks by f + G, with
 * G of hol_forces at rest, have it where the masses are: then the energy holds, and the water falls towards the
 * spring's end. How fast it falls is that of its whole mass on the spring.
 */
#include <string.h>

#include "recipe.h"

static const double mass[4] = {15.9994, 1.008, 1.008, 0}, stiffness = 3;

static double force(const double *r, double *f)
{
    double energy = 0;
    memset(f, 0, sizeof *f * 12);
    for (int c = 0; c < 3; ++c) {
        const double d = r[9 + c] - (c == 2 ? 5 : 0);
        f[9 + c] = -stiffness * d;
        energy += 0.5 * stiffness * d * d;
    }
    return energy;
}

/* One run; gives the largest change of the energy, and how fast the centre of mass is at its end. */
static void run(const hol_chains *water, const double *places, int spread, double *change, double *speed)
{
    const double dt = 0.01;
    double r[12], v[12] = {0}, f[12], first = 0;
    memcpy(r, places, sizeof r);
    *change = 0;
    for (int step = 0; step <= 200; ++step) {
        const double potential = force(r, f);
        if (spread) ok(hol_forces(water, r, NULL, f, NULL, NULL, f, HOL_ADD, NULL)); /* f + G: 0 on M now */
        for (int i = 0; i < 9; ++i) v[i] += (step > 0) * 0.5 * dt / mass[i / 3] * f[i];
        ok(hol_project_velocities(water, r, v, NULL, NULL));
        double kinetic = 0;
        for (int i = 0; i < 9; ++i) kinetic += 0.5 * mass[i / 3] * v[i] * v[i];
        if (step == 0) first = potential;
        *change = fmax(*change, fabs(kinetic + potential - first));
        double before[12];
        memcpy(before, r, sizeof before);
        for (int i = 0; i < 9; ++i) v[i] += 0.5 * dt / mass[i / 3] * f[i];
        for (int i = 0; i < 12; ++i) r[i] += dt * v[i]; /* of M whatever: its place is written */
        ok(hol_project_positions(water, before, r, v, dt, NULL, 0, NULL, NULL));
    }
    double momentum = 0, all = 0;
    for (int i = 0; i < 3; ++i) momentum += mass[i] * v[3 * i + 2], all += mass[i];
    *speed = momentum / all;
}

int main(void)
{
    /* At right angles to the pull; M is close to the middle of mass. */
    const double oh = 0.9572, om = 0.1546, half = 0.5 * 104.52 * 3.14159265358979324 / 180;
    const double places[12] = {0,  0, 0, oh * cos(half), oh * sin(half), 0, oh * cos(half), -oh * sin(half), 0,
                               om, 0, 0};
    const int64_t four = 4, atoms[4] = {0, 1, 2, 3};
    hol_chains *water;
    ok(hol_chains_create(4, mass, &water));
    ok(hol_chains_add_rigid_molecules(water, 1, 4, 0, 1, &four, atoms, places, 0, NULL, NULL));
    double change, speed;
    run(water, places, 1, &change, &speed);
    const double frequency = sqrt(stiffness / (15.9994 + 2 * 1.008));
    agrees("energy with f + G: largest change", change, 0, 0.02);
    /* M is not quite at the middle of mass, so that the water turns a little: 3 per cent */
    agrees("speed of the water", speed, 5 * frequency * sin(frequency * 2.005), 0.1);
    run(water, places, 0, &change, &speed);
    agrees("with f/m alone M pulls at nothing: the speed", speed, 0, 1e-12);
    hol_chains_destroy(water);
    return 0;
}
