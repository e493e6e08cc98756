/*
 * A program as one that was linked to an earlier release may be: it calls every function of that release, uses every
 * public struct, and checks what comes back. every_function.sh builds it against an old header and runs it with today's
 * library.
 */
#include <holonomic.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static int failures = 0;

static void expect(int right, const char *what)
{
    if (right) return;
    printf("not so: %s (%s)\n", what, hol_error_message());
    ++failures;
}

#define EXPECT(what) expect((what) != 0, #what)
#define NEAR(a, b) EXPECT(fabs((a) - (b)) <= 1e-12)
#define SUCCEEDS(call) EXPECT((call) == HOL_OK)

/* Three beads hang from a fixed one. */
static const double mass[4] = {0, 1, 1, 1}, length[3] = {1, 1, 1};
static const double hanging[12] = {0, 0, 0, 0, 0, -1, 0, 0, -2, 0, 0, -3};
static const double weight[12] = {0, 0, -10, 0, 0, -10, 0, 0, -10, 0, 0, -10};

static void handles(hol_chains *chains)
{
    const double box[9] = {100, 0, 0, 0, 100, 0, 0, 0, 100};
    const unsigned char active[1] = {1};
    const int64_t list[2] = {2, 3};
    int64_t offsets[2], atoms[4], chain = 7, bond = 7, atom = 7, bad = 7;
    hol_chains *second = NULL;
    unsigned char is_active[1] = {7};
    int64_t label = 7;
    double rate[9] = {7, 7, 7, 7, 7, 7, 7, 7, 7};
    EXPECT(strncmp(hol_version(), "0.", 2) == 0);
    EXPECT(hol_version_number() >= HOL_VERSION);
    EXPECT(strcmp(hol_status_name(HOL_ERR_DEGENERATE), "HOL_ERR_DEGENERATE") == 0);
    EXPECT(hol_instruction_set()[0] != 0);
    EXPECT(hol_chains_n_atoms(chains) == 4 && hol_chains_n_molecules(chains) == 1 && hol_chains_n_bonds(chains) == 3);
    SUCCEEDS(hol_chains_offsets(chains, offsets));
    EXPECT(offsets[0] == 0 && offsets[1] == 3);
    SUCCEEDS(hol_chains_atoms(chains, 0, atoms));
    EXPECT(atoms[0] == 0 && atoms[3] == 3);
    EXPECT(hol_chains_degrees_of_freedom(chains, 3) == 6);
    EXPECT(hol_chains_memory(chains) > 0);
    SUCCEEDS(hol_chains_set_box(chains, box));
    SUCCEEDS(hol_chains_set_threads(chains, 2));
    SUCCEEDS(hol_chains_set_active(chains, active));
    SUCCEEDS(hol_chains_set_tolerance(chains, 0));
    SUCCEEDS(hol_chains_set_max_iterations(chains, 40));
    EXPECT(hol_chains_threads(chains) == 2 && hol_chains_max_iterations(chains) == 40);
    EXPECT(hol_chains_tolerance(chains) == 0 && hol_chains_length_tolerance(chains) == 1e-3);
    EXPECT(hol_chains_index_base(chains) == 0 && hol_chains_memory_limit(chains) == 0);
    EXPECT(hol_chains_bodies(chains) == HOL_BODIES_FOUND && hol_chains_checks(chains) == HOL_AT_START);
    EXPECT(hol_chains_outcomes(chains) == 0);
    SUCCEEDS(hol_chains_active(chains, is_active));
    SUCCEEDS(hol_chains_labels(chains, NULL, &label));
    SUCCEEDS(hol_chains_box_rate(chains, rate));
    EXPECT(is_active[0] == 1 && label == 0 && rate[8] == 0);
    SUCCEEDS(hol_chains_create(4, mass, &second));
    SUCCEEDS(hol_chains_set_index_base(second, 1));
    SUCCEEDS(hol_chains_add(second, 1, list, length));
    EXPECT(hol_chains_add(second, 1, list, length) == HOL_ERR_SHARED_ATOM);
    hol_error_location(&chain, &bond, &atom, &bad);
    EXPECT(atom == 2);
    hol_chains_destroy(second);
}

static void forces(const hol_chains *chains)
{
    double lambda[3], tension[3], g[12], virial[9];
    const hol_const_view r = hol_const_view_rows(hanging), f = hol_const_view_rows(weight);
    const hol_view out = hol_view_rows(g);
    SUCCEEDS(hol_forces(chains, hanging, NULL, weight, lambda, tension, g, HOL_WRITE, virial));
    NEAR(tension[0], 30);
    NEAR(tension[2], 10);
    NEAR(lambda[1], 10);
    NEAR(g[5], 10);
    NEAR(virial[8], -60);
    SUCCEEDS(hol_forces_view(chains, &r, NULL, &f, lambda, NULL, &out, HOL_ADD, NULL));
    NEAR(g[5], 20);
}

static void velocities(const hol_chains *chains)
{
    double v[12] = {0, 0, 0, 0, 0, 1, 2, 0, 1, 0, 0, 4}, lambda[3];
    const hol_const_view r = hol_const_view_rows(hanging);
    const hol_view out = hol_view_rows(v);
    SUCCEEDS(hol_project_velocities(chains, hanging, v, lambda, NULL));
    NEAR(v[5], 0);
    NEAR(v[6], 2);
    NEAR(v[11], 0);
    SUCCEEDS(hol_project_velocities_view(chains, &r, &out, NULL, NULL));
    NEAR(v[8], 0);
}

static void positions(const hol_chains *chains)
{
    double r[12], v[12] = {0}, lambda[3];
    const hol_const_view before = hol_const_view_rows(hanging), moved = hol_const_view_rows(r);
    const hol_view after = hol_view_rows(r);
    hol_report report;
    hol_worst worst;
    memcpy(r, hanging, sizeof r);
    r[3] = 0.01;
    r[10] = 0.02;
    SUCCEEDS(hol_violation(chains, r, NULL, &worst));
    EXPECT(worst.length > 1e-5 && worst.length_molecule == 0 && worst.rate == 0);
    SUCCEEDS(hol_project_positions(chains, hanging, r, v, 0.01, lambda, 0, NULL, &report));
    EXPECT(report.n_corrected == 1 && report.n_failed == 0 && report.max_error < 1e-12 && report.iterations >= 1);
    NEAR(r[3] * r[3] + r[4] * r[4] + r[5] * r[5], 1);
    SUCCEEDS(hol_project_positions_view(chains, &before, &after, NULL, 0.01, NULL, 0, NULL, &report));
    EXPECT(report.n_corrected == 0);
    SUCCEEDS(hol_violation_view(chains, &moved, NULL, &worst));
    EXPECT(worst.length < 1e-12);
}

static void metric(const hol_chains *chains)
{
    double log_det, log_det_z, energy, force[12];
    const hol_const_view r = hol_const_view_rows(hanging);
    SUCCEEDS(hol_metric(chains, hanging, 2, &log_det, &log_det_z, &energy, force, HOL_WRITE));
    NEAR(log_det, log(0.25));
    NEAR(log_det_z, log(64));
    NEAR(energy, log(0.25));
    NEAR(force[5], 0);
    SUCCEEDS(hol_metric_view(chains, &r, 0, &log_det, NULL, NULL, NULL, HOL_WRITE));
    NEAR(log_det, log(0.25));
}

static void inverse(const hol_chains *chains)
{
    static const double exact[9] = {0.75, 0.5, 0.25, 0.5, 0.5, 0.25, 0.25, 0.25, 0.25}, lambda[3] = {15, 10, 5};
    double value, row[3], band[6], matrix[9], condition, bound[3], relative;
    const hol_const_view r = hol_const_view_rows(hanging), f = hol_const_view_rows(weight);
    hol_inverse *z = NULL;
    int i;
    SUCCEEDS(hol_inverse_create(chains, 0, hanging, &z));
    EXPECT(hol_inverse_n_bonds(z) == 3);
    SUCCEEDS(hol_inverse_entry(z, HOL_UNIT_DIAGONAL, 0, 0, &value));
    NEAR(value, 3);
    SUCCEEDS(hol_inverse_row(z, HOL_PHYSICAL, 1, row));
    SUCCEEDS(hol_inverse_band(z, HOL_PHYSICAL, 1, band));
    SUCCEEDS(hol_inverse_matrix(z, HOL_PHYSICAL, matrix));
    for (i = 0; i < 9; ++i) NEAR(matrix[i], exact[i]);
    for (i = 0; i < 3; ++i) NEAR(row[i], exact[3 + i]);
    NEAR(band[1], exact[1]);
    SUCCEEDS(hol_inverse_condition(z, &condition));
    EXPECT(condition > 1);
    SUCCEEDS(hol_inverse_error_bound(z, NULL, weight, lambda, bound, &relative));
    EXPECT(relative < 1e-12);
    hol_inverse_destroy(z);
    SUCCEEDS(hol_inverse_create_view(chains, 0, &r, &z));
    SUCCEEDS(hol_inverse_error_bound_view(z, NULL, &f, lambda, bound, NULL));
    EXPECT(bound[2] < 1e-12);
    hol_inverse_destroy(z);
}

static void tridiagonal(void)
{
    const double gamma[1] = {0.5}, b[2] = {1, 0};
    double out[4], he, rigid, volume;
    SUCCEEDS(hol_tridiagonal_pivots(2, gamma, out));
    NEAR(out[1], 0.75);
    SUCCEEDS(hol_tridiagonal_log_det(2, gamma, out));
    NEAR(out[0], log(0.75));
    SUCCEEDS(hol_tridiagonal_solve(2, gamma, b, out));
    NEAR(out[1], 2 / 3.0);
    SUCCEEDS(hol_tridiagonal_inverse_entry(2, gamma, 0, 1, out));
    NEAR(out[0], 2 / 3.0);
    SUCCEEDS(hol_tridiagonal_inverse_band(2, gamma, 1, out));
    NEAR(out[2], 4 / 3.0);
    SUCCEEDS(hol_partition_function(1, NULL, &he, &rigid, &volume));
    NEAR(he + rigid + volume, 0);
}

/* The first beads of the triangle and of the star, displaced, and put back along bond vectors. */
static void along(hol_chains *both, const double *r)
{
    static const int from[6] = {0, 1, 2, 4, 5, 3}, to[6] = {1, 2, 0, 3, 3, 6};
    double b[18], moved[21], error = -1;
    int64_t molecule = -7, bond = -7;
    int k, c;
    hol_report report;
    const hol_const_view vectors = hol_const_view_rows(b);
    const hol_view positions = hol_view_rows(moved);
    for (k = 0; k < 6; ++k)
        for (c = 0; c < 3; ++c) b[3 * k + c] = r[3 * to[k] + c] - r[3 * from[k] + c];
    memcpy(moved, r, sizeof moved);
    moved[3] += 0.01;
    moved[12] += 0.01;
    SUCCEEDS(hol_project_positions_along(both, b, moved, NULL, 0.01, NULL, 0, NULL, &report));
    EXPECT(report.n_corrected == 2 && report.max_error < 1e-12);
    SUCCEEDS(hol_reference_error(both, &error, &molecule, &bond));
    EXPECT(error >= 0 && error < 1e-12 && molecule >= 0 && bond >= 0);
    SUCCEEDS(hol_project_positions_along_view(both, &vectors, &positions, NULL, 0.01, NULL, 0, NULL, NULL));
    moved[3] += 5;
    EXPECT(hol_chains_check(both, moved, HOL_BOX) == HOL_ERR_LENGTHS);
}

/* The same molecules from far off, what is left of each bond, and a status for each molecule. */
static void crude(hol_chains *both, const double *r)
{
    double moved[21], length[6], rate[6], v[21] = {0}, error = -1;
    unsigned char implied[6] = {7}, held[7] = {7};
    const double middle[3] = {0.5, 0.5, -1};
    const int64_t three = 3, site[3] = {0, 1, 2};
    int64_t bond = 7;
    hol_chains *relations;
    int status[2] = {-1, -1}, iterations[2] = {-1, -1}, k;
    hol_report report;
    const hol_const_view at = hol_const_view_rows(moved), rates = hol_const_view_rows(v);
    const hol_view positions = hol_view_rows(moved);
    memcpy(moved, r, sizeof moved);
    moved[3] += 1;
    v[12] = 3;
    SUCCEEDS(hol_residuals(both, moved, v, length, rate));
    NEAR(length[0], 3);
    NEAR(length[2], 0);
    NEAR(rate[3], 3);
    SUCCEEDS(hol_residuals_view(both, &at, &rates, NULL, rate));
    NEAR(rate[3], 3);
    SUCCEEDS(hol_chains_set_memory_limit(both, 1 << 20));
    SUCCEEDS(hol_chains_set_length_tolerance(both, 1e-3));
    SUCCEEDS(hol_chains_create(3, mass + 1, &relations));
    SUCCEEDS(hol_chains_add_linear(relations, 1, &three, site, middle, 0, NULL, NULL));
    EXPECT(hol_chains_degrees_of_freedom(relations, 3) == 6);
    hol_chains_destroy(relations);
    SUCCEEDS(hol_chains_create(3, mass + 1, &relations));
    SUCCEEDS(hol_chains_add_linear_molecules(relations, 1, 3, 0, 1, &three, site, middle, 0, NULL, NULL));
    EXPECT(hol_chains_degrees_of_freedom(relations, 3) == 6);
    hol_chains_destroy(relations);
    SUCCEEDS(hol_chains_adjustment(both, &error, &bond));
    EXPECT(error == 0 && bond == -1);
    SUCCEEDS(hol_chains_implied(both, implied));
    EXPECT(implied[0] == 0);
    SUCCEEDS(hol_chains_held_sites(both, held));
    EXPECT(held[0] == 0 && held[6] == 0);
    SUCCEEDS(hol_chains_set_outcomes(both, 1));
    SUCCEEDS(hol_impose(both, moved, &report));
    EXPECT(report.n_corrected == 1 && report.n_failed == 0 && report.iterations > 1);
    SUCCEEDS(hol_outcomes(both, status, iterations));
    EXPECT(status[0] == HOL_OK && status[1] == HOL_OK && iterations[0] == report.iterations && iterations[1] == 0);
    SUCCEEDS(hol_chains_set_outcomes(both, 0));
    SUCCEEDS(hol_residuals(both, moved, NULL, length, NULL));
    for (k = 0; k < 6; ++k) NEAR(length[k], 0);
    moved[3] += 1;
    SUCCEEDS(hol_impose_view(both, &positions, NULL));
    SUCCEEDS(hol_residuals_view(both, &at, NULL, length, NULL));
    for (k = 0; k < 6; ++k) NEAR(length[k], 0);
}

/* A set tells what it was given, and so does its copy, which is changed apart from it. */
static void given(const hol_chains *chains)
{
    const double cube[9] = {50, 0, 0, 0, 50, 0, 0, 0, 50};
    double lengths[3] = {0}, masses[4], box[9];
    int64_t pairs[6], removed[1];
    int roles[3] = {-1, -1, -1};
    hol_chains *copy = NULL;
    SUCCEEDS(hol_chains_copy(chains, &copy));
    SUCCEEDS(hol_chains_set_box(copy, cube));
    SUCCEEDS(hol_chains_set_length(copy, 1, 2));
    SUCCEEDS(hol_chains_set_bodies(copy, HOL_BODIES_GIVEN));
    SUCCEEDS(hol_chains_lengths(copy, lengths));
    EXPECT(lengths[0] == 1 && lengths[1] == 2 && lengths[2] == 1);
    SUCCEEDS(hol_chains_lengths(chains, lengths));
    EXPECT(lengths[1] == 1);
    SUCCEEDS(hol_chains_masses(copy, masses));
    EXPECT(masses[0] == 0 && masses[3] == 1);
    SUCCEEDS(hol_chains_pairs(copy, pairs));
    EXPECT(pairs[0] == 0 && pairs[1] == 1 && pairs[5] == 3);
    SUCCEEDS(hol_chains_box(copy, HOL_REFERENCE_BOX, box));
    EXPECT(box[0] == 50 && box[1] == 0 && box[8] == 50);
    SUCCEEDS(hol_chains_roles(copy, roles, removed));
    EXPECT(roles[0] == HOL_ROLE_OWN && removed[0] == 3);
    hol_chains_destroy(copy);
}

/* Three beads hang from a fixed one, with factors that are kept. */
static void kept(const hol_chains *chains)
{
    const double rhs[6] = {4, 0, 0, 0, 0, 4};
    double tension[3], g[12], lambda[6], forces[24], one[3];
    const hol_const_view r = hol_const_view_rows(hanging), f = hol_const_view_rows(weight);
    hol_view out = hol_view_rows(g), each[2];
    hol_factors *factors = NULL;
    each[0] = hol_view_rows(forces);
    each[1] = hol_view_rows(forces + 12);
    SUCCEEDS(hol_factors_create(chains, &factors));
    EXPECT(hol_factors_forces(factors, NULL, weight, NULL, tension, g, HOL_WRITE, NULL) == HOL_ERR_STATE);
    SUCCEEDS(hol_factors_update(factors, hanging));
    SUCCEEDS(hol_factors_forces(factors, NULL, weight, NULL, tension, g, HOL_WRITE, NULL));
    NEAR(tension[0], 30);
    SUCCEEDS(hol_factors_update_view(factors, &r));
    SUCCEEDS(hol_factors_forces_view(factors, NULL, &f, NULL, NULL, &out, HOL_ADD, NULL));
    NEAR(g[5], 20);
    SUCCEEDS(hol_factors_solve(factors, 2, rhs, lambda, NULL, HOL_WRITE, NULL));
    SUCCEEDS(hol_solve(chains, hanging, rhs + 3, one, NULL, HOL_WRITE, NULL));
    NEAR(lambda[4], one[1]);
    SUCCEEDS(hol_factors_solve_view(factors, 2, rhs, NULL, each, HOL_WRITE, NULL));
    hol_factors_destroy(factors);
    EXPECT(hol_error_remember(HOL_ERR_VALUE, "mine") == HOL_ERR_VALUE && strcmp(hol_error_message(), "mine") == 0);
}

/* A plan for an accelerator. */
static void plan(const hol_chains *chains)
{
    const void *data = NULL;
    const char *positions = NULL, *velocities = NULL;
    int64_t bytes = 0, n_groups = 0, group_size = 0, left = 7;
    hol_device_plan *made = NULL;
    SUCCEEDS(hol_device_plan_create(chains, HOL_DEVICE_DOUBLE, -1, &made));
    EXPECT(strstr(hol_device_plan_source(made), "hol_positions_0") != NULL);
    SUCCEEDS(hol_device_plan_array(made, HOL_DEVICE_FAILURES, &data, &bytes));
    EXPECT(bytes == 8 && ((const int32_t *)data)[0] == 0);
    EXPECT(hol_device_plan_n_launches(made) == 1);
    SUCCEEDS(hol_device_plan_launch(made, 0, &positions, &velocities, &n_groups, &group_size));
    EXPECT(strcmp(positions, "hol_positions_0") == 0 && strcmp(velocities, "hol_velocities_0") == 0);
    EXPECT(n_groups == 1 && group_size == 64);
    EXPECT(hol_device_plan_n_left(made) == 0);
    SUCCEEDS(hol_device_plan_left(made, &left));
    EXPECT(left == 7);
    hol_device_plan_destroy(made);
}

/* Two rods of two atoms, and one that hangs at a fixed atom. */
static void bodies(void)
{
    const double masses[7] = {1, 1, 1, 1, 1, 1, INFINITY}, rod[6] = {0, 0, 0, 1, 0, 0}, one = 1;
    const int64_t two = 2, within[2] = {0, 1}, last[2] = {4, 5}, bond[2] = {6, 4};
    const double r[21] = {0, 5, 0, 1, 5, 0, 0, 9, 0, 1, 9, 0, 1, 0, 0, 2, 0, 0, 0, 0, 0};
    const double f[21] = {2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 4, 0, 0, 0, 0, 0};
    double tension, g[21];
    hol_chains *rods = NULL;
    SUCCEEDS(hol_chains_create(7, masses, &rods));
    SUCCEEDS(hol_chains_add_rigid_molecules(rods, 2, 2, 0, 1, &two, within, rod, 0, NULL, NULL));
    SUCCEEDS(hol_chains_add_rigid(rods, 1, &two, last, rod, 1, bond, &one));
    EXPECT(hol_chains_n_of_shape(rods, HOL_SHAPE_RIGID) == 3);
    SUCCEEDS(hol_forces(rods, r, NULL, f, NULL, &tension, g, HOL_WRITE, NULL));
    NEAR(g[0], -1);
    NEAR(g[3], 1);
    NEAR(tension, 7);
    hol_chains_destroy(rods);
    const int64_t image[3] = {0, 0, 1};
    int64_t told[3];
    SUCCEEDS(hol_chains_create(2, masses, &rods));
    SUCCEEDS(hol_chains_add_bonds_with_images(rods, 1, within, &one, image));
    SUCCEEDS(hol_chains_set_images(rods, image));
    SUCCEEDS(hol_chains_images(rods, told));
    EXPECT(told[0] == 0 && told[2] == 1);
    hol_chains_destroy(rods);
    const double inertia[9] = {0, 0, 0, 0, 2, 0, 0, 0, 2};
    double masses_of_points[4], places[12];
    int64_t n_points;
    SUCCEEDS(hol_equimomental_points(2, NULL, inertia, &n_points, masses_of_points, places));
    EXPECT(n_points == 2);
    NEAR(fabs(places[0]), 1);
}

/* A rigid triangle and three beads on one, all of mass 1, pulled apart. */
static void molecules(void)
{
    const int64_t triangle[6] = {0, 1, 1, 2, 2, 0}, star[6] = {4, 3, 5, 3, 3, 6};
    const double masses[7] = {1, 1, 1, 1, 1, 1, 1}, ones[6] = {1, 1, 1, 1, 1, 1}, h = sqrt(0.75),
                 box[9] = {9, 0, 0, 0, 9};
    const double r[21] = {0, 0, 0, 1, 0, 0, 0.5, h, 0, 5, 5, 5, 6, 5, 5, 5, 6, 5, 5, 5, 6};
    const double rhs[6] = {4, 4, 4, 4, 4, 4};
    const hol_const_view view = hol_const_view_rows(r);
    double lambda[6] = {0}, g[21];
    const hol_view out = hol_view_rows(g);
    int64_t n_atoms = 0, n_bonds = 0, bonds[3] = {0}, of_bonds[6] = {0};
    int shape = -1;
    hol_chains *both = NULL;
    SUCCEEDS(hol_chains_create(7, masses, &both));
    SUCCEEDS(hol_chains_add_molecules(both, 1, 3, 0, 3, triangle, ones));
    SUCCEEDS(hol_chains_add_bonds(both, 3, star, ones));
    SUCCEEDS(hol_chains_set_lengths(both, ones));
    SUCCEEDS(hol_chains_set_masses(both, masses));
    SUCCEEDS(hol_chains_set_reference_box(both, box));
    SUCCEEDS(hol_chains_set_reference_box(both, NULL));
    SUCCEEDS(hol_chains_molecule(both, 1, &shape, &n_atoms, &n_bonds));
    EXPECT(shape == HOL_SHAPE_TREE && n_atoms == 4 && n_bonds == 3);
    SUCCEEDS(hol_chains_bonds(both, 0, bonds));
    EXPECT(bonds[0] == 0 && bonds[1] == 2 && bonds[2] == 1);
    SUCCEEDS(hol_chains_molecules_of_bonds(both, of_bonds));
    EXPECT(of_bonds[2] == 0 && of_bonds[3] == 1);
    EXPECT(hol_chains_n_of_shape(both, HOL_SHAPE_TRIANGLE) == 1 && hol_chains_n_kinds(both) == 2);
    SUCCEEDS(hol_solve(both, r, rhs, lambda, g, HOL_WRITE, NULL));
    NEAR(lambda[0], 1 / 3.0); /* Z is 8 on its diagonal and 2 beside it */
    NEAR(lambda[4], 0.5);     /* 8 and 0 */
    NEAR(g[3 * 4], -1);
    SUCCEEDS(hol_solve_view(both, &view, rhs, NULL, &out, HOL_ADD, NULL));
    NEAR(g[3 * 4], -2);
    /* A triangle that grows: velocities against it, which the rate of the box makes up for. */
    const double L[9] = {0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5};
    const int64_t labels[7] = {10, 20, 30, 40, 50, 60, 70};
    double v[21], tension[6], virials[36], virial[9];
    for (int i = 0; i < 21; ++i) v[i] = -0.5 * (r[i] - r[9 + i % 3] * (i >= 9));
    SUCCEEDS(hol_chains_set_box_rate(both, L));
    SUCCEEDS(hol_chains_set_labels(both, labels, NULL));
    SUCCEEDS(hol_project_velocities(both, r, v, lambda, NULL));
    NEAR(lambda[1], 0);
    NEAR(v[3], -0.5);
    SUCCEEDS(hol_chains_set_box_rate(both, NULL));
    SUCCEEDS(hol_reactions(both, r, HOL_BOX, rhs, tension, g, HOL_WRITE, virials, virial));
    NEAR(tension[0], 8);
    NEAR(g[3 * 4], -8);
    NEAR(virials[0], -8);
    NEAR(virial[0] + virial[4] + virial[8], -48);
    SUCCEEDS(hol_reactions_view(both, &view, HOL_REFERENCE_BOX, rhs, NULL, &out, HOL_ADD, NULL, NULL));
    NEAR(g[3 * 4], -16);
    v[4] = INFINITY;
    EXPECT(hol_project_velocities(both, r, v, NULL, NULL) == HOL_ERR_NOT_FINITE);
    EXPECT(strstr(hol_error_message(), "label 20") != NULL);
    v[4] = 0;
    SUCCEEDS(hol_chains_set_checks(both, HOL_AT_START));
    SUCCEEDS(hol_chains_check(both, r, HOL_BOX));
    SUCCEEDS(hol_chains_check_view(both, &view, HOL_REFERENCE_BOX));
    along(both, r);
    crude(both, r);
    hol_chains_destroy(both);
}

int main(void)
{
    hol_chains *chains = NULL;
    SUCCEEDS(hol_chains_create(4, mass, &chains));
    SUCCEEDS(hol_chains_add_block(chains, 1, 3, 0, length));
    handles(chains);
    given(chains);
    kept(chains);
    plan(chains);
    forces(chains);
    velocities(chains);
    positions(chains);
    metric(chains);
    inverse(chains);
    tridiagonal();
    molecules();
    bodies();
    hol_chains_destroy(chains);
    if (failures == 0)
        printf("compiled for %d.%d, runs with %s\n", HOL_VERSION_MAJOR, HOL_VERSION_MINOR, hol_version());
    return failures != 0;
}
