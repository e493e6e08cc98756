#include "network_scene.h"

#include <stdlib.h>

network_scene network_scene_empty(double side)
{
    network_scene s = {molecule_empty(), NULL, {0}, side};
    s.box[0] = s.box[4] = s.box[8] = side;
    return s;
}

double network_nearest(const network_scene *s, const double *r, int64_t i, int64_t j, double *d)
{
    double square = 0;
    for (int c = 0; c < 3; ++c) {
        d[c] = r[3 * j + c] - r[3 * i + c];
        if (s->side > 0) d[c] -= s->side * nearbyint(d[c] / s->side);
        square += d[c] * d[c];
    }
    return square;
}

void network_begin(network_scene *s)
{
    double d[3];
    for (int64_t k = 0; k < s->m.n_bonds; ++k)
        s->m.length[k] = sqrt(network_nearest(s, s->m.r, s->m.pairs[2 * k], s->m.pairs[2 * k + 1], d));
    CHECK(hol_chains_create(s->m.n_atoms, s->m.mass, &s->chains));
    if (s->side > 0) CHECK(hol_chains_set_box(s->chains, s->box));
}
void network_add(network_scene *s)
{
    CHECK(hol_chains_add_bonds(s->chains, s->m.n_bonds, s->m.pairs, s->m.length));
}
void network_free(network_scene s)
{
    hol_chains_destroy(s.chains);
    molecule_free(&s.m);
}

long double network_unit(const network_scene *s)
{
    return (oracle_bound(s->m.n_bonds) + 64) * DBL_EPSILON;
}
molecule_problem network_problem(const network_scene *s)
{
    molecule_problem p = molecule_problem_of(&s->m);
    if (s->side > 0) p.box = s->box;
    return p;
}

void check_network_velocities(const network_scene *s)
{
    const molecule_problem p = network_problem(s);
    const long double unit = network_unit(s);
    molecule_solution exact;
    const size_t size = 3 * (size_t)s->m.n_atoms;
    double *lambda = untouched((size_t)s->m.n_bonds), *v = copy_of(s->m.v, size);
    assert_int_equal(molecule_velocities(&p, &exact), 0);
    CHECK(hol_project_velocities(s->chains, s->m.r, v, lambda, NULL));
    for (int64_t k = 0; k < s->m.n_bonds; ++k)
        CHECK_AT_MOST(fabsl(lambda[k] - exact.lambda[k]), unit * exact.lambda_scale[k]);
    for (size_t i = 0; i < size; ++i) CHECK_AT_MOST(fabsl(v[i] - exact.moved[i]), unit * exact.moved_scale[i / 3]);
    molecule_solution_free(&exact);
    free(lambda), free(v);
}

double network_worst_length(const network_scene *s, const double *r)
{
    double worst = 0, d[3];
    for (int64_t k = 0; k < s->m.n_bonds; ++k) {
        const double a2 = s->m.length[k] * s->m.length[k];
        worst = fmax(worst, fabs(network_nearest(s, r, s->m.pairs[2 * k], s->m.pairs[2 * k + 1], d) - a2) / a2);
    }
    return worst;
}
