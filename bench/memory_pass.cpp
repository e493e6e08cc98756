#include "memory_pass.hpp"

#include <cstddef>

namespace bench {

void memory_pass(const std::vector<double> &r, const std::vector<double> &v, const std::vector<double> &f,
                 std::vector<double> &g, int threads) {
    const std::size_t n = r.size();
    const double *__restrict__ a = r.data(), *__restrict__ b = v.data(), *__restrict__ c = f.data();
    double *__restrict__ sum = g.data();
    if (threads == 1) {  // without the cost of a parallel region, as a program would write it
        for (std::size_t i = 0; i < n; ++i) sum[i] = a[i] + b[i] * c[i];
        return;
    }
#pragma omp parallel for num_threads(threads) schedule(static)
    for (std::size_t i = 0; i < n; ++i) sum[i] = a[i] + b[i] * c[i];
}

}  // namespace bench
