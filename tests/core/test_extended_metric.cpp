// Metric determinant and Fixman force of single molecules, against dense elimination and differences in 113 bits.
#define HOL_ISA double_double
#include "core/kernels/extended/verbs.hpp"

#include "extended_case.hpp"
#include "extended_plan.hpp"
#include "extended_shapes.hpp"

using namespace extended_case;
using holonomic::packed_array;

namespace
{

constexpr double epsilon = 2.220446049250313e-16;

// det Z~: the matrix with ones on its diagonal, by elimination.
quad scaled_determinant(const molecule &m)
{
    matrix a = matrix_of(m);
    quad det = 1;
    std::vector<quad> diagonal;
    for (int k = 0; k < m.n_bonds; ++k) diagonal.push_back(a[k][k]);
    for (int c = 0; c < m.n_bonds; ++c) {
        det *= a[c][c] / diagonal[c];
        for (int i = c + 1; i < m.n_bonds; ++i) {
            const quad l = a[i][c] / a[c][c];
            for (int j = c; j < m.n_bonds; ++j) a[i][j] -= l * a[c][j];
        }
    }
    return det;
}

double logarithm(quad x)
{
    const quad less = x - 1;
    return static_cast<double>(absolute(less) < 0.5 ? std::log1p(static_cast<long double>(less))
                                                    : std::log(static_cast<long double>(x)));
}

struct results {
    double log_det = 77, log_det_z = 77;
    std::vector<double> force;
    holonomic::Tally tally = empty_tally();
};

results metric_of(molecule &m)
{
    const planned shape(m);
    const holonomic::MoleculeLane lane{0, nullptr, nullptr, m.w.data(), m.length.data(), 0, 0};
    results found;
    found.force.assign(3 * m.n_atoms, 78.0);
    holonomic::MetricCall call{};
    call.r = packed_array(m.r.data());
    call.force = packed_array(found.force.data());
    call.kT = 2;
    call.log_det = &found.log_det;
    call.log_det_z = &found.log_det_z;
    holonomic::double_double::extended::metric(call, shape.plan, lane, shape.scratch, found.tally);
    require(!shape.overrun(), m.name, "scratch memory is overrun");
    return found;
}

void determinants_are_right(molecule &m)
{
    const results found = metric_of(m);
    require(found.tally.n_bad == 0, m.name, "the metric is refused");
    const double exact = logarithm(scaled_determinant(m));
    require(std::fabs(found.log_det - exact) <= 4 * epsilon * std::fabs(exact), m.name, "ln det Z~");
    require(found.tally.log_det == found.log_det, m.name, "the sum of ln det Z~");
    double whole = exact, size = std::fabs(exact);
    const matrix a = matrix_of(m);
    for (int k = 0; k < m.n_bonds; ++k) {
        const double z = logarithm(4 * a[k][k]);
        whole += z;
        size += std::fabs(z);
    }
    require(std::fabs(found.log_det_z - whole) <= 8 * epsilon * size, m.name, "ln det Z");
}

// - grad (kT/2) ln det Z~, kT = 2.
void forces_are_gradients(molecule &m)
{
    const results found = metric_of(m);
    double largest = 1;
    for (const double f : found.force) largest = std::max(largest, std::fabs(f));
    const double h = 0x1p-30;
    for (int e = 0; e < 3 * m.n_atoms; ++e) {
        molecule up = m, down = m;
        up.r[e] += h;
        down.r[e] -= h;
        const quad a = scaled_determinant(up), b = scaled_determinant(down);
        const quad step = quad(up.r[e]) - quad(down.r[e]);
        const double slope = static_cast<double>(quad(std::log1p(static_cast<long double>((a - b) / b))) / step);
        require(std::fabs(found.force[e] + slope) <= 1e-12 * largest, m.name, "the Fixman force is no gradient");
    }
}

void dependent_bonds_have_no_metric()
{
    molecule m("straight triangle", ring(3), 1, 0);
    m.r = {0, 0, 0, 1, 1, 1, 3, 3, 3};
    const results found = metric_of(m);
    require(found.tally.n_bad == 1 && found.log_det == 77 && found.log_det_z == 77, m.name, "is not refused");
    for (const double f : found.force) require(f == 78, m.name, "a force is written");
}

}  // namespace

int main()
{
    unsigned seed = 100;
    for (const shape &s : shapes)
        for (const double decades : {0.0, 2.0}) {
            molecule m(s.name, s.list, seed++, decades);
            if (s.list.size() > 4 && decades > 0) m.w[static_cast<std::size_t>(m.n_atoms) - 1] = 0;
            determinants_are_right(m);
            if (m.n_bonds < 15) forces_are_gradients(m);
        }
    dependent_bonds_have_no_metric();
}
