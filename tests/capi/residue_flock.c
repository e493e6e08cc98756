#include "residue_flock.h"

#include "check.h"

residue_results residue_compute(const hol_chains *chains, const molecule *m, double dt)
{
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    residue_results x = {.n_bonds = n, .size = size};
    for (int b = 0; b < BOND_RESULTS; ++b) x.bond[b] = untouched(n);
    x.atom[0] = untouched(size), x.atom[1] = copy_of(m->v, size), x.atom[3] = copy_of(m->v, size);
    x.atom[2] = molecule_drifted(m, dt);
    CHECK(hol_forces(chains, m->r, m->v, m->f, x.bond[0], x.bond[1], x.atom[0], HOL_WRITE, x.virial));
    CHECK(hol_solve(chains, m->r, m->length, x.bond[2], NULL, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(chains, m->r, x.atom[1], x.bond[3], NULL));
    CHECK(hol_project_positions(chains, m->r, x.atom[2], x.atom[3], dt, x.bond[4], 0, NULL, NULL));
    return x;
}

void residue_results_free(residue_results *x)
{
    for (int b = 0; b < BOND_RESULTS; ++b) free(x->bond[b]);
    for (int a = 0; a < ATOM_RESULTS; ++a) free(x->atom[a]);
}

void assert_same_results(const residue_results *some, const residue_results *all, int64_t bond, int64_t atom)
{
    for (int b = 0; b < BOND_RESULTS; ++b) assert_same_bits(some->bond[b], all->bond[b] + bond, some->n_bonds);
    for (int a = 0; a < ATOM_RESULTS; ++a) assert_same_bits(some->atom[a], all->atom[a] + 3 * atom, some->size);
}

/** x, y and z in another order, and the signs of some changed. */
static void turn(const double *r, int64_t n, int64_t copy, double *to)
{
    for (int64_t i = 0; i < 3 * n; ++i) to[i - i % 3 + (i + copy) % 3] = (copy >> i % 3) & 1 ? -r[i] : r[i];
}

molecule residue_copies(const molecule *m, int64_t copies)
{
    molecule all = molecule_empty();
    const int64_t n = m->n_atoms;
    double *r = untouched(3 * (size_t)n);
    for (int64_t c = 0; c < copies; ++c) {
        turn(m->r, n, c, r);
        for (int64_t i = 0; i < n; ++i) molecule_add_atom(&all, m->mass[i], r + 3 * i);
        for (int64_t k = 0; k < m->n_bonds; ++k)
            molecule_add_bond(&all, m->pairs[2 * k] + c * n, m->pairs[2 * k + 1] + c * n);
    }
    random_stream random = random_seed((uint64_t)copies);
    molecule_finish(&all, &random);
    for (int64_t k = 0; k < all.n_bonds; ++k) all.length[k] = m->length[k % m->n_bonds];
    for (int64_t i = 3 * n; copies > 1 && i < 6 * n; ++i) all.f[i] *= 1e9;
    free(r);
    return all;
}

molecule residue_copy(const molecule *all, const molecule *m, int64_t copy)
{
    molecule one = molecule_copy(m);
    const size_t bytes = 3 * (size_t)m->n_atoms * sizeof *m->r;
    memcpy(one.r, all->r + 3 * copy * m->n_atoms, bytes);
    memcpy(one.v, all->v + 3 * copy * m->n_atoms, bytes);
    memcpy(one.f, all->f + 3 * copy * m->n_atoms, bytes);
    return one;
}
