/*
 * Rigid bonds on a GPU, by OpenCL: waters, chains and a molecule of 361 atoms fly freely, and their bonds are kept on
 * the device. Three molecules of CO2, which are rigid bodies, are left to the host. The same steps are made by the host
 * alone, and compared.
 *
 *     steps [single|mixed|double]
 *
 * What is of the library: hol_device_plan_* in make_device() and constrain(). All else is what a program on a GPU has
 * already: arrays of positions and velocities, and a kernel that moves them.
 */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <holonomic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WATERS = 500, CHAINS = 100, BEADS = 12, TREE = 361, CO2 = 3, STEPS = 50 };
enum { ATOMS = 3 * WATERS + BEADS * CHAINS + TREE + 3 * CO2, BONDS = ATOMS - CHAINS - 1 };
static const double dt = 0.002;

static void ok(int status)
{
    if (status == HOL_OK) return;
    fprintf(stderr, "%s: %s\n", hol_status_name(status), hol_error_message());
    exit(1);
}

static void cl(cl_int status, const char *what)
{
    if (status == CL_SUCCESS) return;
    fprintf(stderr, "%s: OpenCL's error %d\n", what, status);
    exit(1);
}

/* ------------------------------------------------------------------------------------------------ the molecules */

static double mass[ATOMS], r[ATOMS][3], v[ATOMS][3], length[BONDS];
static int64_t pair[BONDS][2];
static int n_atoms, n_bonds;

static double noise(void)
{
    static uint32_t state = 1;
    state = 1664525 * state + 1013904223;
    return state / 4294967296.0 - 0.5;
}

static void place(double m, double x, double y, double z)
{
    mass[n_atoms] = m;
    r[n_atoms][0] = x, r[n_atoms][1] = y, r[n_atoms][2] = z;
    for (int axis = 0; axis < 3; ++axis) v[n_atoms][axis] = 2 * noise();
    ++n_atoms;
}

/* A bond as long as its atoms are apart. */
static void join(int i, int j)
{
    const double d[3] = {r[j][0] - r[i][0], r[j][1] - r[i][1], r[j][2] - r[i][2]};
    pair[n_bonds][0] = i, pair[n_bonds][1] = j;
    length[n_bonds++] = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* An atom bound to another, 0.12 away in some direction; or all on a line. */
static void grow(int from, double m)
{
    double d[3] = {noise(), noise(), noise()};
    const double size = 0.12 / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    place(m, r[from][0] + size * d[0], r[from][1] + size * d[1], r[from][2] + size * d[2]);
    join(from, n_atoms - 1);
}

static hol_chains *molecules(void)
{
    hol_chains *chains;
    for (int k = 0; k < WATERS; ++k) {
        const int o = n_atoms;
        const double x = 0.3 * (k % 10), y = 0.3 * (k / 10 % 10), z = 0.3 * (k / 100);
        place(16, x, y, z), place(1, x + 0.1, y, z), place(1, x - 0.0333, y + 0.0943, z);
        join(o, o + 1), join(o, o + 2), join(o + 1, o + 2);
    }
    for (int k = 0; k < CHAINS; ++k) {
        place(14, 0.4 * (k % 10), 4 + 0.4 * (k / 10), 0);
        for (int i = 1; i < BEADS; ++i) grow(n_atoms - 1, 14);
    }
    const int first = n_atoms; /* a backbone of 120 with side chains, as proteins have */
    place(12, 0, 0, 5);
    for (int i = 1; i <= 120; ++i) grow(i == 1 ? first : n_atoms - 3, 12), grow(n_atoms - 1, 12), grow(n_atoms - 1, 1);
    for (int k = 0; k < CO2; ++k) {
        const int c = n_atoms;
        place(12, k, 0, 9), place(16, k + 0.12, 0, 9), place(16, k - 0.12, 0, 9);
        join(c, c + 1), join(c, c + 2), join(c + 1, c + 2);
    }
    ok(hol_chains_create(n_atoms, mass, &chains));
    ok(hol_chains_add_bonds(chains, n_bonds, pair[0], length));
    ok(hol_project_velocities(chains, r[0], v[0], NULL, NULL));
    return chains;
}

/* --------------------------------------------------------------------------------------------------- the device */

static size_t number; /* bytes: all arrays below are of floats or of doubles */
static cl_context context;
static cl_device_id device;
static cl_command_queue queue;
static cl_mem array[4], d_r_ref, d_r, d_v;
static cl_kernel drift, positions[4], velocities[4];
static size_t n_items[4], group[4];
static int n_launches;

static const char drift_source[] =
    "KERNEL void drift(int n, mixed dt, GLOBAL mixed* r_ref, GLOBAL mixed* r, GLOBAL const mixed* v) {\n"
    "    for (int k = GLOBAL_ID; k < n; k += GLOBAL_SIZE) { r_ref[k] = r[k]; r[k] += dt*v[k]; }\n"
    "}\n";

/* To the device or back, by way of floats if it has these. */
static void copy(cl_mem there, double *here, int to_device)
{
    float some[3 * ATOMS];
    void *const data = number == sizeof(double) ? (void *)here : (void *)some;
    if (to_device) {
        for (int k = 0; k < 3 * ATOMS; ++k) some[k] = (float)here[k];
        cl(clEnqueueWriteBuffer(queue, there, CL_TRUE, 0, number * 3 * ATOMS, data, 0, NULL, NULL), "write");
        return;
    }
    cl(clEnqueueReadBuffer(queue, there, CL_TRUE, 0, number * 3 * ATOMS, data, 0, NULL, NULL), "read");
    for (int k = 0; data == some && k < 3 * ATOMS; ++k) here[k] = some[k];
}

static void argument(cl_kernel kernel, cl_uint *next, size_t size, const void *value)
{
    cl(clSetKernelArg(kernel, (*next)++, size, value), "argument of a kernel");
}

static void real_argument(cl_kernel kernel, cl_uint *next, double value)
{
    const float some = (float)value;
    argument(kernel, next, number, number == sizeof some ? (const void *)&some : &value);
}

static cl_kernel kernel_of(cl_program program, const char *name, cl_mem *own, int n_own, int of_positions)
{
    cl_int status;
    cl_uint next = 0;
    const cl_kernel kernel = clCreateKernel(program, name, &status);
    cl(status, name);
    for (int k = 0; k < 4; ++k) argument(kernel, &next, sizeof(cl_mem), &array[k]);
    argument(kernel, &next, sizeof(cl_int), &(cl_int){1}); /* the call, which each sets anew */
    for (int k = 0; k < n_own; ++k) argument(kernel, &next, sizeof(cl_mem), &own[k]);
    if (of_positions) real_argument(kernel, &next, 1 / dt);
    return kernel;
}

/* Compiles the plan's kernels beside the program's own, and copies what they read. */
static void make_device(const hol_device_plan *plan)
{
    cl_int status;
    const char *text[2] = {hol_device_plan_source(plan), drift_source};
    cl_program program = clCreateProgramWithSource(context, 2, text, NULL, &status);
    cl(status, "source");
    status = clBuildProgram(program, 1, &device, "", NULL, NULL);
    if (status != CL_SUCCESS) {
        static char log[20000];
        clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, sizeof log - 1, log, NULL);
        fprintf(stderr, "%s\n", log);
    }
    cl(status, "compilation");
    for (int k = 0; k < 4; ++k) {
        const void *data;
        int64_t bytes;
        ok(hol_device_plan_array(plan, k, &data, &bytes));
        array[k] = clCreateBuffer(context, CL_MEM_READ_WRITE, (size_t)bytes, NULL, &status);
        cl(status, "array");
        if (data) cl(clEnqueueWriteBuffer(queue, array[k], CL_TRUE, 0, (size_t)bytes, data, 0, NULL, NULL), "write");
    }
    cl_mem *const own[3] = {&d_r_ref, &d_r, &d_v};
    for (int k = 0; k < 3; ++k) *own[k] = clCreateBuffer(context, CL_MEM_READ_WRITE, number * 3 * ATOMS, NULL, &status);
    cl(status, "array");
    for (n_launches = 0; n_launches < hol_device_plan_n_launches(plan); ++n_launches) {
        const char *for_positions, *for_velocities;
        int64_t n_groups, group_size;
        const int k = n_launches;
        ok(hol_device_plan_launch(plan, k, &for_positions, &for_velocities, &n_groups, &group_size));
        positions[k] = kernel_of(program, for_positions, (cl_mem[3]){d_r_ref, d_r, d_v}, 3, 1);
        velocities[k] = kernel_of(program, for_velocities, (cl_mem[2]){d_r, d_v}, 2, 0);
        group[k] = (size_t)group_size;
        n_items[k] = (size_t)(n_groups * group_size);
    }
    drift = clCreateKernel(program, "drift", &status);
    cl(status, "drift");
    cl_uint next = 0;
    argument(drift, &next, sizeof(cl_int), &(cl_int){3 * ATOMS});
    real_argument(drift, &next, dt);
    for (int k = 0; k < 3; ++k) argument(drift, &next, sizeof(cl_mem), own[k]);
}

static void constrain(const cl_kernel *kernels, cl_int call)
{
    for (int k = 0; k < n_launches; ++k) {
        cl(clSetKernelArg(kernels[k], 4, sizeof call, &call), "call");
        cl(clEnqueueNDRangeKernel(queue, kernels[k], 1, NULL, &n_items[k], &group[k], 0, NULL, NULL), "launch");
    }
}

/* What the device leaves: all others of the set are not active. */
static void constrain_left(const hol_chains *left)
{
    static double a_ref[ATOMS][3], a[ATOMS][3], b[ATOMS][3];
    copy(d_r_ref, a_ref[0], 0), copy(d_r, a[0], 0), copy(d_v, b[0], 0);
    ok(hol_project_positions(left, a_ref[0], a[0], b[0], dt, NULL, 0, NULL, NULL));
    ok(hol_project_velocities(left, a[0], b[0], NULL, NULL));
    copy(d_r, a[0], 1), copy(d_v, b[0], 1);
}

static void check_failures(const hol_device_plan *plan)
{
    const void *data;
    int64_t bytes;
    ok(hol_device_plan_array(plan, HOL_DEVICE_FAILURES, &data, &bytes));
    int32_t *const failed = malloc((size_t)bytes);
    if (!failed) exit(1);
    cl(clEnqueueReadBuffer(queue, array[HOL_DEVICE_FAILURES], CL_TRUE, 0, (size_t)bytes, failed, 0, NULL, NULL),
       "read");
    for (int64_t m = 0; m < bytes / 4 - 1; ++m)
        if (failed[1 + m]) printf("molecule %d could not be solved in step %d\n", (int)m, failed[1 + m]), exit(1);
    free(failed);
}

/* ----------------------------------------------------------------------------------------------------- the run */

static double worst_bond(double (*at)[3])
{
    double worst = 0;
    for (int k = 0; k < n_bonds; ++k) {
        double square = 0;
        for (int axis = 0; axis < 3; ++axis) square += pow(at[pair[k][1]][axis] - at[pair[k][0]][axis], 2);
        worst = fmax(worst, fabs(sqrt(square) / length[k] - 1));
    }
    return worst;
}

int main(int argc, char **argv)
{
    const char *const names[3] = {"single", "mixed", "double"}, *asked = argc > 1 ? argv[1] : "mixed";
    const double allowed[3] = {2e-5, 1e-13, 1e-13}; /* coordinates of 10, of whose roundings bonds of 0.1 have some */
    int precision = 0;
    while (strcmp(names[precision], asked) != 0)
        if (++precision == 3) return fprintf(stderr, "usage: steps [single|mixed|double]\n"), 2;
    cl_platform_id platform;
    if (clGetPlatformIDs(1, &platform, NULL) || clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, NULL)) {
        printf("skipped: no OpenCL device\n");
        return 77;
    }
    context = clCreateContext(NULL, 1, &device, NULL, NULL, NULL);
    queue = clCreateCommandQueue(context, device, 0, NULL);
    number = precision == HOL_DEVICE_SINGLE ? sizeof(float) : sizeof(double);

    hol_chains *const chains = molecules(), *left;
    hol_device_plan *plan;
    ok(hol_device_plan_create(chains, precision, -1, &plan));
    make_device(plan);
    unsigned char *const active = calloc((size_t)hol_chains_n_molecules(chains), 1);
    int64_t numbers[CO2];
    const int64_t n_left = hol_device_plan_n_left(plan);
    if (!active || n_left != CO2) return 1;
    ok(hol_device_plan_left(plan, numbers));
    for (int64_t k = 0; k < n_left; ++k) active[numbers[k]] = 1;
    ok(hol_chains_copy(chains, &left));
    ok(hol_chains_set_active(left, active));

    copy(d_r, r[0], 1), copy(d_v, v[0], 1);
    for (int step = 1; step <= STEPS; ++step) {
        static double r_ref[ATOMS][3];
        cl(clEnqueueNDRangeKernel(queue, drift, 1, NULL, &(size_t){4096}, NULL, 0, NULL, NULL), "drift");
        constrain(positions, step);
        constrain(velocities, step);
        constrain_left(left);
        memcpy(r_ref, r, sizeof r); /* the same on the host */
        for (int a = 0; a < ATOMS; ++a)
            for (int axis = 0; axis < 3; ++axis) r[a][axis] += dt * v[a][axis];
        ok(hol_project_positions(chains, r_ref[0], r[0], v[0], dt, NULL, 0, NULL, NULL));
        ok(hol_project_velocities(chains, r[0], v[0], NULL, NULL));
    }
    check_failures(plan);
    static double found[ATOMS][3];
    double apart = 0;
    copy(d_r, found[0], 0);
    for (int a = 0; a < ATOMS; ++a)
        for (int axis = 0; axis < 3; ++axis) apart = fmax(apart, fabs(found[a][axis] - r[a][axis]));
    printf("%s: %d launches, %d molecules left to the host\n", names[precision], n_launches, (int)n_left);
    printf("worst bond on the device %.1e, on the host %.1e; positions differ by %.1e\n", worst_bond(found),
           worst_bond(r), apart);
    hol_device_plan_destroy(plan);
    hol_chains_destroy(left);
    hol_chains_destroy(chains);
    free(active);
    return worst_bond(found) <= allowed[precision] && apart <= 100 * allowed[precision] ? 0 : 1;
}
