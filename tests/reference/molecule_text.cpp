#include "molecule_text.hpp"

#include <cinttypes>
#include <cstdarg>
#include <cstdio>

#include "wide_levels.hpp"
#include "wide_metric.hpp"
#include "wide_positions.hpp"

namespace reference
{
namespace
{

constexpr int digits = 35, scale_digits = 6;
/** 512 bits leave less than 2^-400 of a zero's scale; no result of interest is below 1e-90 of its own. */
constexpr int analytic_zero = 300;

std::string text(const char *format, ...) __attribute__((format(printf, 1, 2)));
std::string text(const char *format, ...)
{
    char line[512];
    va_list args;
    va_start(args, format);
    std::vsnprintf(line, sizeof line, format, args);
    va_end(args);
    return line;
}

std::string exact(const double *x, int n)
{
    std::string out;
    for (int k = 0; k < n; ++k) out += x[k] == 0 ? " 0.0" : text(" %.16e", x[k]);
    return out;
}

template <class REAL>
std::string result(const REAL &x)
{
    return " " + decimal(x, digits);
}

/** A result beside the scale of what cancels in it: what is zero but for the rounding of this arithmetic is zero. */
template <class REAL>
std::string result(const REAL &x, const REAL &scale)
{
    return absolute(x) < scale.scaled(-analytic_zero) ? " 0.0" : result(x);
}

template <class REAL>
std::string result(const vector3<REAL> &x, const REAL &scale)
{
    return result(x[0], scale) + result(x[1], scale) + result(x[2], scale);
}

template <class REAL>
std::string scale(const REAL &x)
{
    return " " + decimal(x, scale_digits);
}

template <class REAL>
std::string sums(const wide_metric<REAL> &m, const wide_solution<REAL> &s)
{
    std::string out = "lndet" + result(m.log_det) + "\nlndetz" + result(m.log_det_z) + "\nfixman_energy" +
                      result(m.log_det.scaled(-1)) + "\nvirial";
    for (const std::size_t x : {0u, 1u, 2u, 4u, 5u, 8u}) out += result(s.virial[x], s.virial_scale);
    return out + "\nvirial_scale" + scale(s.virial_scale) + "\ncond" + scale(m.condition) + "\nleast_pivot" +
           scale(m.least_pivot) + "\n";
}

template <class REAL>
std::string tables(const wide_metric<REAL> &m, const wide_solution<REAL> &s, const wide_solution<REAL> &v)
{
    std::string out = "# k lambda lambda_scale mu mu_scale\nbonds_out\n";
    for (std::size_t k = 0; k < s.lambda.size(); ++k)
        out += text("%zu", k) + result(s.lambda[k], s.lambda_scale[k]) + scale(s.lambda_scale[k]) +
               result(v.lambda[k], v.lambda_scale[k]) + scale(v.lambda_scale[k]) + "\n";
    out += "# i Gx Gy Gz G_scale FFx FFy FFz FF_scale vx vy vz v_scale\natoms_out\n";
    for (std::size_t i = 0; i < s.g.size(); ++i)
        out += text("%zu", i) + result(s.g[i], s.g_scale[i]) + scale(s.g_scale[i]) +
               result(m.force[i], m.force_scale[i]) + scale(m.force_scale[i]) + result(v.moved[i], v.moved_scale[i]) +
               scale(v.moved_scale[i]) + "\n";
    return out;
}

template <class REAL>
std::string positions(const molecule_problem &p, const molecule_step &step)
{
    const wide_solution<REAL> s = wide_positions<REAL>(p, step);
    if (!s.regular) return "positions none\n";
    std::string out = text("positions %.16e\n# i x y z (in)  x y z r_scale (out)\n", step.dt);
    for (std::size_t i = 0; i < s.g.size(); ++i)
        out += text("%zu", i) + exact(step.drifted + 3 * i, 3) + result(s.moved[i], s.moved_scale[i]) +
               scale(s.moved_scale[i]) + "\n";
    out += "# k lambda lambda_scale\n";
    for (std::size_t k = 0; k < s.lambda.size(); ++k)
        out += text("%zu", k) + result(s.lambda[k], s.lambda_scale[k]) + scale(s.lambda_scale[k]) + "\n";
    return out;
}

/** Everything after the inputs; "" if Z is singular. */
template <class REAL>
std::string results(const molecule_problem &p, const molecule_step &step)
{
    const wide_metric<REAL> m = wide_metric_of<REAL>(p);
    if (!m.regular || m.least_pivot < REAL(1e-60)) return "";
    const wide_solution<REAL> s = wide_forces<REAL>(p), v = wide_velocities<REAL>(p);
    return sums(m, s) + tables(m, s, v) + positions<REAL>(p, step);
}

std::string inputs(const molecule_problem &p, const molecule_text_extra &e)
{
    const bool cyclic = p.n_bonds >= p.n_atoms;  // of a connected molecule
    std::string out = "# format, scales, bounds: tests/oracle/molecules/README.md\nmolecule " + e.name +
                      text("\nnatoms %" PRId64 "\nnbonds %" PRId64 "\nclass %s\nexpect %s\n", p.n_atoms, p.n_bonds,
                           cyclic ? "cyclic" : "tree", e.degenerate ? "degenerate" : "ok");
    out += "# i w m x y z vx vy vz Fx Fy Fz\natoms_in\n";
    for (std::int64_t i = 0; i < p.n_atoms; ++i) {
        const double mass = p.inverse_mass[i] > 0 ? 1 / p.inverse_mass[i] : -1;
        out += text("%" PRId64, i) + exact(p.inverse_mass + i, 1) + exact(&mass, 1) + exact(p.r + 3 * i, 3) +
               exact(p.v + 3 * i, 3) + exact(p.f + 3 * i, 3) + "\n";
    }
    out += "# k i j length\nbonds_in\n";
    for (std::int64_t k = 0; k < p.n_bonds; ++k)
        out += text("%" PRId64 " %" PRId64 " %" PRId64, k, p.pairs[2 * k], p.pairs[2 * k + 1]) +
               exact(e.step.length + k, 1) + "\n";
    return out;
}

}  // namespace

std::string molecule_text(const molecule_problem &p, const molecule_text_extra &extra)
{
    const std::string found = results<wide_float<512>>(p, extra.step);
    if (found.empty() != extra.degenerate || found != results<wide_float<1024>>(p, extra.step)) return "";
    return inputs(p, extra) + found + "end\n";
}

}  // namespace reference
