// The recursion Omega_n^2 = 1 - gamma_n^2 / Omega_{n-1}^2 as printed (Mazars 2007, Eq. 17), used the way a careful
// reader would: Z~^-1 = C C^t is never formed but applied, O(N). It subtracts nearly equal numbers where chains are
// straight.
#include <cmath>
#include <memory>

#include "methods.hpp"

namespace bench {

Solver omega_recursion() {
    struct Workspace {
        std::vector<double> gamma, omega2, scale;
    };
    auto a = std::make_shared<Workspace>();
    return [a](System &s) {
        const std::size_t n = s.diagonal.size();
        a->gamma.resize(n);
        a->omega2.resize(n);
        a->scale.resize(n);
        a->omega2[0] = 1;
        a->scale[0] = 1 / std::sqrt(s.diagonal[0]);
        s.x[0] *= a->scale[0];
        for (std::size_t k = 1; k < n; ++k) {
            a->scale[k] = 1 / std::sqrt(s.diagonal[k]);
            const double gamma = -s.beside[k - 1] * a->scale[k - 1] * a->scale[k];
            const double multiplier = gamma / a->omega2[k - 1];
            a->gamma[k] = gamma;
            a->omega2[k] = 1 - gamma * gamma / a->omega2[k - 1];
            s.x[k] = s.x[k] * a->scale[k] + multiplier * s.x[k - 1];
        }
        double after = s.x[n - 1] / a->omega2[n - 1];
        s.x[n - 1] = after * a->scale[n - 1];
        for (std::size_t k = n - 1; k-- > 0;) {
            after = (s.x[k] + a->gamma[k + 1] * after) / a->omega2[k];
            s.x[k] = after * a->scale[k];
        }
    };
}

LogDeterminant omega_recursion_log_det() {
    return [](System &s) {  // Eq. (19)
        double omega2 = 1, sum = 0;
        for (std::size_t k = 1; k < s.diagonal.size(); ++k) {
            omega2 = 1 - s.beside[k - 1] * s.beside[k - 1] / omega2;
            sum += std::log(omega2);
        }
        return sum;
    };
}

}  // namespace bench
