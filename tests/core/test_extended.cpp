// the extended-precision solver of one molecule: against dense elimination in 113 bits, and what it refuses.
#define HOL_ISA double_double
#include "core/kernels/extended/verbs.hpp"

#include <cmath>

#include "extended_calls.hpp"
#include "extended_case.hpp"
#include "extended_shapes.hpp"

using namespace extended_case;
using holonomic::AtomArray;
using holonomic::packed_array;

namespace
{

constexpr double epsilon = 2.220446049250313e-16;

// The exact multipliers t = 2 lambda of A t = b, and what one rounding in each term does to them.
struct solution {
    std::vector<quad> t;
    std::vector<double> scale;
};

solution solve_exactly(const molecule &m, const std::vector<quad> &b, const std::vector<double> &terms)
{
    const matrix inverse = inverse_of(matrix_of(m));
    solution s;
    for (int k = 0; k < m.n_bonds; ++k) {
        quad t = 0;
        double scale = 0;
        for (int l = 0; l < m.n_bonds; ++l) {
            t += inverse[k][l] * b[l];
            scale += std::fabs(static_cast<double>(inverse[k][l])) * terms[l];
        }
        s.t.push_back(t);
        s.scale.push_back(scale);
    }
    return s;
}

double size(const quad3 &a)
{
    return std::fabs(static_cast<double>(a[0])) + std::fabs(static_cast<double>(a[1])) +
           std::fabs(static_cast<double>(a[2]));
}

void agree(const molecule &m, const std::vector<double> &lambda, const solution &exact, const char *what)
{
    for (int k = 0; k < m.n_bonds; ++k) {
        const double error = std::fabs(static_cast<double>(2 * quad(lambda[k]) - exact.t[k]));
        require(error <= 2 * epsilon * exact.scale[k], m.name, what);
    }
}

void forces_are_right(const molecule &m)
{
    calls c(m);
    c.forces();
    require(c.tally.n_bad == 0, m.name, "forces are refused");
    std::vector<quad> b;
    std::vector<double> terms;
    for (int k = 0; k < m.n_bonds; ++k) {
        const int i = m.pairs[2 * k], j = m.pairs[2 * k + 1];
        const quad3 d = m.bond(k), dv = m.difference(m.v, k);
        const quad3 fi = quad(m.w[i]) * m.atom(m.f, i), fj = quad(m.w[j]) * m.atom(m.f, j);
        b.push_back(dot(d, fj - fi) + dot(dv, dv));
        terms.push_back(size(d) * (size(fi) + size(fj)) + static_cast<double>(dot(dv, dv)));
    }
    const solution exact = solve_exactly(m, b, terms);
    agree(m, c.lambda, exact, "lambda of the forces");
    for (int i = 0; i < m.n_atoms; ++i) {
        quad3 sum = {0, 0, 0};
        double scale = 0;
        for (int k = 0; k < m.n_bonds; ++k) {
            if (m.pairs[2 * k] != i && m.pairs[2 * k + 1] != i) continue;
            sum = sum + (m.pairs[2 * k] == i ? exact.t[k] : -exact.t[k]) * m.bond(k);
            scale += exact.scale[k] * size(m.bond(k));
        }
        require(size(sum - m.atom(c.g, i)) <= 4 * epsilon * scale, m.name, "G");
    }
}

void velocities_are_right(const molecule &m)
{
    calls c(m);
    holonomic::VelocitiesCall call{};
    call.r = packed_array(c.m.r.data());
    call.v = packed_array(c.m.v.data());
    call.lambda = c.lambda.data();
    c.run(call, solver::velocities);
    require(c.tally.n_bad == 0, m.name, "velocities are refused");
    std::vector<quad> b;
    std::vector<double> terms;
    for (int k = 0; k < m.n_bonds; ++k) {
        b.push_back(dot(m.bond(k), m.difference(m.v, k)));
        terms.push_back(size(m.bond(k)) * (size(m.atom(m.v, m.pairs[2 * k])) + size(m.atom(m.v, m.pairs[2 * k + 1]))));
    }
    agree(m, c.lambda, solve_exactly(m, b, terms), "multipliers of the velocities");
    for (int k = 0; k < m.n_bonds; ++k)
        require(std::fabs(static_cast<double>(dot(m.bond(k), c.m.difference(c.m.v, k)))) <= 8 * epsilon * terms[k],
                m.name, "a bond still changes its length");
}

void right_hand_sides_are_solved(const molecule &m)
{
    calls c(m);
    holonomic::SolveCall call{};
    call.r = packed_array(c.m.r.data());
    call.rhs = c.m.length.data();
    call.lambda = c.lambda.data();
    c.run(call, solver::solve);
    std::vector<quad> b;
    for (int k = 0; k < m.n_bonds; ++k) b.push_back(quad(m.length[k]) / 2);  // Z lambda = rhs, A 2 lambda = rhs / 2
    agree(m, c.lambda, solve_exactly(m, b, c.m.length), "multipliers of given right-hand sides");
}

void positions_are_right(const molecule &m)
{
    calls c(m);
    std::vector<double> moved = m.r, velocity = m.v;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-0.01, 0.01);
    for (double &x : moved) x += uniform(random);
    const std::vector<double> before = moved;
    holonomic::PositionsCall call{};
    call.r_ref = packed_array(c.m.r.data());
    call.r = packed_array(moved.data());
    call.v = packed_array(velocity.data());
    call.lambda = c.lambda.data();
    call.dt = 0.5;
    call.report = true;
    call.max_iterations = 50;
    c.run(call, solver::positions);
    require(c.tally.n_bad == 0 && c.tally.n_corrected == 1, m.name, "positions are refused");
    for (int k = 0; k < m.n_bonds; ++k) {
        molecule now = m;
        now.r = moved;
        const quad a = m.length[k], error = dot(now.bond(k), now.bond(k)) / (a * a) - 1;
        require(std::fabs(static_cast<double>(error)) <= 8 * epsilon * (1 + 2 / m.length[k]), m.name, "lengths");
    }
    for (int i = 0; i < m.n_atoms; ++i) {
        quad3 g = {0, 0, 0};
        double scale = 2;
        for (int k = 0; k < m.n_bonds; ++k) {
            if (m.pairs[2 * k] != i && m.pairs[2 * k + 1] != i) continue;
            g = g + (m.pairs[2 * k] == i ? 2 : -2) * quad(c.lambda[k]) * m.bond(k);
            scale += 0.5 * m.w[i] * std::fabs(c.lambda[k]) * size(m.bond(k));
        }
        const quad3 by = quad(0.25) * quad(m.w[i]) * g;
        require(size(m.atom(before, i) + by - m.atom(moved, i)) <= 4 * epsilon * scale, m.name, "moves");
        require(size(m.atom(m.v, i) + quad(2) * by - m.atom(velocity, i)) <= 8 * epsilon * scale, m.name, "rates");
    }
}

// A molecule across the boundary of a box, in floats, one array per component.
void layouts_and_boxes_change_nothing()
{
    molecule m("lariat", shapes[8].list, 9, 1);
    for (double &x : m.r) x = static_cast<float>(x);  // so that 8 x is a power of two away, and x + 8 a float
    for (double &x : m.r) x = std::round(x * 1024) / 1024;
    m.measure();
    calls plain(m), boxed(m);
    plain.forces();
    std::vector<float> x, y, z;
    for (int i = 0; i < m.n_atoms; ++i) {
        x.push_back(static_cast<float>(m.r[3 * i] + (i % 3 == 0 ? 8 : 0)));
        y.push_back(static_cast<float>(m.r[3 * i + 1] - (i % 2 == 0 ? 8 : 0)));
        z.push_back(static_cast<float>(m.r[3 * i + 2]));
    }
    holonomic::ForcesCall call{};
    const auto array = [](std::vector<float> &component) { return reinterpret_cast<char *>(component.data()); };
    call.r = AtomArray{array(x), array(y), array(z), sizeof(float), true, false};
    call.v = packed_array(boxed.m.v.data());
    call.f = packed_array(boxed.m.f.data());
    call.lambda = boxed.lambda.data();
    call.box.lattice = holonomic::Box::orthorhombic;
    for (int c = 0; c < 3; ++c) {
        call.box.h[4 * c] = 8;
        call.box.inverse[4 * c] = 0.125;
    }
    boxed.run(call, solver::forces);
    for (int k = 0; k < m.n_bonds; ++k) require(plain.lambda[k] == boxed.lambda[k], m.name, "a box changes lambda");
}

void is_refused(const char *name, const bonds &list, const std::vector<double> &r, const std::vector<double> &w)
{
    molecule m(name, list, 11, 0);
    m.r = r;
    if (!w.empty()) m.w = w;
    m.measure();
    calls c(m);
    c.forces();
    require(c.tally.n_bad == 1 && c.tally.first_bad == 0, name, "is not refused");
    for (const double x : c.lambda) require(x == 77, name, "lambda is written");
    for (const double x : c.g) require(x == 78, name, "G is written");
    for (const double x : c.tally.virial) require(x == 0, name, "the virial is written");
}

void dependent_bonds_are_refused()
{
    is_refused("three atoms on a line", ring(3), {0, 0, 0, 1, 0, 0, 2.5, 0, 0}, {});
    is_refused("three atoms on an inclined line", ring(3), {0, 0, 0, 0.1, 0.2, 0.3, 0.3, 0.6, 0.9}, {});
    is_refused("square with both diagonals", with(ring(4), {{0, 2}, {1, 3}}),
               {0.1, 0.2, 0.3, 1.1, 0.2, 0.3, 1.1, 1.2, 0.3, 0.1, 1.2, 0.3}, {});
    is_refused("taut between fixed atoms", {{0, 1}, {1, 2}, {2, 3}, {2, 4}},
               {0, 0, 0, 1, 1, 0, 2, 2, 0, 3, 3, 0, 2, 2, 1}, {0, 1, 2, 0, 1});
    is_refused("four fixed neighbours", star(4), {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, -1, -1}, {1, 0, 0, 0, 0});
    is_refused("a bond of no length", {{0, 1}, {0, 2}, {0, 3}}, {0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0}, {});
}

void atoms_of_many_bonds_are_right()
{
    for (const int arms : {17, 30, 70}) {
        molecule m("star of many arms", with(star(arms), {{1, arms + 1}, {2, arms + 2}}), 31, arms < 60 ? 4.0 : 1.0);
        m.w[3] = m.w[static_cast<std::size_t>(arms) + 1] = 0;
        if (arms > 60) m.w[7] = m.w[8] = 0;  // three rigid arms, the most that an atom can have
        forces_are_right(m);
        velocities_are_right(m);
    }
}

void shared_atoms_are_not_written()
{
    molecule m("brush", {{0, 1}, {1, 2}, {1, 3}}, 4, 0.5);
    m.w[0] = 0;
    calls c(m);
    const unsigned char shared[] = {1, 0, 0, 0};
    c.lane.shared = shared;
    c.forces();
    require(c.tally.n_bad == 0 && c.g[0] == 78 && c.g[3] != 78, m.name, "G of a shared atom");
}

}  // namespace

int main()
{
    unsigned seed = 1;
    for (const shape &s : shapes)
        for (const double decades : {0.0, 1.0, 3.0}) {
            molecule m(s.name, s.list, seed++, decades);
            if (decades == 3 && seed % 2 == 0)
                for (int i = 0; i < m.n_atoms; ++i) {
                    int n = 0;
                    for (const std::int32_t p : m.pairs) n += p == i;
                    if (n == 1 && m.n_bonds > 4 && i % 3 == 0) m.w[i] = 0;
                }
            forces_are_right(m);
            velocities_are_right(m);
            right_hand_sides_are_solved(m);
            if (decades < 3) positions_are_right(m);
        }
    layouts_and_boxes_change_nothing();
    dependent_bonds_are_refused();
    atoms_of_many_bonds_are_right();
    shared_atoms_are_not_written();
}
