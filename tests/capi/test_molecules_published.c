/**
 * Numbers that GROMACS publishes: the reference data of the tests of its constraints, mdlib/tests/constr.cpp and
 * settle.cpp (gromacs.org, 2026). Theirs are those of SHAKE and LINCS to a tolerance that each scene states; ours are
 * exact. Their virial takes the length that a bond should have, times its direction; ours the reference positions.
 */
#include "check.h"

enum { MOST_ATOMS = 4, MOST_BONDS = 3 };

typedef struct published {
    const char *name;
    int n_atoms, n_bonds;
    double mass[MOST_ATOMS];
    int64_t pair[2 * MOST_BONDS];
    double length[MOST_BONDS];
    double reference[3 * MOST_ATOMS], trial[3 * MOST_ATOMS], v[3 * MOST_ATOMS];
    double r[3 * MOST_ATOMS], v_after[3 * MOST_ATOMS];
    double virial[9];       /**< theirs: dt^2 times an energy, of the other sign */
    double off, virial_off; /**< what their iterations leave, of coordinates and of the largest component */
} published;

#define A 0.070710678118654752 /* a tenth over the root of two */
#define B 0.11547005383792516  /* two tenths over the root of three */

static const published scenes[] = {
    {"one bond",
     2,
     1,
     {1, 12},
     {0, 1},
     {0.1},
     {0, A, 0, A, 0, 0},
     {0.01, 0.08, 0.01, 0.06, 0.01, -0.01},
     {1, 2, 3, 3, 2, 1},
     {0.0021016474, 0.087898351, 0.01, 0.060658198, 0.0093418043, -0.01},
     {-6.8983517, 9.8983517, 3, 3.658196, 1.341804, 1},
     {-0.00055849785, 0.00055849785, 0, 0.00055849785, -0.00055849785, 0, 0, 0, 0},
     1e-8,
     1e-6},
    {"two bonds apart",
     4,
     2,
     {0.5, 1.0 / 3, 0.25, 1},
     {0, 1, 2, 3},
     {2, 1},
     {2.5, -3.1, 15.7, 0.51, -3.02, 15.55, -0.5, -3, 15.2, -1.51, -2.95, 15.05},
     {2.5, -3.1, 15.7, 0.51, -3.02, 15.55, -0.5, -3, 15.2, -1.51, -2.95, 15.05},
     {0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0},
     {2.501097, -3.100044, 15.700083, 0.50835478, -3.0199339, 15.549876, -0.51762629, -2.9991274, 15.197382, -1.5055934,
      -2.9502182, 15.050654},
     {1.0967836, 0.95590824, 0.082671925, -0.64517546, 0.066137642, -0.12400789, -17.626278, 0.8725872, -1.6177576,
      4.4065695, -0.2181468, 0.65443939},
     {0.0032607431, -0.00017159013, 0.00056419277, -0.00017159013, 8.903291e-06, -2.869669e-05, 0.00056419271,
      -2.869669e-05, 8.9815294e-05},
     1e-6,
     3e-5},
    {"a chain of two bonds",
     3,
     2,
     {1, 12, 16},
     {0, 1, 1, 2},
     {0.1, 0.2},
     {A, A, 0, 0, 0, 0, B, B, B},
     {0.08, 0.07, 0.01, -0.02, 0.01, -0.02, 0.1, 0.12, 0.11},
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0.068317376, 0.058317374, 0.01, -0.016634544, 0.013365454, -0.017608097, 0.098206073, 0.11820607, 0.10820607},
     {-10.682622, -11.682622, 0, 3.3725662719, 4.3654542, 2.3996890359, -1.7997667769, -1.7997667769, -0.7997667769},
     {0.004150620375, 0.004150620375, 0.00332510666608, 0.004150620375, 0.004150620375, 0.00332510666608,
      0.00332510666608, 0.00332510666608, 0.00332510666608},
     2e-5,
     1e-4},
    {"a chain of three bonds",
     4,
     3,
     {0.5, 1.0 / 3, 0.25, 1},
     {0, 1, 1, 2, 2, 3},
     {2, 1, 1},
     {2.5, -3.1, 15.7, 0.51, -3.02, 15.55, -0.5, -3, 15.2, -1.51, -2.95, 15.05},
     {2.5, -3.1, 15.7, 0.51, -3.02, 15.55, -0.5, -3, 15.2, -1.51, -2.95, 15.05},
     {0, 0, 2, 0, 0, 3, 0, 0, -4, 0, 0, -1},
     {2.4562423, -3.0982409, 15.696703, 0.46585017, -3.0204642, 15.516903, -0.49186659, -2.9960549, 15.230195,
      -1.4754381, -2.9517109, 15.055132},
     {-43.757378, 1.7590889, -1.2982867, -44.149811, -0.46465778, -30.097218, 8.1334686, 3.9453049, 26.19441, 34.561924,
      -1.7109847, 4.1329465},
     {0.11231654, -0.0041276934, 0.020337878, -0.0041276934, 0.00016769962, -0.00062039652, 0.020337878, -0.00062039646,
      0.005152476},
     3e-5,
     1e-3},
    {"three bonds at one atom",
     4,
     3,
     {12, 1, 1, 1},
     {0, 1, 0, 2, 0, 3},
     {0.1, 0.1, 0.1},
     {0, 0, 0, 0.1, 0, 0, 0, -0.1, 0, 0, 0, 0.1},
     {0.004, 0.009, -0.01, 0.11, -0.006, 0.003, -0.007, -0.102, -0.007, -0.005, 0.011, 0.102},
     {1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0},
     {0.004595859, 0.0081014819, -0.0090392847, 0.1028497, -0.006, 0.003, -0.007, -0.091217794, -0.007, -0.005, 0.011,
      0.090471417},
     {1.5958586, -0.89851707, 0.96071517, -6.1503019, 0, 0, 1, 10.782205, 0, 1, 0, -11.528582},
     {0.00071503024, 0, 0, 0, 0.0010782205, 0, 0, 0, 0.0011528583},
     3e-5,
     2e-3},
    {"a triangle",
     3,
     3,
     {1, 1, 1},
     {0, 1, 0, 2, 1, 2},
     {0.1, 0.1, 0.1},
     {A, 0, 0, 0, A, 0, 0, 0, A},
     {0.09, -0.02, 0.01, -0.02, 0.1, -0.02, 0.03, -0.01, 0.07},
     {1, 1, 1, -2, -2, -2, 1, 1, 1},
     {0.081519715, 0.0026918508, -0.004211565, 0.0026918508, 0.064219035, -0.0069108736, 0.015788434, 0.003089126,
      0.071122445},
     {-7.4802856, 23.691851, -13.211565, 20.691851, -37.780975, 11.089125, -13.211565, 14.089125, 2.13785308},
     {0.00059964682, -0.0016045563, 0.0010049095, -0.0016045563, 0.0025300975, -0.00092554104, 0.0010049095,
      -0.00092554104, -8.0458363e-05},
     3e-5,
     1e-3},
};
enum { SCENES = sizeof scenes / sizeof *scenes };

static const double dt = 0.001;

static double difference(const double *r, const int64_t *pair, int x)
{
    return r[3 * pair[1] + x] - r[3 * pair[0] + x];
}

/** Theirs of our multipliers: the impulse of each bond along its direction, times the length that it should have. */
static void virial_by_lengths(const published *s, const double *lambda, double *virial)
{
    memset(virial, 0, 9 * sizeof *virial);
    for (int k = 0; k < s->n_bonds; ++k) {
        double b[3], length = 0;
        for (int x = 0; x < 3; ++x) {
            b[x] = difference(s->reference, s->pair + 2 * k, x);
            length += b[x] * b[x];
        }
        for (int e = 0; e < 9; ++e)
            virial[e] += 2 * dt * dt * lambda[k] * b[e / 3] * b[e % 3] * s->length[k] / sqrt(length);
    }
}

static void positions_velocities_and_virials_are_those_published(void **state)
{
    (void)state;
    for (int i = 0; i < SCENES; ++i) {
        const published *const s = &scenes[i];
        print_message("%s\n", s->name);
        hol_chains *chains = NULL;
        double r[3 * MOST_ATOMS], v[3 * MOST_ATOMS], lambda[MOST_BONDS], virial[9];
        memcpy(r, s->trial, sizeof r);
        memcpy(v, s->v, sizeof v);
        CHECK(hol_chains_create(s->n_atoms, s->mass, &chains));
        CHECK(hol_chains_add_bonds(chains, s->n_bonds, s->pair, s->length));
        CHECK(hol_project_positions(chains, s->reference, r, v, dt, lambda, 0, NULL, NULL));
        for (int k = 0; k < s->n_bonds; ++k) {
            double d2 = 0;
            for (int x = 0; x < 3; ++x) d2 += pow(difference(r, s->pair + 2 * k, x), 2);
            CHECK_AT_MOST(fabs(sqrt(d2) / s->length[k] - 1), 1e-13);
        }
        for (int e = 0; e < 3 * s->n_atoms; ++e) {
            CHECK_AT_MOST(fabs(r[e] - s->r[e]), s->off);
            CHECK_AT_MOST(fabs(v[e] - s->v_after[e]), s->off / dt);
        }
        virial_by_lengths(s, lambda, virial);
        double scale = 0;
        for (int e = 0; e < 9; ++e) scale = fmax(scale, fabs(s->virial[e]));
        for (int e = 0; e < 9; ++e) CHECK_AT_MOST(fabs(virial[e] - s->virial[e]), s->virial_off * scale);
        hol_chains_destroy(chains);
    }
}

enum { WATERS = 2 };

static void waters_are_those_of_settle(void **state)
{
    (void)state;
    static const double mass[9] = {15.9994, 1.008, 1.008, 15.9994, 1.008, 1.008};
    static const double reference[9 * WATERS] = {0.130,  -0.041, -0.291, 0.120,  -0.056, -0.192, 0.044,  -0.005, -0.327,
                                                 -0.854, -0.406, 0.477,  -0.900, -0.334, 0.425,  -0.858, -0.386, 0.575};
    static const double moved[4] = {0.01, -0.01, 0.02, -0.02};
    static const double r_after[9 * WATERS] = {
        0.13957903779718056,  -0.050722938026974689, -0.27171858075593974,  0.10565322823307846,  -0.051604884600181554,
        -0.18221673711201103, 0.065028460921474518,  -0.023792759577617249, -0.32537764686955362, -0.86282861382597797,
        -0.38771444193676585, 0.45921239603021274,   -0.90970533234610751,  -0.31334089073095789, 0.42135124784607059,
        -0.87688740173390045, -0.37944676569454622,  0.55353267175136334};
    static const double v_after[9 * WATERS] = {
        -0.21048110140972198, 0.13853098651265683, -0.35929037796988855, 2.8266141165392367,  -2.8024423000907754,
        9.8916314439944841,   0.51423046073725831, 0.60362021119137599,  -4.1888234347768023, 0.5856930870110143,
        -0.85722096838293538, 1.1061980151063984,  -9.8526661730537555,  15.32955463452107,   -11.82437607696472,
        0.55629913304975931,  -1.723382847273117,  -5.7336641243183122};
    static const int64_t pair[6] = {0, 1, 0, 2, 1, 2};
    static const double length[3] = {0.09572, 0.09572, 0.15139};
    double r[9 * WATERS], v[9 * WATERS] = {0};
    hol_chains *chains = NULL;
    for (int e = 0; e < 9 * WATERS; ++e) r[e] = reference[e] + moved[e % 4];
    CHECK(hol_chains_create(3 * WATERS, mass, &chains));
    CHECK(hol_chains_add_molecules(chains, WATERS, 3, 0, 3, pair, length));
    CHECK(hol_project_positions(chains, reference, r, v, 0.002, NULL, 0, NULL, NULL));
    for (int e = 0; e < 9 * WATERS; ++e) {
        CHECK_AT_MOST(fabs(r[e] - r_after[e]), 1e-9);
        CHECK_AT_MOST(fabs(v[e] - v_after[e]), 1e-6);
    }
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(positions_velocities_and_virials_are_those_published),
        cmocka_unit_test(waters_are_those_of_settle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
