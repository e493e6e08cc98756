#include "core/run/dispatch.hpp"

#include <cstdlib>
#include <cstring>

#include "kernel_sets.hpp"

namespace holonomic {

#define HOLONOMIC_DECLARE(isa, runs_here, tests_only) \
    namespace isa {                                   \
    extern const Kernels kernels;                     \
    }
HOLONOMIC_KERNEL_SETS(HOLONOMIC_DECLARE)
#undef HOLONOMIC_DECLARE

namespace {

const Kernels &choose() {
    const char *const wanted = std::getenv("HOLONOMIC_ISA");
    const Kernels *best = nullptr;
#define HOLONOMIC_CONSIDER(isa, runs_here, tests_only)                                  \
    if (runs_here) {                                                                    \
        if (wanted && std::strcmp(wanted, isa::kernels.name) == 0) return isa::kernels; \
        if (!best && !(tests_only)) best = &isa::kernels;                               \
    }
    HOLONOMIC_KERNEL_SETS(HOLONOMIC_CONSIDER)
#undef HOLONOMIC_CONSIDER
    return *best;
}

}  // namespace

const Kernels &kernels() {
    static const Kernels &chosen = choose();
    return chosen;
}

}  // namespace holonomic
