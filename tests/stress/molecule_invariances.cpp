#include <cmath>

#include "molecule_checks.hpp"
#include "random.h"

namespace stress
{

void scale(numbers &x, double factor)
{
    for (double &y : x)
        if (!is_blank(y)) y *= factor;
}

void mirror(numbers &x)
{
    for (std::size_t i = 0; i < x.size(); i += 3)
        if (!is_blank(x[i])) x[i] = 0 - x[i];
}

void without_signs_of_zeros(molecule_results &o)
{
    constexpr double least = 1e-270;
    for (numbers *x : {&o.lambda, &o.solved, &o.mu, &o.position_lambda, &o.g, &o.fixman, &o.v, &o.r, &o.moved})
        for (double &y : *x)
            if (std::fabs(y) < least) y = 0;
}

void check_same(const molecule_results &one, const molecule_results &other, molecule_quantity q, molecule_verdict &out)
{
    const numbers molecule_results::*const all[] = {&molecule_results::lambda,   &molecule_results::solved,
                                                    &molecule_results::mu,       &molecule_results::position_lambda,
                                                    &molecule_results::g,        &molecule_results::fixman,
                                                    &molecule_results::v,        &molecule_results::r,
                                                    &molecule_results::moved,    &molecule_results::log_det,
                                                    &molecule_results::log_det_z};
    for (const auto member : all) {
        if (q == M_UNITS && member == &molecule_results::log_det_z) continue;  // hangs on the units
        out.note(q, !identical(one.*member, other.*member));
    }
}

namespace
{

/** Units of mass, length and time that are 2^m, 2^l and 2^t of the old ones. `alone` was made with a step of 1. */
void check_units(const hostile_molecule &c, molecule_results alone, int m, int l, int t, molecule_verdict &out)
{
    hostile_molecule other = c;
    const double mass = std::ldexp(1, m), length = std::ldexp(1, l), time = std::ldexp(1, t);
    const double force = mass * length / (time * time), velocity = length / time;
    scale(other.mass, mass), scale(other.w, 1 / mass);
    scale(other.length, length), scale(other.r, length);
    scale(other.v, velocity), scale(other.f, force);
    other.dt = c.dt * time;
    placement a = place({&other}, 0);
    scale(a.rhs, 1 / (length * length));  // it was made from the lengths
    molecule_results there = compute(a, time);
    scale(there.lambda, length / force), scale(there.g, 1 / force);
    scale(there.solved, length * length / mass), scale(there.fixman, length);  // kT stays 1
    scale(there.mu, length / (force * time));
    scale(there.v, 1 / velocity);
    scale(there.position_lambda, length / force), scale(there.r, 1 / length), scale(there.moved, 1 / velocity);
    without_signs_of_zeros(alone);
    without_signs_of_zeros(there);
    check_same(alone, there, M_UNITS, out);
}

void check_mirror(const hostile_molecule &c, molecule_results alone, molecule_verdict &out)
{
    hostile_molecule other = c;
    mirror(other.r), mirror(other.v), mirror(other.f);
    molecule_results there = compute(place({&other}, 0), 1);
    for (numbers *x : {&there.g, &there.fixman, &there.v, &there.r, &there.moved}) mirror(*x);
    without_signs_of_zeros(alone);
    without_signs_of_zeros(there);
    check_same(alone, there, M_UNITS, out);
}

}  // namespace

void check_invariances(const std::vector<hostile_molecule> &molecules, std::uint64_t shuffle,
                       std::vector<molecule_verdict> &out)
{
    std::vector<const hostile_molecule *> parts;
    for (const hostile_molecule &m : molecules) parts.push_back(&m);
    const placement together = place(parts, shuffle);
    if (together.status != HOL_OK) return;  // one of them has more constraints than freedoms
    const molecule_results first = compute(together, 1), again = compute(together, 1),
                           views = compute_in_views(together, 1);
    hol_chains_set_threads(together.chains.get(), 3);
    const molecule_results threads = compute(together, 1);
    random_stream stream = random_seed(shuffle);
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const molecule_results alone = compute(place({parts[k]}, 0), 1);
        for (const molecule_results *other : {&first, &again, &views, &threads}) {
            const molecule_results part = part_of(*other, together, k);
            check_same(alone, part, M_SAME_BITS, out[k]);
            check_outputs(molecules[k], part, out[k]);
        }
        const auto exponent = [&] { return static_cast<int>(random_integer(&stream, -20, 20)); };
        const int m = exponent(), l = exponent(), t = exponent();
        check_units(molecules[k], alone, m, l, t, out[k]);
        check_mirror(molecules[k], alone, out[k]);
    }
    // What is kept adds the pulls on an atom in the order in which the set has its bonds.
    for (const molecule_results *other : {&again, &views, &threads})
        for (const auto member : {&molecule_results::virial, &molecule_results::kept_lambda,
                                  &molecule_results::kept_solved, &molecule_results::kept_g})
            out[0].note(M_SAME_BITS, !identical(first.*member, other->*member));
}

}  // namespace stress
