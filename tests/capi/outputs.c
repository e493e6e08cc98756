#include "outputs.h"

#include "check.h"

/** Positions after a drift with the velocities. */
static double *drift(const assembly *a, double dt)
{
    double *r = copy_of(a->r, assembly_size(a));
    for (size_t i = 0; i < assembly_size(a); ++i) r[i] += dt * a->v[i];
    return r;
}

outputs outputs_of(const assembly *a, double dt)
{
    outputs o;
    const size_t n = (size_t)a->n_bonds, size = assembly_size(a);
    for (int k = 0; k < VERBS; ++k) o.lambda[k] = untouched(n);
    o.tension = untouched(n);
    o.atoms[0] = untouched(size);
    CHECK(hol_forces(a->chains, a->r, a->v, a->f, o.lambda[0], o.tension, o.atoms[0], HOL_WRITE, o.virial[0]));
    o.atoms[1] = copy_of(a->v, size);
    CHECK(hol_project_velocities(a->chains, a->r, o.atoms[1], o.lambda[1], o.virial[1]));
    o.atoms[2] = drift(a, dt);
    o.moved = copy_of(a->v, size);
    CHECK(hol_project_positions(a->chains, a->r, o.atoms[2], o.moved, dt, o.lambda[2], 0, o.virial[2], NULL));
    return o;
}

void outputs_free(outputs *o)
{
    for (int k = 0; k < VERBS; ++k) {
        free(o->lambda[k]);
        free(o->atoms[k]);
    }
    free(o->tension);
    free(o->moved);
}

void assert_same_outputs(const assembly *a, const outputs *p, const outputs *q, int sums_too)
{
    for (int k = 0; k < VERBS; ++k) {
        assert_same_bits(p->lambda[k], q->lambda[k], (size_t)a->n_bonds);
        assert_same_bits(p->atoms[k], q->atoms[k], assembly_size(a));
        if (sums_too) assert_same_bits(p->virial[k], q->virial[k], 9);
    }
    assert_same_bits(p->moved, q->moved, assembly_size(a));
    assert_same_bits(p->tension, q->tension, (size_t)a->n_bonds);
}
