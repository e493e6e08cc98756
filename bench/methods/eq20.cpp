// Eq. (20) of Mazars 2007 taken literally: every element of the inverse is formed and multiplied with the right side,
// O(N^2) per chain. The factors of Eqs. (9) and (24) are the right ones (Z_kk = 4 ..), as in tridiagonal_system.hpp.
#include <cmath>
#include <memory>

#include "methods.hpp"

namespace bench {

Solver eq20() {
    struct Workspace {
        std::vector<double> gamma, omega2, tail, right;
    };
    auto a = std::make_shared<Workspace>();
    return [a](System &s) {
        const std::size_t n = s.diagonal.size();
        a->gamma.assign(n, 0);
        a->omega2.assign(n, 1);
        a->tail.assign(n, 1);
        a->right.resize(n);
        for (std::size_t k = 0; k < n; ++k) {  // Z~ = D Z D, Eqs. (25)-(27), and Eq. (17)
            a->right[k] = s.x[k] / std::sqrt(s.diagonal[k]);
            if (k == 0) continue;
            a->gamma[k] = -s.beside[k - 1] / std::sqrt(s.diagonal[k - 1] * s.diagonal[k]);
            a->omega2[k] = 1 - a->gamma[k] * a->gamma[k] / a->omega2[k - 1];
        }
        // The bracket of Eq. (20): 1 + sum over p of the products of 1/Omega_m^2 - 1 from j+1 to p.
        for (std::size_t j = n - 1; j-- > 0;) a->tail[j] = 1 + (1 / a->omega2[j + 1] - 1) * a->tail[j + 1];
        for (std::size_t i = 0; i < n; ++i) s.x[i] = 0;
        for (std::size_t i = 0; i < n; ++i) {
            double product = 1 / a->omega2[i];
            s.x[i] += product * a->tail[i] * a->right[i];
            for (std::size_t j = i + 1; j < n; ++j) {
                product *= a->gamma[j] / a->omega2[j];
                const double element = product * a->tail[j];
                s.x[i] += element * a->right[j];
                s.x[j] += element * a->right[i];
            }
        }
        for (std::size_t k = 0; k < n; ++k) s.x[k] /= std::sqrt(s.diagonal[k]);
    };
}

}  // namespace bench
