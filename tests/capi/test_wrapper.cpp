// holonomic.hpp: what it owns, which sizes it refuses, and what its exceptions say.
#include <holonomic.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

static int failures = 0;
#define EXPECT(what) ((what) ? (void)0 : (void)(++failures, std::printf("line %d: not so: %s\n", __LINE__, #what)))

template <class Call>
static holonomic::Error refused(const Call &call)
{
    try {
        call();
    } catch (const holonomic::Error &error) {
        return error;
    }
    ++failures;
    std::printf("nothing was refused\n");
    return holonomic::Error("");
}

int main()
{
    const std::vector<double> masses = {INFINITY, 1, 1, 1}, lengths = {1, 1, 1};
    const std::array<int64_t, 6> pairs = {0, 1, 1, 2, 2, 3};
    std::vector<double> r = {0, 0, 0, 0, 0, -1, 0, 0, -2, 0, 0, -3}, f(12, 0.0), g(12), tension(3);
    for (int i = 0; i < 4; ++i) f[3 * i + 2] = -10;

    holonomic::Chains hanging(masses);
    hanging.add_bonds(pairs, lengths);
    holonomic::Outputs out;
    out.tension = tension;
    out.g = g;
    hanging.forces(r, {}, f, out);
    EXPECT(std::fabs(tension[0] - 30) < 1e-12 && std::fabs(g[5] - 10) < 1e-12);
    EXPECT(hanging.n_molecules() == 1 && hanging.degrees_of_freedom() == 6);

    holonomic::Chains copy = hanging, moved = std::move(copy);
    copy = moved;
    const double twice[3] = {2, 2, 2};
    moved.set_lengths(twice);
    EXPECT(hanging.violation(r).length < 1e-15 && moved.violation(r).length > 0.5 && copy.violation(r).length < 1e-15);

    holonomic::Factors factors(hanging);
    EXPECT(refused([&] { factors.forces({}, f, out); }).status == HOL_ERR_STATE);
    factors.update(r);
    tension.assign(3, 0.0);
    factors.forces({}, f, out);
    EXPECT(std::fabs(tension[0] - 30) < 1e-12);
    std::vector<double> sides = {4, 0, 0, 0, 0, 4}, lambda(6), one(3);
    factors.solve(2, sides, lambda);
    holonomic::Outputs alone;
    alone.lambda = one;
    hanging.solve(r, {sides.data() + 3, 3}, alone);
    for (int k = 0; k < 3; ++k) EXPECT(std::fabs(lambda[3 + k] - one[k]) < 1e-15);

    const std::vector<double> before = r;
    r[3] = 0.05;
    std::vector<double> v(12, 0.1);
    EXPECT(hanging.project_positions(before, r, 0.1, v).n_corrected == 1);
    hanging.project_velocities(r, v);
    EXPECT(hanging.violation(r, v).rate < 1e-14);

    std::vector<double> few(5);
    EXPECT(refused([&] { hanging.forces(few, {}, {}, out); }).status == HOL_ERR_VALUE);
    f[7] = NAN;
    const holonomic::Error bad = refused([&] { hanging.forces(r, {}, f, out); });
    EXPECT(bad.status == HOL_ERR_NOT_FINITE && bad.molecule == 0 && bad.atom == 2 && bad.n_bad == 1);
    EXPECT(refused([&] { hanging.add_bonds(pairs, few); }).status == HOL_ERR_VALUE);
    EXPECT(refused([&] { hanging.forces({}, {}, {}, out); }).status == HOL_ERR_NULL);
    holonomic::Chains none(nullptr);
    none.add_bonds({}, {});
    none.forces({}, {}, {}, {});
    return failures;
}
