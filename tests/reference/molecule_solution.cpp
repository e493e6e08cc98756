#include "molecule_solution.h"

#include <cstdlib>

#include "wide_levels.hpp"
#include "wide_metric.hpp"
#include "wide_positions.hpp"

namespace reference
{
namespace
{

using narrow = wide_float<448>;
using broad = wide_float<1280>;

/** Below this least pivot of Z~, 448 bits may leave too few digits of numbers 1e-80 of the largest. */
constexpr double narrow_limit = 1e-25, broad_limit = 1e-200;

template <class REAL>
void copy(const std::vector<REAL> &from, long double *to)
{
    for (std::size_t k = 0; k < from.size(); ++k) to[k] = static_cast<long double>(from[k]);
}

template <class REAL>
void copy(const std::vector<vector3<REAL>> &from, long double *to)
{
    for (std::size_t i = 0; i < from.size(); ++i)
        for (std::size_t x = 0; x < 3; ++x) to[3 * i + x] = static_cast<long double>(from[i][x]);
}

template <class REAL>
int give(const molecule_problem &p, const wide_solution<REAL> &s, molecule_solution &out)
{
    const std::size_t n = static_cast<std::size_t>(p.n_bonds), atoms = static_cast<std::size_t>(p.n_atoms);
    out = molecule_solution();
    out.lambda = static_cast<long double *>(std::calloc(3 * n + 8 * atoms + 1, sizeof(long double)));
    if (!out.lambda) return -1;
    out.n_bonds = p.n_bonds;
    out.n_atoms = p.n_atoms;
    out.lambda_scale = out.lambda + n;
    out.tension = out.lambda_scale + n;
    out.g = out.tension + n;
    out.g_scale = out.g + 3 * atoms;
    out.moved = out.g_scale + atoms;
    out.moved_scale = out.moved + 3 * atoms;
    copy(s.lambda, out.lambda);
    copy(s.lambda_scale, out.lambda_scale);
    copy(s.tension, out.tension);
    copy(s.g, out.g);
    copy(s.g_scale, out.g_scale);
    copy(s.moved, out.moved);
    copy(s.moved_scale, out.moved_scale);
    for (std::size_t x = 0; x < 9; ++x) out.virial[x] = static_cast<long double>(s.virial[x]);
    out.virial_scale = static_cast<long double>(s.virial_scale);
    out.least_pivot = static_cast<long double>(s.least_pivot);
    return 0;
}

/** Solves in as many bits as it takes. NARROW and BROAD are the same solver. */
template <class NARROW, class BROAD>
int solve(const molecule_problem &p, molecule_solution &out, NARROW in_narrow, BROAD in_broad)
{
    const auto s = in_narrow();
    if (s.regular && s.least_pivot > narrow(narrow_limit)) return give(p, s, out);
    const auto b = in_broad();
    out = molecule_solution();
    out.least_pivot = static_cast<long double>(b.least_pivot);
    return b.regular && b.least_pivot > broad(broad_limit) ? give(p, b, out) : -1;
}

template <class REAL>
int give(const molecule_problem &p, const wide_metric<REAL> &m, molecule_metric &out)
{
    const std::size_t n = static_cast<std::size_t>(p.n_bonds), atoms = static_cast<std::size_t>(p.n_atoms);
    out.fixman_force = static_cast<long double *>(std::calloc(4 * atoms + n * n + 1, sizeof(long double)));
    if (!out.fixman_force) return -1;
    out.n_bonds = p.n_bonds;
    out.n_atoms = p.n_atoms;
    out.fixman_scale = out.fixman_force + 3 * atoms;
    out.inverse = out.fixman_scale + atoms;
    out.log_det = static_cast<long double>(m.log_det);
    out.log_det_z = static_cast<long double>(m.log_det_z);
    out.log_det_z_scale = static_cast<long double>(m.log_det_z_scale);
    out.condition = static_cast<long double>(m.condition);
    copy(m.force, out.fixman_force);
    copy(m.force_scale, out.fixman_scale);
    for (std::size_t k = 0; k < n; ++k) copy(m.inverse[k], out.inverse + k * n);
    return 0;
}

}  // namespace
}  // namespace reference

using namespace reference;

extern "C" int molecule_forces(const molecule_problem *p, molecule_solution *out)
{
    return solve(
        *p, *out, [=] { return wide_forces<narrow>(*p); }, [=] { return wide_forces<broad>(*p); });
}

extern "C" int molecule_velocities(const molecule_problem *p, molecule_solution *out)
{
    return solve(
        *p, *out, [=] { return wide_velocities<narrow>(*p); }, [=] { return wide_velocities<broad>(*p); });
}

extern "C" int molecule_solve(const molecule_problem *p, const double *rhs, molecule_solution *out)
{
    return solve(
        *p, *out, [=] { return wide_solve<narrow>(*p, rhs); }, [=] { return wide_solve<broad>(*p, rhs); });
}

extern "C" int molecule_positions(const molecule_problem *p, const double *drifted, const double *drifted_box,
                                  const double *length, double dt, molecule_solution *out)
{
    return molecule_positions_near(p, drifted, drifted_box, length, dt, nullptr, out);
}

extern "C" int molecule_positions_near(const molecule_problem *p, const double *drifted, const double *drifted_box,
                                       const double *length, double dt, const double *lambda, molecule_solution *out)
{
    const molecule_step step{drifted, length, dt, drifted_box, lambda};
    const auto s = wide_positions<narrow>(*p, step);
    if (!s.regular) {  // in more bits it would not converge either, but for a few whose matrix has lost all digits
        *out = molecule_solution();
        return -1;
    }
    if (s.least_pivot > narrow(narrow_limit)) return give(*p, s, *out);
    const auto b = wide_positions<broad>(*p, step);
    return b.regular ? give(*p, b, *out) : -1;
}

extern "C" void molecule_solution_free(molecule_solution *s)
{
    std::free(s->lambda);
    *s = molecule_solution();
}

extern "C" int molecule_metric_make(const molecule_problem *p, molecule_metric *out)
{
    *out = molecule_metric();
    const auto m = wide_metric_of<narrow>(*p);
    out->least_pivot = static_cast<long double>(m.least_pivot);
    if (m.regular && m.least_pivot > narrow(narrow_limit)) return give(*p, m, *out);
    const auto b = wide_metric_of<broad>(*p);
    out->least_pivot = static_cast<long double>(b.least_pivot);
    return b.regular && b.least_pivot > broad(broad_limit) ? give(*p, b, *out) : -1;
}

extern "C" void molecule_metric_free(molecule_metric *m)
{
    std::free(m->fixman_force);
    *m = molecule_metric();
}
