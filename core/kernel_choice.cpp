// Which kernels run. All but those of `baseline` fuse multiplication and addition, and give the same bits for a chain
// that fits into a lane (tests/lanes/same_bits.sh), so that a call may choose by what it has to do. A chain that comes
// alone takes one lane (`scalar`; docs/performance.md), from two on they are faster side by side. Four lanes with the
// 32 registers of AVX-512 (`avx512vl`) run wherever they can: beside avx2 they were faster or as fast. Eight lanes were
// slower on AMD's family 25 in all scenes but one, and are no set any more (docs/development/trials.md). On 64-bit Arm
// there is one set, `neon`, beside `scalar`.
//
// ns per bond: lambda and G from r, v, f / velocities / positions; equal masses, packed arrays, one thread, AMD family
// 25 (Zen 4).
//
//     chains x bonds             avx2                avx512vl
//          1 x 12             31.0 31.0 39.9      29.9 26.8 39.5
//          1 x 200            15.7 15.6 24.3      15.4 14.4 24.8
//        256 x 32  (L2)        4.1  4.3  6.4       3.6  4.0  6.2
//       1000 x 100 (L3)        5.4  5.5  8.0       4.6  5.4  7.8
//     10,000 x 100 (memory)    7.5  6.4 10.0       7.5  6.4 10.7
//    100,000 x 3   (memory)    5.7  4.9  9.1       5.9  4.5  9.2
//          1 x 100,000         4.4  8.0 10.3       4.1  7.0 10.0
//          1 x 1,000,000      12.9 28.4 19.5      12.8 26.2 19.6
//
// Smallest of several, in turns in one process.
#include "core/kernel_choice.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>

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

struct KernelSets {
    const Kernels *best = nullptr, *one_lane = nullptr;  // the latter has chains that fit into lanes alone
    const Kernels *forced = nullptr;
    const char *const wanted = std::getenv("HOLONOMIC_ISA");

    KernelSets() {
#if defined(__x86_64__) || defined(__i386__)
        __builtin_cpu_init();  // the library may be called before the compiler's own constructor has run
#endif
#define HOLONOMIC_CONSIDER(isa, runs_here) \
    if (runs_here) consider(isa::kernels, true);
        HOLONOMIC_KERNEL_SETS(HOLONOMIC_CONSIDER)
#undef HOLONOMIC_CONSIDER
#define HOLONOMIC_CONSIDER(isa, runs_here) \
    if (runs_here) consider(isa::kernels, false);
        HOLONOMIC_TEST_SETS(HOLONOMIC_CONSIDER)
#undef HOLONOMIC_CONSIDER
        if (forced && forced != one_lane) {
            best = forced;
            one_lane = nullptr;
        }
        if (one_lane && best && best->fused != one_lane->fused) one_lane = nullptr;  // other bits
    }

    void consider(const Kernels &set, bool installed) {
        if (wanted && std::strcmp(wanted, set.name) == 0) forced = &set;
        if (installed && !best && set.long_forces.blocks) best = &set;
        if (installed && std::strcmp(set.name, "scalar") == 0) one_lane = &set;
    }
};

}  // namespace

KernelChoice choose_kernels() {
    const KernelSets sets;
    if (!sets.best) {  // only where the baseline was left out: no call can have a result
        std::fputs("holonomic: built without the baseline, and no other kernels of it run on this processor\n", stderr);
        std::abort();
    }
    const Kernels &one_chain = sets.one_lane ? *sets.one_lane : *sets.best;
    return {*sets.best, sets.forced ? one_chain : *sets.best, one_chain};  // one lane forced has all that it can
}

const char *name_of_kernels() { return kernel_choice().chains.name; }

int64_t scratch_bytes(int64_t n_bonds) {
    const Kernels &widest = kernels();
    return n_bonds > longest_lane ? widest.cut_bytes : widest.scratch_bytes(n_bonds);
}

}  // namespace holonomic
