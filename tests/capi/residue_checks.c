#include "residue_checks.h"

#include "box_rate.h"
#include "equations.h"

pulls pulls_of(const residues *s, const double *lambda)
{
    const size_t atoms = (size_t)s->m.n_atoms;
    pulls p = {calloc(3 * atoms, sizeof *p.g), calloc(atoms, sizeof *p.size), {0}, 0};
    for (int64_t k = 0; k < s->m.n_bonds; ++k) {
        const int64_t i = s->m.pairs[2 * k], j = s->m.pairs[2 * k + 1];
        const long double pull = 2.0L * lambda[k], a = s->m.length[k];
        long double d[3];
        bond_in_box(s->m.r, s->m.pairs + 2 * k, residues_box(s), d);
        p.size[i] += fabsl(pull) * a, p.size[j] += fabsl(pull) * a;
        for (int c = 0; c < 3; ++c) p.g[3 * i + c] += pull * d[c], p.g[3 * j + c] -= pull * d[c];
        for (int n = 0; n < 9; ++n) p.virial[n] -= pull * d[n / 3] * d[n % 3];
        p.virial_size += fabsl(pull) * a * a;
    }
    return p;
}

void pulls_free(pulls *p)
{
    free(p->g), free(p->size);
}

void check_pulls(const residues *s, const double *lambda, const double *g, const double *tension, const double *virial)
{
    pulls p = pulls_of(s, lambda);
    const long double images = residues_box(s) ? s->box[0] : 0;
    for (int64_t i = 0; g && i < 3 * s->m.n_atoms; ++i)
        CHECK_AT_MOST(fabsl(g[i] - p.g[i]), (4 + images) * DBL_EPSILON * p.size[i / 3] + DBL_MIN);
    for (int64_t k = 0; tension && k < s->m.n_bonds; ++k) {
        long double d[3];
        bond_in_box(s->m.r, s->m.pairs + 2 * k, residues_box(s), d);
        const long double exact = 2 * lambda[k] * sqrtl(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        CHECK_AT_MOST(fabsl(tension[k] - exact), (4 + images) * DBL_EPSILON * fabsl(exact) + DBL_MIN);
    }
    for (int n = 0; virial && n < 9; ++n) {
        CHECK_AT_MOST(fabsl(virial[n] - p.virial[n]), (16 + images) * DBL_EPSILON * p.virial_size);
        assert_true(virial[n] == virial[3 * (n % 3) + n / 3]);
    }
    pulls_free(&p);
}

long double residue_unit(const residues *s)
{
    return (oracle_bound(s->m.n_bonds) + (residues_box(s) ? 8 * s->box[0] : 0)) * DBL_EPSILON;
}

void check_solution(const residues *s, const double *lambda, const double *moved, molecule_solution *exact)
{
    const long double unit = residue_unit(s);
    for (int64_t k = 0; k < s->m.n_bonds; ++k)
        CHECK_AT_MOST(fabsl(lambda[k] - exact->lambda[k]), unit * exact->lambda_scale[k]);
    for (int64_t i = 0; moved && i < 3 * s->m.n_atoms; ++i)
        CHECK_AT_MOST(fabsl(moved[i] - exact->moved[i]), unit * exact->moved_scale[i / 3]);
    molecule_solution_free(exact);
}

molecule_problem residues_problem(const residues *s)
{
    molecule_problem p = molecule_problem_of(&s->m);
    p.box = residues_box(s);
    return p;
}

double length_error(const residues *s, const double *r, int64_t bond)
{
    const long double square = (long double)s->m.length[bond] * s->m.length[bond];
    long double d[3];
    bond_in_box(r, s->m.pairs + 2 * bond, residues_box(s), d);
    return (double)fabsl((d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - square) / square);
}

double length_rounding(const residues *s)
{
    double extent = residues_box(s) ? 2 * s->box[0] : 0, shortest = HUGE_VAL;
    for (int64_t i = 0; i < 3 * s->m.n_atoms; ++i) extent = fmax(extent, fabs(s->m.r[i]));
    for (int64_t k = 0; k < s->m.n_bonds; ++k) shortest = fmin(shortest, s->m.length[k]);
    return 8 * DBL_EPSILON * (1 + extent / shortest);
}

static int is_held(const residues *s, int64_t k)
{
    return s->m.mass[s->m.pairs[2 * k]] == 0 && s->m.mass[s->m.pairs[2 * k + 1]] == 0;
}

int64_t worst_bond(const residues *s, const double *r, double *error)
{
    int64_t worst = -1;
    *error = -1;
    for (int64_t k = 0; k < s->m.n_bonds; ++k)
        if (!is_held(s, k) && length_error(s, r, k) > *error) *error = length_error(s, r, k), worst = k;
    return worst;
}

void check_lengths(const residues *s, const double *r)
{
    const double rounding = length_rounding(s);
    for (int64_t k = 0; k < s->m.n_bonds; ++k)
        if (!is_held(s, k)) CHECK_AT_MOST(length_error(s, r, k), rounding);
}

void check_displacements(const residues *s, const double *start, const double *r, const double *lambda, double dt)
{
    pulls p = pulls_of(s, lambda);
    const double rounded = length_rounding(s) / 2; /* of coordinates, in units of a bond */
    const long double images = residues_box(s) ? s->box[0] : 0;
    for (int64_t i = 0; i < 3 * s->m.n_atoms; ++i) {
        const long double w = s->m.inverse_mass[i / 3], per_mass = dt * dt * w;
        CHECK_AT_MOST(fabsl(start[i] + per_mass * p.g[i] - r[i]),
                      rounded + (16 + images) * DBL_EPSILON * per_mass * p.size[i / 3]);
    }
    pulls_free(&p);
}

void for_each_residues(int64_t n_bonds, int hostile, void (*check)(residues *s))
{
    const int end = hostile ? RESIDUE_RECIPES : HOSTILE_RESIDUES;
    for (int i = 0; i < end; i += quick_run() ? 5 : 1) {
        print_message("%s\n", residue_recipes[i].name);
        residues s = residues_make(&residue_recipes[i], quick_run() && n_bonds > 500 ? 500 : n_bonds, (uint64_t)i + 1);
        check(&s);
        residues_free(&s);
    }
}

void for_some_residues(const int *recipes, int64_t n_bonds, void (*check)(residues *s))
{
    for (int i = 0; recipes[i] >= 0 && !(quick_run() && i >= 2); ++i) {
        print_message("%s\n", residue_recipes[recipes[i]].name);
        residues s = residues_make(&residue_recipes[recipes[i]], n_bonds, 77 + (uint64_t)i);
        check(&s);
        residues_free(&s);
    }
}

void check_rates(const residues *s, const double *before, const double *v, const double *rate)
{
    const molecule *m = &s->m;
    const long double images = residues_box(s) ? s->box[0] : 0;
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t i = 3 * m->pairs[2 * k], j = 3 * m->pairs[2 * k + 1];
        long double d[3], Ld[3] = {0}, left = 0, size = 0;
        bond_in_box(m->r, m->pairs + 2 * k, residues_box(s), d);
        if (rate) rate_times(rate, d, Ld);
        for (int c = 0; c < 3; ++c) {
            left += d[c] * ((long double)v[j + c] - v[i + c] + Ld[c]);
            size += fabsl(d[c]) * (fabs(v[j + c]) + fabs(v[i + c]) + fabsl(Ld[c]));
            if (before) size += fabsl(d[c]) * (fabs(before[j + c]) + fabs(before[i + c]));
        }
        CHECK_AT_MOST(fabsl(left), (8 + images) * DBL_EPSILON * size + DBL_MIN);
    }
}

void check_moves(const residues *s, const double *before, const double *v, const double *lambda)
{
    pulls p = pulls_of(s, lambda);
    const long double images = residues_box(s) ? s->box[0] : 0;
    for (int64_t i = 0; i < 3 * s->m.n_atoms; ++i) {
        const long double w = s->m.inverse_mass[i / 3], moved = before[i] + w * p.g[i];
        long double size = w * p.size[i / 3];
        for (int c = 0; c < 3; ++c) size += fabs(before[i - i % 3 + c]) + fabs(v[i - i % 3 + c]);
        CHECK_AT_MOST(fabsl(v[i] - moved), (16 + images) * DBL_EPSILON * size);
    }
    pulls_free(&p);
}
