#include "operations.h"

#include <string.h>

static size_t atoms3(const assembly *a)
{
    return assembly_size(a);
}
static size_t bonds(const assembly *a)
{
    return (size_t)a->n_bonds;
}

/* Layout of `out`: two arrays per atom, eight numbers per bond, and 16 numbers. */
static double *per_bond(const assembly *a, double *out)
{
    return out + 2 * atoms3(a);
}
static double *numbers(const assembly *a, double *out)
{
    return per_bond(a, out) + 8 * bonds(a);
}
size_t out_size(const assembly *a)
{
    return 2 * atoms3(a) + 8 * bonds(a) + 16;
}

void prepare(const assembly *a, double *out)
{
    for (size_t i = 0; i < out_size(a); ++i) out[i] = 0.25;
    memcpy(out, a->v, sizeof *out * atoms3(a));
    for (size_t i = 0; i < atoms3(a); ++i) out[atoms3(a) + i] = a->r[i] + 0.003 * a->v[i];
}

int forces(const assembly *a, double *out)
{
    return hol_forces(a->chains, a->r, a->v, a->f, per_bond(a, out), per_bond(a, out) + bonds(a), out, HOL_WRITE,
                      numbers(a, out));
}

static int velocities(const assembly *a, double *out)
{
    return hol_project_velocities(a->chains, a->r, out, per_bond(a, out), numbers(a, out));
}

static int positions(const assembly *a, double *out)
{
    return hol_project_positions(a->chains, a->r, out + atoms3(a), out, 0.003, per_bond(a, out), 0, numbers(a, out),
                                 NULL);
}

const int64_t *pairs_of_bonds;

/* The bond vectors are not among the outputs. */
static int positions_along(const assembly *a, double *out)
{
    static double b[3 * 20000];
    if (3 * bonds(a) > sizeof b / sizeof *b) return HOL_ERR_INTERNAL;
    int64_t k = 0;
    for (int64_t c = 0; c < (pairs_of_bonds ? 1 : a->n_chains); ++c)
        for (int64_t in_chain = 0; in_chain < (pairs_of_bonds ? a->n_bonds : assembly_bonds(a, c)); ++in_chain, ++k) {
            const int64_t *const ends = pairs_of_bonds ? pairs_of_bonds + 2 * k : a->atoms + a->first[c] + in_chain;
            for (int x = 0; x < 3; ++x) b[3 * k + x] = a->r[3 * ends[1] + x] - a->r[3 * ends[0] + x];
        }
    return hol_project_positions_along(a->chains, b, out + atoms3(a), out, 0.003, per_bond(a, out), 0, numbers(a, out),
                                       NULL);
}

static int check(const assembly *a, double *out)
{
    (void)out;
    return hol_chains_check(a->chains, a->r, HOL_BOX);
}

static int violation(const assembly *a, double *out)
{
    hol_worst worst = {0, 0, 0, 0, 0, 0};
    const int status = hol_violation(a->chains, a->r, a->v, &worst);
    if (status == HOL_OK) numbers(a, out)[0] = worst.length;
    return status;
}

int given_right_hand_sides(const assembly *a, double *out)
{
    return hol_solve(a->chains, a->r, a->length, per_bond(a, out), out, HOL_WRITE, numbers(a, out));
}

static int reactions(const assembly *a, double *out)
{
    double *const o = per_bond(a, out);
    return hol_reactions(a->chains, a->r, HOL_BOX, a->length, o, out, HOL_WRITE, o + bonds(a), numbers(a, out));
}

/* With a rate of the box, which is taken away again. */
static int in_motion(const assembly *a, double *out, int (*call)(const assembly *, double *))
{
    const double L[9] = {0.1, 0.3, 0, 0, -0.2, 0, 0.4, 0, 0};
    int status = hol_chains_set_box_rate(a->chains, L);
    if (status == HOL_OK) status = call(a, out);
    if (hol_chains_set_box_rate(a->chains, NULL) != HOL_OK) return HOL_ERR_INTERNAL;
    return status;
}
static int forces_in_motion(const assembly *a, double *out)
{
    return in_motion(a, out, forces);
}
static int velocities_in_motion(const assembly *a, double *out)
{
    return in_motion(a, out, velocities);
}

static int metric(const assembly *a, double *out)
{
    return hol_metric(a->chains, a->r, 1, per_bond(a, out), NULL, numbers(a, out), out, HOL_WRITE);
}

static int inverse(const assembly *a, double *out)
{
    hol_inverse *made = (hol_inverse *)out;
    int status = hol_inverse_create(a->chains, 0, a->r, &made);
    if (status != HOL_OK) {
        if (made != NULL) return HOL_ERR_INTERNAL; /* "NULL on an error" */
        return status;
    }
    double *o = numbers(a, out);
    status = hol_inverse_entry(made, HOL_UNIT_DIAGONAL, 0, 1, o);
    if (status == HOL_OK) status = hol_inverse_condition(made, o + 1);
    if (status != HOL_OK) o[0] = o[1] = 0.25;
    hol_inverse_destroy(made);
    return status;
}

hol_inverse *prepared;

static int inverse_row(const assembly *a, double *out)
{
    return hol_inverse_row(prepared, HOL_PHYSICAL, 1, per_bond(a, out));
}
static int inverse_band(const assembly *a, double *out)
{
    return hol_inverse_band(prepared, HOL_UNIT_DIAGONAL, 1, per_bond(a, out));
}
static int inverse_bound(const assembly *a, double *out)
{
    return hol_inverse_error_bound(prepared, a->v, a->f, a->length, per_bond(a, out), numbers(a, out));
}

/* Forces, or right-hand sides, by factors that are made for them. */
static int kept(const assembly *a, double *out, int sides)
{
    hol_factors *made = (hol_factors *)out;
    int status = hol_factors_create(a->chains, &made);
    if (status != HOL_OK) {
        if (made != NULL) return HOL_ERR_INTERNAL; /* "NULL on an error" */
        return status;
    }
    double *const o = per_bond(a, out);
    status = hol_factors_update(made, a->r);
    if (status == HOL_OK && sides)
        status = hol_factors_solve(made, 1, a->length, o, out, HOL_WRITE, numbers(a, out));
    else if (status == HOL_OK)
        status = hol_factors_forces(made, a->v, a->f, o, o + bonds(a), out, HOL_WRITE, numbers(a, out));
    hol_factors_destroy(made);
    return status;
}
static int kept_forces(const assembly *a, double *out)
{
    return kept(a, out, 0);
}
static int kept_solve(const assembly *a, double *out)
{
    return kept(a, out, 1);
}

static double gamma_of(size_t k)
{
    return 0.3 + 0.1 * (double)(k % 2);
}

static int tridiagonal(const assembly *a, double *out, int which)
{
    enum { ROWS = 50 };
    double gamma[ROWS], *o = per_bond(a, out);
    for (size_t k = 0; k < ROWS; ++k) gamma[k] = gamma_of(k);
    switch (which) {
        case 0:
            return hol_tridiagonal_pivots(ROWS, gamma, o);
        case 1:
            return hol_tridiagonal_log_det(ROWS, gamma, o);
        case 2:
            return hol_tridiagonal_solve(ROWS, gamma, gamma, o);
        case 3:
            return hol_tridiagonal_inverse_entry(ROWS, gamma, 3, 17, o);
        default:
            return hol_tridiagonal_inverse_band(ROWS, gamma, 1, o);
    }
}

static int pivots(const assembly *a, double *out)
{
    return tridiagonal(a, out, 0);
}
static int log_det(const assembly *a, double *out)
{
    return tridiagonal(a, out, 1);
}
static int solve(const assembly *a, double *out)
{
    return tridiagonal(a, out, 2);
}
static int entry(const assembly *a, double *out)
{
    return tridiagonal(a, out, 3);
}
static int band(const assembly *a, double *out)
{
    return tridiagonal(a, out, 4);
}

static int partition(const assembly *a, double *out)
{
    const double mass[7] = {1, 12, 1, 16, 1, 14, 3};
    double *o = numbers(a, out);
    return hol_partition_function(6, mass, o, o + 1, o + 2);
}

const operation operations[] = {
    {"hol_forces", forces, 0},
    {"hol_project_velocities", velocities, 0},
    {"hol_project_positions", positions, 0},
    {"hol_project_positions_along", positions_along, 0},
    {"hol_chains_check", check, 0},
    {"hol_violation", violation, 0},
    {"hol_solve", given_right_hand_sides, 0},
    {"hol_reactions", reactions, 0},
    {"hol_forces with a rate", forces_in_motion, 0},
    {"hol_project_velocities with a rate", velocities_in_motion, 0},
    {"hol_metric", metric, 0},
    {"hol_inverse_create", inverse, 0},
    {"hol_inverse_row", inverse_row, 0},
    {"hol_inverse_band", inverse_band, 0},
    {"hol_inverse_error_bound", inverse_bound, 0},
    {"hol_factors_forces", kept_forces, 1},
    {"hol_factors_solve", kept_solve, 1},
    {"hol_tridiagonal_pivots", pivots, 0},
    {"hol_tridiagonal_log_det", log_det, 0},
    {"hol_tridiagonal_solve", solve, 0},
    {"hol_tridiagonal_inverse_entry", entry, 0},
    {"hol_tridiagonal_inverse_band", band, 0},
    {"hol_partition_function", partition, 0},
};

const size_t n_operations = sizeof operations / sizeof *operations;
