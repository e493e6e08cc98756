#include "core/device/source.hpp"

namespace holonomic::device {

namespace {

// Types and words by which kernels are written alike for all three. CUDA's vectors have no operators, so that it and
// HIP get three numbers of our own.
const char languages[] = R"(
#ifdef HOL_IN_DOUBLE
#define HOL_REAL double
#else
#define HOL_REAL float
#endif
#ifdef HOL_IN_SINGLE
#define HOL_MIXED_REAL float
#define HOL_ROUNDING 1.2e-7f
#else
#define HOL_MIXED_REAL double
#define HOL_ROUNDING ((mixed) 2.2e-16)
#endif
#define HOL_VECTOR2(type) type##3
#define HOL_VECTOR(type) HOL_VECTOR2(type)

#ifdef KERNEL
/* The program has all these words already. */
#elif defined(__OPENCL_VERSION__) || defined(__OPENCL_C_VERSION__)
#if !defined(HOL_IN_SINGLE) && defined(cl_khr_fp64)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif
#define KERNEL __kernel
#define DEVICE
#define GLOBAL __global
#define LOCAL __local
#define LOCAL_ARG __local
#define RESTRICT restrict
#define LOCAL_ID ((int) get_local_id(0))
#define LOCAL_SIZE ((int) get_local_size(0))
#define GROUP_ID ((int) get_group_id(0))
#define NUM_GROUPS ((int) get_num_groups(0))
#define GLOBAL_ID ((int) get_global_id(0))
#define GLOBAL_SIZE ((int) get_global_size(0))
#define SYNC_THREADS barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)
typedef HOL_REAL real;
typedef HOL_MIXED_REAL mixed;
typedef HOL_VECTOR(HOL_REAL) real3;
typedef HOL_VECTOR(HOL_MIXED_REAL) mixed3;
#define make_real3(x, y, z) ((real3) (x, y, z))
#define make_mixed3(x, y, z) ((mixed3) (x, y, z))
#else /* CUDA, HIP */
#define KERNEL extern "C" __global__
#define DEVICE static inline __device__
#define GLOBAL
#define LOCAL __shared__
#define LOCAL_ARG
#define RESTRICT __restrict__
#define LOCAL_ID ((int) threadIdx.x)
#define LOCAL_SIZE ((int) blockDim.x)
#define GROUP_ID ((int) blockIdx.x)
#define NUM_GROUPS ((int) gridDim.x)
#define GLOBAL_ID ((int) (blockIdx.x*blockDim.x + threadIdx.x))
#define GLOBAL_SIZE ((int) (gridDim.x*blockDim.x))
#define SYNC_THREADS __syncthreads()
typedef HOL_REAL real;
typedef HOL_MIXED_REAL mixed;
template <class T> struct hol_vector {
    T x, y, z;
    __device__ hol_vector& operator+=(hol_vector b) { x += b.x; y += b.y; z += b.z; return *this; }
    __device__ hol_vector& operator-=(hol_vector b) { x -= b.x; y -= b.y; z -= b.z; return *this; }
};
template <class T> DEVICE hol_vector<T> operator+(hol_vector<T> a, hol_vector<T> b) { return a += b; }
template <class T> DEVICE hol_vector<T> operator-(hol_vector<T> a, hol_vector<T> b) { return a -= b; }
template <class T> DEVICE hol_vector<T> operator*(T s, hol_vector<T> a) { a.x *= s; a.y *= s; a.z *= s; return a; }
template <class T> DEVICE T dot(hol_vector<T> a, hol_vector<T> b) { return a.x*b.x + a.y*b.y + a.z*b.z; }
typedef hol_vector<real> real3;
typedef hol_vector<mixed> mixed3;
DEVICE real3 make_real3(real x, real y, real z) { real3 v = {x, y, z}; return v; }
DEVICE mixed3 make_mixed3(mixed x, mixed y, mixed z) { mixed3 v = {x, y, z}; return v; }
#endif
)";

// What a program may define itself, so that the kernels read and write its own arrays. As it stands they are
// [n_atoms][3], as in hol_project_positions and hol_project_velocities. To positions differences are added, so that
// atoms that are held keep their bits.
const char arrays[] = R"(
DEVICE mixed3 hol_load(GLOBAL const mixed* from, int a) { return make_mixed3(from[3*a], from[3*a+1], from[3*a+2]); }
DEVICE void hol_store(GLOBAL mixed* to, int a, mixed3 v) { to[3*a] = v.x; to[3*a+1] = v.y; to[3*a+2] = v.z; }
DEVICE void hol_add(GLOBAL mixed* to, int a, mixed3 v) { to[3*a] += v.x; to[3*a+1] += v.y; to[3*a+2] += v.z; }
#ifndef HOL_POSITION_ARRAYS
#define HOL_POSITION_ARRAYS GLOBAL const mixed* RESTRICT r_ref, GLOBAL mixed* RESTRICT r, GLOBAL mixed* RESTRICT v, \
    mixed inverse_dt
#endif
#ifndef HOL_VELOCITY_ARRAYS
#define HOL_VELOCITY_ARRAYS GLOBAL const mixed* RESTRICT r_ref, GLOBAL mixed* RESTRICT v
#endif
#ifndef HOL_POSITION
#define HOL_POSITION(a) hol_load(r_ref, a)
#endif
#ifndef HOL_STATE
#define HOL_STATE mixed3
#endif
#ifndef HOL_DISPLACEMENT
#define HOL_DISPLACEMENT(a) (hol_load(r, a) - hol_load(r_ref, a))
#endif
#ifndef HOL_DISPLACE
#define HOL_DISPLACE(a, before, after) \
    { hol_add(r, a, after - before); if (inverse_dt != 0) hol_add(v, a, inverse_dt*(after - before)); }
#endif
#ifndef HOL_VELOCITY
#define HOL_VELOCITY(a) hol_load(v, a)
#endif
#ifndef HOL_SET_VELOCITY
#define HOL_SET_VELOCITY(a, before, after) hol_store(v, a, after)
#endif
#ifndef HOL_IMAGE
#define HOL_IMAGE(d) (d)
#endif
)";

// `failures` keeps for each molecule the call that it failed in first; nothing depends on which work-item comes first.
// Errors are squares, of what is left `before` a step and after it. Nobody needs to look at what the next step leaves
// if this one has left 3e-6 of it, and 3e4 roundings at the most: the rate of an iteration does not grow.
const char common[] = R"(
#define HOL_PLAN GLOBAL const int* RESTRICT integers, GLOBAL const mixed* RESTRICT numbers, \
    GLOBAL mixed* RESTRICT scratch, GLOBAL int* RESTRICT failures, int call
#define HOL_FAILED(molecule) if (failures[1 + (molecule)] == 0) { failures[1 + (molecule)] = call; failures[0] = 1; }
#define HOL_ROUNDED(v) make_real3((real) (v).x, (real) (v).y, (real) (v).z)
#define HOL_MOST_PASSES 25
#define HOL_NEXT_IS_LAST(limit) (1e11f*error <= before && error <= 1e9f*(limit))
)";

const char *name(Precision precision) {
    return precision == Precision::single  ? "HOL_IN_SINGLE"
           : precision == Precision::mixed ? "HOL_IN_MIXED"
                                           : "HOL_IN_DOUBLE";
}

}  // namespace

std::string prologue(Precision precision) {
    return std::string("#define ") + name(precision) + languages + arrays + common + "#define HOL_WIDTH " +
           std::to_string(batch_width) + "\n";
}

}  // namespace holonomic::device
