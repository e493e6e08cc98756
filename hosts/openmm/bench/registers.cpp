// Prints the kernels for one kind of molecules as a compiler for a GPU takes them without OpenMM: registers BONDS,
// where BONDS are pairs of atoms, 0-1 0-2 1-2.
#include <cstdio>
#include <vector>

#include "../device/Source.h"

int main(int argc, char **argv) {
    std::vector<std::int64_t> pairs;
    int nAtoms = 0;
    for (int k = 1; k < argc; ++k) {
        int i, j;
        if (std::sscanf(argv[k], "%d-%d", &i, &j) != 2) return 2;
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
        return 1;
    }
    const std::string text = OpenMM::kernelSource(OpenMM::sortedByKind(chains, 100000), 0, 1);
    hol_chains_destroy(chains);
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
