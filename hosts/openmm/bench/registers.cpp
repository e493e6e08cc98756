// Prints kernels as a compiler for a GPU takes them without OpenMM:
//     registers BONDS                         for one kind of molecules, whose bonds are pairs of atoms, 0-1 0-2 1-2
//     registers block OF_VELOCITIES MIXED REALS   for molecules that blocks of threads solve, with so many numbers in
//                                                 local memory, or 0
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "../device/Source.h"

static std::string ofKind(int argc, char **argv) {
    std::vector<std::int64_t> pairs;
    int nAtoms = 0;
    for (int k = 1; k < argc; ++k) {
        int i, j;
        if (std::sscanf(argv[k], "%d-%d", &i, &j) != 2) std::exit(2);
        for (int atom : {i, j}) {
            pairs.push_back(atom);
            nAtoms = atom + 1 > nAtoms ? atom + 1 : nAtoms;
        }
    }
    const std::vector<double> masses(nAtoms, 1.0), lengths(pairs.size() / 2, 0.1);
    hol_chains *chains = nullptr;
    if (hol_chains_create(nAtoms, masses.data(), &chains) != HOL_OK ||
        hol_chains_add_bonds(chains, static_cast<std::int64_t>(lengths.size()), pairs.data(), lengths.data()) !=
            HOL_OK) {
        std::fprintf(stderr, "%s\n", hol_error_message());
        std::exit(1);
    }
    const std::string text = OpenMM::kernelSource(OpenMM::sortedByKind(chains, 100000), 0, 1);
    hol_chains_destroy(chains);
    return text;
}

int main(int argc, char **argv) {
    const bool forBlocks = argc == 5 && std::strcmp(argv[1], "block") == 0;
    const std::string text =
        forBlocks ? OpenMM::blockSource(std::atoi(argv[2]), 64, 0, {std::atoi(argv[3]), std::atoi(argv[4])})
                  : ofKind(argc, argv);
    std::puts(R"(#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#ifdef USE_DOUBLE_PRECISION
typedef double real; typedef double3 real3; typedef double4 real4;
#else
typedef float real; typedef float3 real3; typedef float4 real4;
#endif
#if defined(USE_DOUBLE_PRECISION) || defined(USE_MIXED_PRECISION)
typedef double mixed; typedef double3 mixed3; typedef double4 mixed4;
#else
typedef float mixed; typedef float3 mixed3; typedef float4 mixed4;
#endif
#define KERNEL __attribute__((reqd_work_group_size(64, 1, 1))) __kernel
#define DEVICE inline __attribute__((always_inline))
#define GLOBAL __global
#define LOCAL __local
#define LOCAL_ARG __local
#define LOCAL_ID (int)__builtin_amdgcn_workitem_id_x()
#define LOCAL_SIZE 64
#define GROUP_ID (int)__builtin_amdgcn_workgroup_id_x()
#define NUM_GROUPS 4096
#define SYNC_THREADS __builtin_amdgcn_fence(__ATOMIC_SEQ_CST, "workgroup"); __builtin_amdgcn_s_barrier();
#define RESTRICT restrict
#define GLOBAL_ID (int)(64*__builtin_amdgcn_workgroup_id_x() + __builtin_amdgcn_workitem_id_x())
#define GLOBAL_SIZE (64*4096)
#define make_real3(x...) ((real3) (x))
#define make_mixed3(x...) ((mixed3) (x))
#define make_mixed4(x...) ((mixed4) (x))
#define trimTo3(v) (v).xyz
#define dot(a, b) product(a, b)
#define PRODUCT(type, type3) \
    inline __attribute__((always_inline, overloadable)) type product(type3 a, type3 b) { return a.x*b.x + a.y*b.y + a.z*b.z; }
PRODUCT(float, float3)
PRODUCT(double, double3)
)");
    std::puts(text.c_str());
}
