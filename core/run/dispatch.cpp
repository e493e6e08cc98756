#include "core/run/dispatch.hpp"

#include <cstdlib>
#include <cstring>

namespace holonomic {

namespace baseline {
extern const Kernels kernels;
}
#ifdef HOLONOMIC_HAVE_AVX2
namespace avx2 {
extern const Kernels kernels;
}
#endif
#ifdef HOLONOMIC_HAVE_AVX512
namespace avx512 {
extern const Kernels kernels;
}
#endif

namespace {

const Kernels &choose() {
    const Kernels *available[3];
    int n = 0;
#ifdef HOLONOMIC_HAVE_AVX512
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("fma"))
        available[n++] = &avx512::kernels;
#endif
#ifdef HOLONOMIC_HAVE_AVX2
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) available[n++] = &avx2::kernels;
#endif
    available[n++] = &baseline::kernels;
    const char *wanted = std::getenv("HOLONOMIC_ISA");
    for (int i = 0; wanted && i < n; ++i)
        if (std::strcmp(wanted, available[i]->name) == 0) return *available[i];
    return *available[0];
}

}  // namespace

const Kernels &kernels() {
    static const Kernels &chosen = choose();
    return chosen;
}

}  // namespace holonomic
