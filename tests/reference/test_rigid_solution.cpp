/**
 * The independent solutions for rigid bodies beside the reference files, whose numbers were found by another program:
 *     test_rigid_solution DIRECTORY
 * Values agree to 1e-15 of their scales, or of the files' scales where these are smaller. Exit status 1: something
 * differs.
 */
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>

#include "rigid_solution.hpp"

extern "C" {
#include "rigid_file.h"
}

using namespace reference;

namespace
{

constexpr long double largest_difference = 1e-15L;

rigid_problem problem_of(const rigid_file &c)
{
    rigid_problem p;
    const std::size_t n = static_cast<std::size_t>(c.n_atoms);
    p.mass.assign(c.mass, c.mass + n);
    p.place.assign(c.place, c.place + 3 * n);
    p.r.assign(c.r, c.r + 3 * n);
    p.v.assign(c.v, c.v + 3 * n);
    p.f.assign(c.f, c.f + 3 * n);
    const std::int64_t *atoms = c.body_atoms;
    for (std::int64_t b = 0; b < c.n_bodies; atoms += c.sizes[b++]) p.bodies.emplace_back(atoms, atoms + c.sizes[b]);
    for (std::int64_t k = 0; k < c.n_bonds; ++k) {
        p.pairs.push_back({static_cast<std::size_t>(c.pairs[2 * k]), static_cast<std::size_t>(c.pairs[2 * k + 1])});
        p.length.push_back(c.length[k]);
    }
    return p;
}

struct comparison {
    std::string name;
    bool good = true;

    /** values [scales.size()][per] */
    void check(const char *what, const std::vector<long double> &values, const std::vector<long double> &scales,
               const long double *file, const long double *file_scales, std::size_t per)
    {
        long double worst = 0, widest = 0, narrowest = HUGE_VALL;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const long double scale = std::fmin(scales[i / per], file_scales[i / per]),
                              off = std::fabs(values[i] - file[i]);
            if (off > 0) worst = std::fmax(worst, scale > 0 ? off / scale : HUGE_VALL);
            if (scale > 0) {
                widest = std::fmax(widest, scales[i / per] / file_scales[i / per]);
                narrowest = std::fmin(narrowest, scales[i / per] / file_scales[i / per]);
            }
        }
        good = good && worst <= largest_difference;
        if (!values.empty())
            std::printf("%-14s %-12s off by %.1Le of its scale, which is %.2Lg .. %.2Lg of the file's\n", name.c_str(),
                        what, worst, narrowest, widest);
    }
};

bool check_file(const std::string &path)
{
    rigid_file c;
    char message[256];
    if (rigid_file_read(path.c_str(), &c, message, sizeof message)) {
        std::printf("%s: %s\n", path.c_str(), message);
        return false;
    }
    const std::vector<double> drifted(c.drifted, c.drifted + 3 * c.n_atoms);
    const rigid_solution s = solve_rigid(problem_of(c), {}, drifted, c.dt);
    comparison compare{c.name};
    compare.good = s.regular && s.agrees && s.positions.there;
    if (compare.good) {
        // Velocities of fixed atoms are theirs, and no result.
        compare.check("lambda", s.forces.lambda, s.forces.lambda_scale, c.lambda, c.lambda_scale, 1);
        compare.check("G", s.forces.g, s.forces.g_scale, c.g, c.g_scale, 3);
        compare.check("mu", s.velocities.lambda, s.velocities.lambda_scale, c.mu, c.mu_scale, 1);
        compare.check("velocities", s.velocities.moved, s.velocities.moved_scale, c.velocity, c.v_scale, 3);
        compare.check("positions", s.positions.moved, s.positions.moved_scale, c.position, c.r_scale, 3);
        compare.check("lambda (r)", s.positions.lambda, s.positions.lambda_scale, c.position_lambda, c.position_scale,
                      1);
        const std::vector<long double> virial(s.forces.virial.begin(), s.forces.virial.end());
        compare.check("virial", virial, {s.forces.virial_scale}, c.virial, &c.virial_scale, 9);
    }
    if (!compare.good)
        std::printf("%s: differs (%s, least pivot %.1Le, two ways %s, positions %s)\n", c.name,
                    s.regular ? "regular" : "singular", s.least_pivot, s.agrees ? "agree" : "differ",
                    s.positions.there ? "found" : "not found");
    rigid_file_free(&c);
    return compare.good;
}

}  // namespace

int main(int argc, char **argv)
{
    if (argc != 2) return 2;
    const std::string directory = argv[1];
    std::FILE *const index = std::fopen((directory + "/INDEX").c_str(), "r");
    if (!index) return 2;
    int n = 0, bad = 0;
    for (char name[256]; std::fscanf(index, "%255s", name) == 1; ++n) bad += !check_file(directory + "/" + name);
    std::fclose(index);
    std::printf("%d files, %d differ\n", n, bad);
    return n == 0 || bad > 0;
}
