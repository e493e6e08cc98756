#include "core/partition/partition.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "core/error.hpp"
#include "core/partition/partition_operator.hpp"

namespace holonomic {

namespace {

// Share of a neighbour's mass: m / (m + middle), middle finite.
long double share(long double m, long double middle) { return std::isinf(m) ? 1 : m / (m + middle); }

std::vector<long double> checked(std::int64_t n_bonds, const double *masses) {
    std::vector<long double> m(static_cast<std::size_t>(n_bonds) + 1, 1);
    if (!masses) return m;
    for (std::size_t i = 0; i < m.size(); ++i) {
        if (!(masses[i] >= 0)) {
            Error error =
                make_error(Status::value, "the mass of atom %lld (counted from 0) is %g; it must not be negative",
                           static_cast<long long>(i), masses[i]);
            error.atom = static_cast<std::int64_t>(i);
            throw error;
        }
        m[i] = masses[i] == 0 ? std::numeric_limits<long double>::infinity() : static_cast<long double>(masses[i]);
        if (i > 0 && std::isinf(m[i]) && std::isinf(m[i - 1])) {
            Error error = make_error(Status::degenerate, "bond %lld (counted from 0) joins two fixed atoms",
                                     static_cast<long long>(i) - 1);
            error.bond = static_cast<std::int64_t>(i) - 1;
            throw error;
        }
    }
    return m;
}

}  // namespace

Partition partition_function(std::int64_t n_bonds, const double *masses, const PartitionAsked &asked) {
    if (n_bonds < 1 || n_bonds > std::numeric_limits<std::int64_t>::max() / 64)
        throw make_error(Status::value, "n_bonds is %lld; it must be at least 1", static_cast<long long>(n_bonds));
    const std::vector<long double> m = checked(n_bonds, masses);
    const std::size_t last = m.size() - 1;
    Partition result{0, 0, 0};
    if (asked.means) {
        long double he = 0, rigid = 0;
        std::size_t first = 0;
        for (std::size_t i = 1; i <= last; ++i) {  // a fixed atom inside makes the parts on its sides independent
            if (i < last && !std::isinf(m[i])) continue;
            const PivotMeans means = pivot_means(m.data() + first, i - first);
            he += means.log_inverse_root;
            rigid += means.log_root;
            first = i;
        }
        result.he = static_cast<double>(he);
        result.rigid = static_cast<double>(rigid);
    }
    if (asked.volume) {
        long double sum = 0;
        for (std::size_t n = 2; n <= last; ++n) {
            if (std::isinf(m[n - 1])) {
                sum = -std::numeric_limits<long double>::infinity();
                break;
            }
            sum += (std::log(share(m[n], m[n - 1])) + std::log(share(m[n - 2], m[n - 1]))) / 2;
        }
        result.volume = static_cast<double>(sum);
    }
    return result;
}

}  // namespace holonomic
