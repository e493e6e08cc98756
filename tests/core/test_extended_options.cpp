// What calls of the extended-precision solver may ask for, and what it leaves alone.
#include <cmath>
#include <limits>

#include "extended_calls.hpp"
#include "extended_shapes.hpp"

using namespace extended_case;
using holonomic::AtomArray;
using holonomic::packed_array;

namespace
{

constexpr double epsilon = 2.220446049250313e-16;

bool same(const std::vector<double> &a, const std::vector<double> &b)
{
    return std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

struct step {
    calls c;
    std::vector<double> r, v;
    holonomic::PositionsCall call{};

    step(const molecule &m, double size) : c(m), r(m.r), v(m.v)
    {
        std::mt19937 random(8);
        std::uniform_real_distribution<double> uniform(-size, size);
        for (double &x : r) x += uniform(random);
        call.dt = 0.5;
        call.report = true;
        call.max_iterations = 50;
    }
    void go()
    {
        call.r_ref = packed_array(c.m.r.data());
        call.r = packed_array(r.data());
        call.v = packed_array(v.data());
        call.lambda = c.lambda.data();
        c.tally = empty_tally();
        c.run(call, solver::positions);
    }
};

void a_guess_saves_solves(const molecule &m)
{
    step first(m, 0.01);
    const std::vector<double> before = first.r;
    first.go();
    const std::vector<double> after = first.r, lambda = first.c.lambda;
    const std::int64_t solves = first.c.tally.iterations;
    first.r = before;
    first.v = m.v;
    first.call.guess = true;
    first.go();
    require(first.c.tally.n_bad == 0 && first.c.tally.iterations < solves, m.name, "a good guess saves nothing");
    for (std::size_t e = 0; e < after.size(); ++e)
        require(std::fabs(first.r[e] - after[e]) <= 64 * epsilon, m.name, "a guess changes the positions");
    // A guess that makes things worse is not used.
    first.r = before;
    first.v = m.v;
    for (double &x : first.c.lambda) x = 1e6;
    first.go();
    require(first.c.tally.n_bad == 0 && same(first.r, after) && same(first.c.lambda, lambda), m.name, "a bad guess");
}

void what_is_right_is_left_alone(const molecule &m)
{
    step s(m, 0);
    s.go();
    require(s.c.tally.n_bad == 0 && s.c.tally.n_corrected == 0, m.name, "right lengths are corrected");
    require(same(s.r, m.r) && same(s.v, m.v), m.name, "atoms are moved");
    for (const double x : s.c.lambda) require(x == 0 && !std::signbit(x), m.name, "multipliers of nothing");
    step tolerant(m, 1e-5);
    const std::vector<double> before = tolerant.r;
    tolerant.call.tolerance = 0.1;
    tolerant.go();
    require(tolerant.c.tally.n_corrected == 0 && same(tolerant.r, before), m.name, "within the tolerance");
    require(tolerant.c.tally.worst > 1e-9 && tolerant.c.tally.worst_chain == 0, m.name, "the error left");
}

void what_cant_be_done_changes_nothing(const molecule &m)
{
    step turned(m, 0);  // each bond is square to what it was
    for (int i = 0; i < m.n_atoms; ++i) {
        turned.c.m.r[3 * i] = i;
        turned.c.m.r[3 * i + 1] = turned.c.m.r[3 * i + 2] = 0;
        turned.r[3 * i] = turned.r[3 * i + 2] = 0;
        turned.r[3 * i + 1] = 2 * i;
    }
    const std::vector<double> r = turned.r, v = turned.v, lambda = turned.c.lambda;
    turned.go();
    require(turned.c.tally.n_bad == 1 && turned.c.tally.n_corrected == 0, m.name, "is not refused");
    require(same(turned.r, r) && same(turned.v, v) && same(turned.c.lambda, lambda), m.name, "something is written");
}

void numbers_that_are_none_are_refused(const molecule &m)
{
    const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
    for (const double x : bad)
        for (const int what : {0, 1, 2}) {
            calls c(m);
            (what == 0 ? c.m.r : what == 1 ? c.m.v : c.m.f)[4] = x;
            const std::vector<double> g = c.g, lambda = c.lambda;
            c.forces();
            require(c.tally.n_bad == 1 && same(c.g, g) && same(c.lambda, lambda), m.name, "not a number is taken");
        }
    step s(m, 0.01);
    s.r[5] = bad[0];
    const std::vector<double> r = s.r, v = s.v;
    s.go();
    require(s.c.tally.n_bad == 1 && same(s.r, r) && same(s.v, v), m.name, "positions that are not numbers are taken");
}

void forces_may_be_added(const molecule &m)
{
    calls plain(m), added(m);
    plain.forces();
    holonomic::ForcesCall call{};
    std::vector<double> tension(static_cast<std::size_t>(m.n_bonds));
    call.r = packed_array(added.m.r.data());
    call.v = packed_array(added.m.v.data());
    call.f = call.g = packed_array(added.m.f.data());  // in place
    call.tension = tension.data();
    call.add = call.virial = true;
    added.run(call, solver::forces);
    for (std::size_t e = 0; e < m.f.size(); ++e)
        require(added.m.f[e] == m.f[e] + plain.g[e], m.name, "a force is not added");
    quad virial[6] = {};
    for (int k = 0; k < m.n_bonds; ++k) {
        const quad3 d = m.bond(k);
        const double t = 2 * plain.lambda[k] * m.length[k];
        require(std::fabs(tension[k] - t) <= 4 * epsilon * std::fabs(t), m.name, "a tension");
        int n = 0;
        for (int a = 0; a < 3; ++a)
            for (int b = a; b < 3; ++b) virial[n++] -= 2 * quad(plain.lambda[k]) * d[a] * d[b];
    }
    for (int n = 0; n < 6; ++n)
        require(std::fabs(static_cast<double>(virial[n]) - added.tally.virial[n]) <=
                    1e-13 * (1 + std::fabs(added.tally.virial[n])),
                m.name, "the virial");
}

void two_dimensions_are_a_plane(const molecule &given)
{
    molecule m = given;
    for (int i = 0; i < m.n_atoms; ++i) m.r[3 * i + 2] = m.v[3 * i + 2] = m.f[3 * i + 2] = 0;
    m.measure();
    calls space(m), plane(m);
    space.forces();
    holonomic::ForcesCall call{};
    const auto flat = [](std::vector<double> &x) {
        AtomArray array = packed_array(x.data());
        array.z = nullptr;
        array.packed = false;
        return array;
    };
    for (int i = 0; i < m.n_atoms; ++i) plane.m.r[3 * i + 2] = plane.g[3 * i + 2] = 5;
    call.r = flat(plane.m.r);
    call.v = flat(plane.m.v);
    call.f = flat(plane.m.f);
    call.g = flat(plane.g);
    call.lambda = plane.lambda.data();
    plane.run(call, solver::forces);
    require(same(plane.lambda, space.lambda), m.name, "two dimensions differ from a plane");
    for (int i = 0; i < m.n_atoms; ++i) require(plane.g[3 * i + 2] == 5, m.name, "a third component is written");
}

}  // namespace

int main()
{
    unsigned seed = 700;
    for (const shape &s : shapes) {
        const molecule m(s.name, s.list, seed++, 0.5);
        if (m.n_bonds > 1) a_guess_saves_solves(m);
        what_is_right_is_left_alone(m);
        what_cant_be_done_changes_nothing(m);
        numbers_that_are_none_are_refused(m);
        forces_may_be_added(m);
        if (m.n_bonds <= 2 * m.n_atoms - 3) two_dimensions_are_a_plane(m);
    }
}
