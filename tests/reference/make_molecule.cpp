/**
 * Writes reference files in the format of tests/oracle/molecules:
 *     make_molecule DIR KIND SIZE SEED
 * adds DIR/KIND_nNNN_SEED.txt and its line in DIR/INDEX. KIND is a number, a molecule_kind of molecule.h; SIZE counts
 * bonds, atoms, arms or generations, whatever that kind has.
 */
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "molecule.h"
#include "molecule_text.hpp"
#include "wide_levels.hpp"
#include "wide_positions.hpp"

using namespace reference;

namespace
{

/** A bond's ends move by this part of its length in the step of the position level, or by a quarter of it, and so on.
 */
constexpr double drift = 0.02;
constexpr int most_attempts = 10;

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
    char name[128];
    std::snprintf(name, sizeof name, "%s_n%03lld_%lld", molecule_kind_name(static_cast<molecule_kind>(kind)), size,
                  seed);
    std::replace(name, name + sizeof name, ' ', '_');
    const bool degenerate = kind >= MOLECULE_GOOD_KINDS && kind < MOLECULE_REFUSED_END;
    std::vector<double> drifted(m.r, m.r + 3 * m.n_atoms);
    const double dt = degenerate ? 1 : possible_step(m, projected(m), drifted);
    const std::string text =
        molecule_text(molecule_problem_of(&m), {name, degenerate, {drifted.data(), m.length, dt, nullptr}});
    molecule_free(&m);
    if (text.empty()) std::fprintf(stderr, "make_molecule: %s: the digits are not certain\n", name);
    const std::string directory = argv[1], file = std::string(name) + ".txt";
    const bool done = !text.empty() && add_to_file(directory + "/" + file, "w", text) &&
                      add_to_file(directory + "/INDEX", "a", file + "\n");
    return done ? 0 : 1;
}
