#include "memory_pass.hpp"

#include <algorithm>
#include <cstddef>

#include "stopwatch.hpp"

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

double memory_pass_seconds(std::size_t numbers) {
    const std::vector<double> r(numbers, 1), v(r), f(r);
    std::vector<double> g(numbers), times;
    const int passes = numbers > 1000000 ? 20 : 200;
    for (int i = 0; i < passes; ++i) {
        const Stopwatch watch(1);
        memory_pass(r, v, f, g, 1);
        times.push_back(watch.seconds());
    }
    std::nth_element(times.begin(), times.begin() + passes / 2, times.end());
    return times[static_cast<std::size_t>(passes / 2)];
}

}  // namespace bench
