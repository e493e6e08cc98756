// Metric, inverse matrices, normalized tridiagonal matrices and partition functions.
#include <cmath>
#include <initializer_list>
#include <vector>

#include "session.hpp"

namespace fuzz
{

void session::metric()
{
    atom_array r(n_atoms, in), force(n_atoms, in);
    const std::size_t n = static_cast<std::size_t>(hol_chains_n_molecules(chains));
    block log_det(n * sizeof(double)), log_det_z(n * sizeof(double)), energy(sizeof(double));
    outputs out;
    for (block *b : {&log_det, &log_det_z, &force.plain, &force.laid_out}) out.add(*b);
    out.add_sum(energy);
    const double kT = in.often() ? 1 : in.number();
    const hol_mode mode = static_cast<hol_mode>(in.often() ? in.byte() & 1 : in.byte());
    const int status =
        in.byte() & 1
            ? hol_metric(maybe(chains), maybe(r.plain.doubles()), kT, maybe(log_det.doubles()),
                         maybe(log_det_z.doubles()), maybe(energy.doubles()), maybe(force.plain.doubles()), mode)
            : hol_metric_view(maybe(chains), maybe(r.input()), kT, maybe(log_det.doubles()), maybe(log_det_z.doubles()),
                              maybe(energy.doubles()), maybe(&force.view), mode);
    out.check_after(status, active());
}

void session::inverse()
{
    atom_array r(n_atoms, in), v(n_atoms, in), f(n_atoms, in);
    hol_inverse *made = reinterpret_cast<hol_inverse *>(this);
    const std::int64_t chain = in.whole();
    const int created = in.byte() & 1 ? hol_inverse_create(maybe(chains), chain, maybe(r.plain.doubles()), &made)
                                      : hol_inverse_create_view(maybe(chains), chain, maybe(r.input()), &made);
    check_status(created);
    check(created == HOL_OK || made == nullptr, "an inverse after an error");
    const std::int64_t n = hol_inverse_n_bonds(made);
    const std::size_t rows = static_cast<std::size_t>(n);
    const std::int64_t i = in.whole(), j = in.whole(), width = in.whole() % 300;
    block numbers((rows * rows + 1) * sizeof(double)), multipliers(rows * sizeof(double)),
        bounds(rows * sizeof(double));
    block band(rows * static_cast<std::size_t>(width < 0 ? 1 : width + 1) * sizeof(double));
    fill(multipliers, rows, in);
    const hol_scaling scaling = static_cast<hol_scaling>(in.often() ? in.byte() & 1 : in.byte());
    const auto after = [](block &b, const std::vector<char> &before, int status) {
        check_status(status);
        if (status != HOL_OK) check(b.holds(before), "an output was written on an error");
    };
    const hol_inverse *const given = maybe(made);
    std::vector<char> before = numbers.copy();
    after(numbers, before, hol_inverse_entry(given, scaling, i, j, maybe(numbers.doubles())));
    before = numbers.copy();
    after(numbers, before, hol_inverse_row(given, scaling, i, maybe(numbers.doubles())));
    before = numbers.copy();
    after(numbers, before, hol_inverse_matrix(given, scaling, maybe(numbers.doubles())));
    before = numbers.copy();
    after(numbers, before, hol_inverse_condition(given, maybe(numbers.doubles())));
    before = band.copy();
    after(band, before, hol_inverse_band(given, scaling, width, maybe(band.doubles())));
    before = bounds.copy();
    double relative = 0;
    after(bounds, before,
          in.byte() & 1
              ? hol_inverse_error_bound(given, maybe(v.plain.doubles()), maybe(f.plain.doubles()),
                                        maybe(multipliers.doubles()), maybe(bounds.doubles()), maybe(&relative))
              : hol_inverse_error_bound_view(given, maybe(v.input()), maybe(f.input()), maybe(multipliers.doubles()),
                                             maybe(bounds.doubles()), maybe(&relative)));
    hol_inverse_destroy(made);
}

void session::tridiagonal()
{
    const std::int64_t n = in.often() ? in.byte() % 30 : -1 - in.byte();
    const std::size_t rows = static_cast<std::size_t>(n > 0 ? n : 0);
    const std::int64_t width = in.whole() % 100;
    block gamma((rows > 0 ? rows - 1 : 0) * sizeof(double)), b(rows * sizeof(double));
    block out(rows * static_cast<std::size_t>(width < 0 ? 1 : width + 1) * sizeof(double) + sizeof(double));
    fill(gamma, rows > 0 ? rows - 1 : 0, in);
    if (in.often())
        for (std::size_t k = 0; k + 1 < rows; ++k) gamma.doubles()[k] = std::fmod(gamma.doubles()[k], 0.75);
    fill(b, rows, in);
    const std::vector<char> before = out.copy();
    const double *const g = maybe(gamma.doubles());
    double *const to = maybe(out.doubles());
    int status = 0;
    switch (in.below(5)) {
        case 0:
            status = hol_tridiagonal_pivots(n, g, to);
            break;
        case 1:
            status = hol_tridiagonal_log_det(n, g, to);
            break;
        case 2:
            status = hol_tridiagonal_solve(n, g, maybe(b.doubles()), to);
            break;
        case 3:
            status = hol_tridiagonal_inverse_entry(n, g, in.whole(), in.whole(), to);
            break;
        default:
            status = hol_tridiagonal_inverse_band(n, g, width, to);
            break;
    }
    check_status(status);
    if (status != HOL_OK) check(out.holds(before), "an output was written on an error");
}

void session::partition()
{
    const std::int64_t n = in.often() ? in.byte() % 6 : -1 - in.byte();
    const std::size_t atoms = static_cast<std::size_t>(n > 0 ? n + 1 : 0);
    block masses(atoms * sizeof(double)), out(3 * sizeof(double));
    fill(masses, atoms, in, true);
    const std::vector<char> before = out.copy();
    double *const o = out.doubles();
    const int status = hol_partition_function(n, maybe(masses.doubles()), maybe(o), maybe(o + 1), maybe(o + 2));
    check_status(status);
    if (status != HOL_OK) check(out.holds(before), "an output was written on an error");
}

}  // namespace fuzz
