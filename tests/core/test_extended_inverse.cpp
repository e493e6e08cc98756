// The inverse of molecules of any shape, against dense inversion in 113 bits.
#include "core/inverse/inverse.hpp"

#include "extended_case.hpp"
#include "extended_shapes.hpp"

using namespace extended_case;
using holonomic::AtomArray;
using holonomic::Inverse;
using holonomic::packed_array;

namespace
{

constexpr double epsilon = 2.220446049250313e-16;

// The molecule's bonds as the library counts them, in a set of their own.
struct owned {
    molecule m;
    holonomic::Chains chains;
    std::unique_ptr<const Inverse> inverse;

    explicit owned(const molecule &given) : m(given), chains(given.n_atoms, masses(given).data())
    {
        const std::vector<std::int64_t> pairs(m.pairs.begin(), m.pairs.end());
        chains.add_bonds(m.n_bonds, pairs.data(), m.length.data());
        require(chains.n_chains() == 1, m.name, "is more than one molecule");
        std::vector<std::int64_t> order(static_cast<std::size_t>(m.n_bonds));
        chains.bonds(0, order.data());
        molecule sorted = m;
        for (std::size_t k = 0; k < order.size(); ++k)
            for (std::size_t e = 0; e < 2; ++e)
                sorted.pairs[2 * k + e] = m.pairs[2 * static_cast<std::size_t>(order[k]) + e];
        m = sorted;
        m.measure();
        inverse = Inverse::make(chains, 0, packed_array(m.r.data()));
    }
    static std::vector<double> masses(const molecule &m)
    {
        std::vector<double> mass;
        for (const double w : m.w) mass.push_back(w > 0 ? 1 / w : 0);
        return mass;
    }
};

quad element(const matrix &a, const matrix &h, bool physical, std::size_t i, std::size_t j)
{
    return physical ? h[i][j] / 4 : h[i][j] * square_root(a[i][i] * a[j][j]);
}

void elements_are_right(const owned &x, const matrix &a, const matrix &h, bool physical)
{
    const std::size_t n = static_cast<std::size_t>(x.m.n_bonds);
    std::vector<double> row(n), whole(n * n), diagonal(n);
    x.inverse->matrix(physical, whole.data());
    x.inverse->band(physical, 0, diagonal.data());
    for (std::size_t i = 0; i < n; ++i) {
        x.inverse->row(physical, static_cast<std::int64_t>(i), row.data());
        require(diagonal[i] == row[i], x.m.name, "the diagonal is not that of the rows");
        for (std::size_t j = 0; j < n; ++j) {
            const quad exact = element(a, h, physical, i, j);
            // Inverse masses are not given, but rounded from masses: a few roundings times the condition number.
            const double allowed = 1e-11 * std::fabs(static_cast<double>(exact)) + 1e-20;
            require(std::fabs(static_cast<double>(row[j] - exact)) <= allowed, x.m.name, "an element of a row");
            require(std::fabs(row[j] - whole[i * n + j]) <= epsilon * std::fabs(row[j]), x.m.name, "rows and matrix");
            require(whole[i * n + j] == whole[j * n + i], x.m.name, "the matrix is not symmetric");
            require(x.inverse->entry(physical, static_cast<std::int64_t>(i), static_cast<std::int64_t>(j)) ==
                        whole[i * n + j],
                    x.m.name, "an element by itself");
        }
    }
}

void condition_is_right(const owned &x, const matrix &a, const matrix &h)
{
    const std::size_t n = a.size();
    double largest = 0, of_inverse = 0;
    for (std::size_t i = 0; i < n; ++i) {
        double sum = 0, inverse_sum = 0;
        for (std::size_t j = 0; j < n; ++j) {
            sum += std::fabs(static_cast<double>(a[i][j] / square_root(a[i][i] * a[j][j])));
            inverse_sum += std::fabs(static_cast<double>(element(a, h, false, i, j)));
        }
        largest = std::max(largest, sum);
        of_inverse = std::max(of_inverse, inverse_sum);
    }
    const double exact = largest * of_inverse;
    require(std::fabs(x.inverse->condition() - exact) <= 1e-11 * exact, x.m.name, "the condition number");
}

// A bound for multipliers that are off by a known error holds, and is not far too large.
void bounds_hold(const owned &x, const matrix &h)
{
    const molecule &m = x.m;
    const std::size_t n = static_cast<std::size_t>(m.n_bonds);
    std::vector<quad> exact(n, 0);
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t l = 0; l < n; ++l) {
            const int bond = static_cast<int>(l), i = m.pairs[2 * l], j = m.pairs[2 * l + 1];
            const quad3 d = m.bond(bond), dv = m.difference(m.v, bond);
            exact[k] +=
                h[k][l] / 2 * (dot(d, quad(m.w[j]) * m.atom(m.f, j) - quad(m.w[i]) * m.atom(m.f, i)) + dot(dv, dv));
        }
    std::vector<double> lambda(n);
    for (std::size_t k = 0; k < n; ++k) lambda[k] = static_cast<double>(exact[k]) * (k % 2 == 0 ? 1 + 1e-6 : 1 - 1e-6);
    const std::vector<double> bound =
        x.inverse->error_bound(packed_array(m.v.data()), packed_array(m.f.data()), lambda.data());
    for (std::size_t k = 0; k < n; ++k)
        require(std::fabs(static_cast<double>(lambda[k] - exact[k])) <= bound[k], m.name, "a bound does not hold");
    require(bound[0] < 1, m.name, "a bound is too large");
}

template <class Call>
holonomic::Status status_of(const Call &call)
{
    try {
        call();
    } catch (const holonomic::Error &error) {
        return error.status;
    }
    return holonomic::Status::ok;
}

void bad_arguments_are_refused(const owned &x)
{
    std::vector<double> out(static_cast<std::size_t>(x.m.n_bonds) * 8, 77.0);
    require(status_of([&] { x.inverse->band(true, 1, out.data()); }) == holonomic::Status::value, x.m.name, "a band");
    require(status_of([&] { x.inverse->row(true, x.m.n_bonds, out.data()); }) == holonomic::Status::index, x.m.name,
            "a row behind the last");
    for (const double value : out) require(value == 77, x.m.name, "something is written");
}

}  // namespace

int main()
try {
    unsigned seed = 300;
    for (const shape &s : shapes) {
        if (s.list.size() < 3 || s.name == std::string("chain of three")) continue;
        molecule m(s.name, s.list, seed++, 1);
        for (double &w : m.w) w = 1 / (1 / w);
        const owned x(m);
        const matrix a = matrix_of(x.m), h = inverse_of(a);
        for (const bool physical : {false, true}) elements_are_right(x, a, h, physical);
        condition_is_right(x, a, h);
        bounds_hold(x, h);
        bad_arguments_are_refused(x);
    }
} catch (const holonomic::Error &error) {
    std::puts(error.message);
    return 1;
}
