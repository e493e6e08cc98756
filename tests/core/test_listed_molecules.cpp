// Molecules of one kind whose atoms do not follow each other: each has atoms of its own, in blocks of any number of
// lanes.
#include <cmath>

#include "core/forces.hpp"
#include "core/metric.hpp"
#include "core/molecules/chains.hpp"
#include "extended_case.hpp"

using namespace extended_case;
using holonomic::packed_array;

namespace
{

// `count` copies of a molecule, of which atom i of copy c is number i count + c.
void copies_are_solved(const char *name, const bonds &list, int count)
{
    const molecule m(name, list, 5, 0.5);
    const int n = m.n_atoms * count, n_bonds = m.n_bonds * count;
    std::vector<double> mass, length, r, v, f, g(static_cast<std::size_t>(3 * n)),
        log_det(static_cast<std::size_t>(count));
    std::vector<double> lambda(static_cast<std::size_t>(n_bonds));
    std::vector<std::int64_t> pairs;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < n; ++i) mass.push_back(1 / m.w[static_cast<std::size_t>(i / count)]);
    for (std::vector<double> *x : {&r, &v, &f})
        for (int e = 0; e < 3 * n; ++e) x->push_back(uniform(random));
    for (int c = 0; c < count; ++c)
        for (int k = 0; k < m.n_bonds; ++k) {
            for (int e = 0; e < 2; ++e) pairs.push_back(m.pairs[static_cast<std::size_t>(2 * k + e)] * count + c);
            length.push_back(1);
        }
    holonomic::Chains chains(n, mass.data());
    chains.add_bonds(n_bonds, pairs.data(), length.data());
    require(chains.n_chains() == count, name, "not as many molecules as there are");
    holonomic::ForcesCall call;
    call.r = packed_array(r.data());
    call.v = packed_array(v.data());
    call.f = packed_array(f.data());
    call.g = packed_array(g.data());
    call.lambda = lambda.data();
    call.tension = nullptr;
    call.add = false;
    holonomic::forces(chains, call, nullptr);
    for (std::size_t k = 0; k < pairs.size() / 2; ++k) {
        double rest = 0, size = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t ai = static_cast<std::size_t>(pairs[2 * k]),
                              aj = static_cast<std::size_t>(pairs[2 * k + 1]);
            const std::size_t i = 3 * ai + c, j = 3 * aj + c;
            const double d = r[j] - r[i], dv = v[j] - v[i];
            const double a = (f[j] + g[j]) / mass[aj], b = (f[i] + g[i]) / mass[ai];
            rest += d * (a - b) + dv * dv;
            size += std::fabs(d * a) + std::fabs(d * b) + dv * dv;
        }
        require(std::fabs(rest) <= 1e-9 * (1 + size), name, "a bond changes its length");
    }
    holonomic::MetricCall metric;
    metric.r = packed_array(r.data());
    metric.force = packed_array(g.data());
    metric.kT = 1;
    metric.log_det = log_det.data();
    holonomic::metric(chains, metric, nullptr);
    for (int c = 1; c < count; ++c)
        require(log_det[static_cast<std::size_t>(c)] != log_det[0], name, "two molecules have one determinant");
}

}  // namespace

int main()
{
    for (const int count : {1, 2, 3, 8, 9, 40}) {
        copies_are_solved("XH3", {{0, 1}, {0, 2}, {0, 3}}, count);
        copies_are_solved("water", {{0, 1}, {1, 2}, {0, 2}}, count);
        copies_are_solved("square", {{0, 1}, {1, 2}, {2, 3}, {3, 0}}, count);
        copies_are_solved("lariat", {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {2, 4}}, count);
    }
}
