// Forces, velocities, positions and what is left of the constraints.
#include <cmath>
#include <initializer_list>

#include "session.hpp"

namespace fuzz
{

void session::forces()
{
    atom_array r(n_atoms, in), v(n_atoms, in), f(n_atoms, in), g(n_atoms, in);
    block lambda(bonds() * sizeof(double)), tension(bonds() * sizeof(double)), virial(9 * sizeof(double));
    outputs out;
    for (block *b : {&lambda, &tension, &g.plain, &g.laid_out}) out.add(*b);
    out.add_sum(virial);
    const hol_mode mode = static_cast<hol_mode>(in.often() ? in.byte() & 1 : in.byte());
    int status;
    if (in.byte() & 1) {
        double *const l = maybe(lambda.doubles());
        double *const into = in.often() ? maybe(g.plain.doubles()) : f.plain.doubles();  // "may be f itself"
        status = hol_forces(maybe(chains), maybe(r.plain.doubles()), maybe(v.plain.doubles()), maybe(f.plain.doubles()),
                            l, maybe(tension.doubles()), into, mode, maybe(virial.doubles()));
        if (status == HOL_OK && l && !any_inactive) check(finite(l, bonds()), "multipliers that are not finite");
    } else {
        status = hol_forces_view(maybe(chains), maybe(r.input()), maybe(v.input()), maybe(f.input()),
                                 maybe(lambda.doubles()), maybe(tension.doubles()), maybe(&g.view), mode,
                                 maybe(virial.doubles()));
    }
    out.check_after(status, active());
}

void session::velocities()
{
    atom_array r(n_atoms, in), v(n_atoms, in);
    block lambda(bonds() * sizeof(double)), virial(9 * sizeof(double));
    outputs out;
    for (block *b : {&lambda, &v.plain, &v.laid_out}) out.add(*b);
    out.add_sum(virial);
    const int status = in.byte() & 1
                           ? hol_project_velocities(maybe(chains), maybe(r.plain.doubles()), maybe(v.plain.doubles()),
                                                    maybe(lambda.doubles()), maybe(virial.doubles()))
                           : hol_project_velocities_view(maybe(chains), maybe(r.input()), maybe(&v.view),
                                                         maybe(lambda.doubles()), maybe(virial.doubles()));
    out.check_after(status, active());
}

void session::positions()
{
    atom_array before(n_atoms, in), r(n_atoms, in), v(n_atoms, in);
    if (in.byte() & 1)  // a step as it should be: not far from where it began
        for (std::size_t i = 0; i < atoms3(); ++i)
            r.plain.doubles()[i] =
                before.plain.doubles()[i] + (n_atoms > 256 ? static_cast<int>(i * 7 % 256) : in.byte()) / 65536.0;
    block lambda(bonds() * sizeof(double)), virial(9 * sizeof(double)), report(sizeof(hol_report));
    fill(lambda, bonds(), in);
    outputs out;
    for (block *b : {&lambda, &r.plain, &r.laid_out, &v.plain, &v.laid_out}) out.add(*b);
    out.add_sum(virial);
    const double dt = in.often() ? 0.01 : in.number();
    const int guess = in.often() ? in.byte() & 1 : in.byte();
    hol_report *const said = maybe(reinterpret_cast<hol_report *>(report.data()));
    const int status =
        in.byte() & 1 ? hol_project_positions(maybe(chains), maybe(before.plain.doubles()), maybe(r.plain.doubles()),
                                              maybe(v.plain.doubles()), dt, maybe(lambda.doubles()), guess,
                                              maybe(virial.doubles()), said)
                      : hol_project_positions_view(maybe(chains), maybe(before.input()), maybe(&r.view), maybe(&v.view),
                                                   dt, maybe(lambda.doubles()), guess, maybe(virial.doubles()), said);
    out.check_after(status, active());
    if (said && status == HOL_OK) {
        check(said->n_failed == 0, "a report of failures without one");
        check(said->max_error >= 0, "a success whose largest error is no number");
    }
}

void session::compare()
{
    atom_array r(n_atoms, in);
    outputs out;
    for (block *b : {&r.plain, &r.laid_out}) out.add(*b);
    check_status(hol_chains_set_checks(maybe(chains), static_cast<hol_when>(in.often() ? in.byte() % 3 : in.byte())));
    const hol_which_box box = static_cast<hol_which_box>(in.often() ? in.byte() & 1 : in.byte());
    const int status = in.byte() & 1 ? hol_chains_check(maybe(chains), maybe(r.plain.doubles()), box)
                                     : hol_chains_check_view(maybe(chains), maybe(r.input()), box);
    out.check_after(status, 0);
}

void session::along()
{
    atom_array r(n_atoms, in), v(n_atoms, in), b(static_cast<std::int64_t>(bonds()), in);
    block lambda(bonds() * sizeof(double)), virial(9 * sizeof(double)), report(sizeof(hol_report));
    fill(lambda, bonds(), in);
    outputs out;
    for (block *one : {&lambda, &r.plain, &r.laid_out, &v.plain, &v.laid_out}) out.add(*one);
    out.add_sum(virial);
    const int guess = in.byte() & 1;
    hol_report *const said = maybe(reinterpret_cast<hol_report *>(report.data()));
    const int status =
        in.byte() & 1
            ? hol_project_positions_along(maybe(chains), maybe(b.plain.doubles()), maybe(r.plain.doubles()),
                                          maybe(v.plain.doubles()), 0.01, maybe(lambda.doubles()), guess,
                                          maybe(virial.doubles()), said)
            : hol_project_positions_along_view(maybe(chains), maybe(b.input()), maybe(&r.view), maybe(&v.view), 0.01,
                                               maybe(lambda.doubles()), guess, maybe(virial.doubles()), said);
    // Lengths that do not fit, and vectors that make no sense, change nothing at all.
    double error;
    std::int64_t molecule, bond;
    out.check_after(status, active());
    if (hol_reference_error(chains, &error, &molecule, &bond) == HOL_OK)
        check(error >= 0 || std::isnan(error), "an error of the reference that is negative");
}

void session::violation()
{
    atom_array r(n_atoms, in), v(n_atoms, in);
    block worst(sizeof(hol_worst));
    outputs out;
    out.add_sum(worst);
    hol_worst *const w = maybe(reinterpret_cast<hol_worst *>(worst.data()));
    const int status = in.byte() & 1
                           ? hol_violation(maybe(chains), maybe(r.plain.doubles()), maybe(v.plain.doubles()), w)
                           : hol_violation_view(maybe(chains), maybe(r.input()), maybe(v.input()), w);
    out.check_after(status, active());
}

}  // namespace fuzz
