// Which kernels run. All but the baseline's fuse multiplication and addition, and give the same bits for a chain that
// fits into a lane (tests/lanes/same_bits.sh), so that a call may choose by what it has to do. A chain that comes alone
// takes one lane (`scalar`; docs/performance.md), from two on they are faster side by side. Four lanes with the 32
// registers of AVX-512 (`avx512vl`) run wherever they can: beside avx2 they were faster or as fast, and eight lanes
// (`avx512`) are faster in cache on the family that is named below.
//
// ns per bond: lambda and G from r, v, f / velocities / positions; equal masses, packed arrays, one thread.
//
//                                AMD family 25 (Zen 4)                                  AMD family 26 (Zen 5)
//     chains x bonds             avx2                avx512vl            avx512         avx2             avx512
//          1 x 12             31.0 31.0 39.9      29.9 26.8 39.5      57.4 58.2 60.2
//          1 x 200            15.7 15.6 24.3      15.4 14.4 24.8      23.9 31.1 43.6    40 to 60 % slower with avx512
//        256 x 32  (L2)        4.1  4.3  6.4       3.6  4.0  6.2       3.7  4.3  7.5     3.4  -  5.1      2.8  -  3.3
//       1000 x 100 (L3)        5.4  5.5  8.0       4.6  5.4  7.8       6.0  6.5  8.7
//     10,000 x 100 (memory)    7.5  6.4 10.0       7.5  6.4 10.7      11.3  7.5 11.8     7.2 4.6  -      11.3 8.3  -
//    100,000 x 3   (memory)    5.7  4.9  9.1       5.9  4.5  9.2       6.1  4.8  8.7
//          1 x 100,000         4.4  8.0 10.3       4.1  7.0 10.0       5.9 11.7 10.6
//          1 x 1,000,000      12.9 28.4 19.5      12.8 26.2 19.6      22.9 48.6 24.6    14.3  -  -      16.8  -  -
//
// Smallest of several, in turns in one process. Forces of 100,000 x 3 are the same within the scatter, medians 6.2, 6.4
// and 6.6. From memory eight lanes, which ask for twice as many lines at a time, are the slowest.
#include "core/run/dispatch.hpp"

#include <cstdlib>
#include <cstring>

#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#endif

#include "kernel_sets.hpp"

namespace holonomic {

#define HOLONOMIC_DECLARE(isa, runs_here) \
    namespace isa {                       \
    extern const Kernels kernels;         \
    }
HOLONOMIC_KERNEL_SETS(HOLONOMIC_DECLARE)
HOLONOMIC_TEST_SETS(HOLONOMIC_DECLARE)
#undef HOLONOMIC_DECLARE

namespace {

// 0: not one of AMD's.
unsigned amd_family() {
#if defined(__x86_64__) || defined(__i386__)
    unsigned a = 0, b = 0, c = 0, d = 0;
    if (!__get_cpuid(0, &a, &b, &c, &d) || b != signature_AMD_ebx || c != signature_AMD_ecx || d != signature_AMD_edx)
        return 0;
    if (!__get_cpuid(1, &a, &b, &c, &d)) return 0;
    const unsigned family = a >> 8 & 15;
    return family < 15 ? family : family + (a >> 20 & 255);
#else
    return 0;
#endif
}

struct Sets {
    const Kernels *best = nullptr, *eight_lanes = nullptr,
                  *one_lane = nullptr;  // the last two may be chosen by the unit
    unsigned family = 0;

    Sets() {
        const char *const wanted = std::getenv("HOLONOMIC_ISA");
        const Kernels *forced = nullptr;
        __builtin_cpu_init();
#define HOLONOMIC_CONSIDER(isa, runs_here) \
    if (runs_here) consider(isa::kernels, wanted, forced, true);
        HOLONOMIC_KERNEL_SETS(HOLONOMIC_CONSIDER)
#undef HOLONOMIC_CONSIDER
#define HOLONOMIC_CONSIDER(isa, runs_here) \
    if (runs_here) consider(isa::kernels, wanted, forced, false);
        HOLONOMIC_TEST_SETS(HOLONOMIC_CONSIDER)
#undef HOLONOMIC_CONSIDER
        if (forced) {
            best = forced;
            eight_lanes = one_lane = nullptr;
        }
        if (best->lanes < 4) one_lane = nullptr;  // the baseline rounds products: other bits
        family = amd_family();
    }

    void consider(const Kernels &set, const char *wanted, const Kernels *&forced, bool installed) {
        if (wanted && std::strcmp(wanted, set.name) == 0) forced = &set;
        if (installed && !best) best = &set;
        if (installed && std::strcmp(set.name, "avx512") == 0) eight_lanes = &set;
        if (installed && std::strcmp(set.name, "scalar") == 0) one_lane = &set;
    }
};

const Sets &sets() {
    static const Sets found;
    return found;
}

}  // namespace

bool eight_lanes_pay(unsigned amd_family, const Unit &unit) {
    return amd_family == 26 && !unit.large && unit.count >= 8;
}

const Kernels &kernels() { return *sets().best; }

const Kernels &kernels_for_one_chain() {
    const Sets &s = sets();
    return s.one_lane ? *s.one_lane : *s.best;
}

const Kernels &kernels(const Unit &unit) {
    const Sets &s = sets();
    if (unit.count == 1) return kernels_for_one_chain();
    return s.eight_lanes && eight_lanes_pay(s.family, unit) ? *s.eight_lanes : *s.best;
}

int64_t scratch_bytes(int64_t n_bonds) {
    const Sets &s = sets();
    const Kernels *const widest = s.eight_lanes ? s.eight_lanes : s.best;
    return n_bonds > longest_lane ? widest->piece_bytes : widest->scratch_bytes(n_bonds);
}

}  // namespace holonomic
