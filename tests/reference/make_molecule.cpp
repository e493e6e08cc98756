/**
 * Writes reference files in the format of tests/oracle/molecules, solved with 512 bits and again with 1024, which must
 * agree in all the digits that are written:
 *     make_molecule DIR KIND SIZE SEED
 * adds DIR/KIND_nNNN_SEED.txt and its line in DIR/INDEX. KIND is a number, a molecule_kind of molecule.h; SIZE counts
 * bonds, atoms, arms or generations, whatever that kind has.
 */
#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "molecule.h"
#include "wide_levels.hpp"
#include "wide_metric.hpp"
#include "wide_positions.hpp"

using namespace reference;

namespace
{

constexpr int digits = 35, scale_digits = 6;

/** A bond's ends move by this part of its length in the step of the position level, or by a quarter of it, and so on.
 */
constexpr double drift = 0.02;
constexpr int most_attempts = 10;

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

template <class REAL>
std::string result(const vector3<REAL> &x)
{
    return result(x[0]) + result(x[1]) + result(x[2]);
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
    for (const std::size_t x : {0, 1, 2, 4, 5, 8}) out += result(s.virial[x]);
    return out + "\nvirial_scale" + scale(s.virial_scale) + "\ncond" + scale(m.condition) + "\nleast_pivot" +
           scale(m.least_pivot) + "\n";
}

template <class REAL>
std::string tables(const wide_metric<REAL> &m, const wide_solution<REAL> &s, const wide_solution<REAL> &v)
{
    std::string out = "# k lambda lambda_scale mu mu_scale\nbonds_out\n";
    for (std::size_t k = 0; k < s.lambda.size(); ++k)
        out += text("%zu", k) + result(s.lambda[k]) + scale(s.lambda_scale[k]) + result(v.lambda[k]) +
               scale(v.lambda_scale[k]) + "\n";
    out += "# i Gx Gy Gz G_scale FFx FFy FFz FF_scale vx vy vz v_scale\natoms_out\n";
    for (std::size_t i = 0; i < s.g.size(); ++i)
        out += text("%zu", i) + result(s.g[i]) + scale(s.g_scale[i]) + result(m.force[i]) + scale(m.force_scale[i]) +
               result(v.moved[i]) + scale(v.moved_scale[i]) + "\n";
    return out;
}

template <class REAL>
std::string positions(const molecule_problem &p, const molecule_step &step)
{
    const wide_solution<REAL> s = wide_positions<REAL>(p, step);
    if (!s.regular) return "positions none\n";
    std::string out = text("positions %.16e\n# i x y z (in)  x y z r_scale (out)\n", step.dt);
    for (std::size_t i = 0; i < s.g.size(); ++i)
        out += text("%zu", i) + exact(step.drifted + 3 * i, 3) + result(s.moved[i]) + scale(s.moved_scale[i]) + "\n";
    out += "# k lambda lambda_scale\n";
    for (std::size_t k = 0; k < s.lambda.size(); ++k)
        out += text("%zu", k) + result(s.lambda[k]) + scale(s.lambda_scale[k]) + "\n";
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

std::string inputs(const molecule &m, const std::string &name, bool degenerate)
{
    const bool cyclic = m.n_bonds >= m.n_atoms;  // a kind is connected
    std::string out = "# format, scales, bounds: README.md\nmolecule " + name +
                      text("\nnatoms %" PRId64 "\nnbonds %" PRId64 "\nclass %s\nexpect %s\n", m.n_atoms, m.n_bonds,
                           cyclic ? "cyclic" : "tree", degenerate ? "degenerate" : "ok");
    out += "# i w m x y z vx vy vz Fx Fy Fz\natoms_in\n";
    for (std::int64_t i = 0; i < m.n_atoms; ++i) {
        const double mass = m.mass[i] > 0 ? m.mass[i] : -1;
        out += text("%" PRId64, i) + exact(m.inverse_mass + i, 1) + exact(&mass, 1) + exact(m.r + 3 * i, 3) +
               exact(m.v + 3 * i, 3) + exact(m.f + 3 * i, 3) + "\n";
    }
    out += "# k i j length\nbonds_in\n";
    for (std::int64_t k = 0; k < m.n_bonds; ++k)
        out += text("%" PRId64 " %" PRId64 " %" PRId64, k, m.pairs[2 * k], m.pairs[2 * k + 1]) +
               exact(m.length + k, 1) + "\n";
    return out;
}

/** Velocities that obey the constraints to the rounding of doubles: with others a stiff molecule leaves its reach. */
std::vector<double> projected(const molecule &m)
{
    std::vector<double> v(m.v, m.v + 3 * m.n_atoms);
    const wide_solution<wide_float<512>> s = wide_velocities<wide_float<512>>(molecule_problem_of(&m));
    for (std::size_t i = 0; s.regular && i < v.size(); ++i) v[i] = static_cast<double>(s.moved[i / 3][i % 3]);
    return v;
}

/** A step in which no bond's ends move far relative to each other. */
double time_step(const molecule &m, const std::vector<double> &v)
{
    double dt = HUGE_VAL;
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        const double *a = v.data() + 3 * m.pairs[2 * k], *b = v.data() + 3 * m.pairs[2 * k + 1];
        const double speed = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        if (speed > 0) dt = std::min(dt, drift * m.length[k] / speed);
    }
    return dt;
}

/** The longest step, by quarters, from which the bonds find back to their lengths. */
double possible_step(const molecule &m, const std::vector<double> &v, std::vector<double> &drifted)
{
    const molecule_problem p = molecule_problem_of(&m);
    double dt = time_step(m, v);
    for (int attempt = 0; attempt < most_attempts; ++attempt, dt /= 4) {
        for (std::size_t i = 0; i < v.size(); ++i) drifted[i] = m.r[i] + dt * v[i];
        if (wide_positions<wide_float<512>>(p, {drifted.data(), m.length, dt, nullptr}).regular) break;
    }
    return dt;
}

bool add_to_file(const std::string &path, const char *mode, const std::string &content)
{
    std::FILE *out = std::fopen(path.c_str(), mode);
    if (!out) return false;
    const bool written = std::fputs(content.c_str(), out) >= 0;
    return std::fclose(out) == 0 && written;
}

}  // namespace

int main(int argc, char **argv)
{
    const int kind = argc == 5 ? std::atoi(argv[2]) : -1;
    const long long size = argc == 5 ? std::atoll(argv[3]) : 0, seed = argc == 5 ? std::atoll(argv[4]) : -1;
    if (kind < 0 || kind >= MOLECULE_KINDS || size < 1 || size > 1000 || seed < 0) {
        std::fprintf(stderr, "usage: make_molecule DIR KIND SIZE SEED   (KIND 0..%d, SIZE 1..1000, SEED >= 0)\n",
                     MOLECULE_KINDS - 1);
        return 2;
    }
    molecule m = molecule_make(static_cast<molecule_kind>(kind), size, static_cast<std::uint64_t>(seed));
    std::string name = text("%s_n%03lld_%lld", molecule_kind_name(static_cast<molecule_kind>(kind)), size, seed);
    std::replace(name.begin(), name.end(), ' ', '_');
    const bool degenerate = kind >= MOLECULE_GOOD_KINDS;
    std::string all = inputs(m, name, degenerate);
    const molecule_problem p = molecule_problem_of(&m);
    std::vector<double> drifted(m.r, m.r + 3 * m.n_atoms);
    const double dt = degenerate ? 1 : possible_step(m, projected(m), drifted);
    const molecule_step step{drifted.data(), m.length, dt, nullptr};
    const std::string found = results<wide_float<512>>(p, step);
    const bool right = found.empty() == degenerate && found == results<wide_float<1024>>(p, step);
    if (!right) std::fprintf(stderr, "make_molecule: %s: the digits are not certain\n", name.c_str());
    all += found + "end\n";
    molecule_free(&m);
    const std::string directory = argv[1];
    const bool done = right && add_to_file(directory + "/" + name + ".txt", "w", all) &&
                      add_to_file(directory + "/INDEX", "a", name + ".txt\n");
    return done ? 0 : 1;
}
