#include "invariances.hpp"

#include <algorithm>
#include <cmath>

#include "checks.hpp"

namespace stress
{

namespace
{

std::size_t at(std::int64_t i)
{
    return static_cast<std::size_t>(i);
}

void scale(vec &x, double factor)
{
    for (double &y : x)
        if (!is_unwritten(y)) y *= factor;
}

bool near_the_ends(const vec &x)
{
    return std::any_of(x.begin(), x.end(), [](double y) { return y != 0 && std::fabs(y) < 1e-100; });
}

/**
 * Multipliers that die away along a chain end among denormal numbers, where scaling is not exact: these become zero. So
 * do those below 1e-80 of their largest, into which products go that may be denormal (docs/stability.md).
 */
void without_tails(library_results &o)
{
    for (vec *x : {&o.lambda, &o.g, &o.velocity_lambda, &o.position_lambda, &o.v, &o.moved, &o.r, &o.fixman}) {
        double least = 1e-200;
        for (double y : *x)
            if (!is_unwritten(y)) least = std::max(least, 1e-80 * std::fabs(y));
        for (double &y : *x)
            if (std::fabs(y) < least) y = 0;
    }
}

/** Units of mass, length and time that are 2^m, 2^l and 2^t of the old ones. */
void check_units(const hostile_chain &c, library_results alone, int m, int l, int t, verdict &out)
{
    if (near_the_ends(c.f) || near_the_ends(c.v)) return;  // where denormal numbers are met, scaling is not exact
    hostile_chain other = c;
    const double mass = std::ldexp(1, m), length = std::ldexp(1, l), time = std::ldexp(1, t);
    const double force = mass * length / (time * time), velocity = length / time;
    scale(other.mass, mass), scale(other.w, 1 / mass);
    scale(other.length, length), scale(other.r, length);
    scale(other.v, velocity), scale(other.f, force);
    other.dt = c.dt * time;
    library_results there = compute(arrange({&other}, 0), time);  // `alone` was made with a step of 1
    scale(there.lambda, length / force), scale(there.g, 1 / force);
    scale(there.fixman, length);  // kT stays 1
    scale(there.velocity_lambda, length / (force * time));
    scale(there.v, 1 / velocity);
    scale(there.position_lambda, length / force), scale(there.r, 1 / length), scale(there.moved, 1 / velocity);
    without_tails(alone);
    without_tails(there);
    check_same(alone, there, out);
}

void mirror(vec &x)
{
    for (std::size_t i = 0; i < x.size(); i += 3)
        if (!is_unwritten(x[i])) x[i] = 0 - x[i];
}

/** A velocity of -0 that the caller has may stay or become +0, which hangs on the sign of what is added to it. */
void without_signs_of_zeros(vec &x)
{
    for (double &y : x)
        if (y == 0) y = 0;
}

void check_mirror(const hostile_chain &c, library_results alone, verdict &out)
{
    hostile_chain other = c;
    mirror(other.r), mirror(other.v), mirror(other.f);
    library_results there = compute(arrange({&other}, 0), 1);
    for (vec *x : {&there.g, &there.fixman, &there.v, &there.r, &there.moved}) mirror(*x);
    for (library_results *o : {&alone, &there})
        for (vec *x : {&o->g, &o->fixman, &o->v, &o->r, &o->moved}) without_signs_of_zeros(*x);
    check_same(alone, there, out);
}

}  // namespace

hostile_chain reversed(const hostile_chain &c)
{
    hostile_chain o = c;
    const std::size_t n = at(c.n_bonds);
    std::reverse(o.mass.begin(), o.mass.end());
    std::reverse(o.w.begin(), o.w.end());
    std::reverse(o.length.begin(), o.length.end());
    for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t x = 0; x < 3; ++x) {
            o.r[3 * i + x] = c.r[3 * (n - i) + x];
            o.v[3 * i + x] = c.v[3 * (n - i) + x];
            o.f[3 * i + x] = c.f[3 * (n - i) + x];
        }
    return o;
}

hostile_chain turned(const hostile_chain &c)
{
    hostile_chain o = c;
    for (vec *x : {&o.r, &o.v, &o.f})
        for (std::size_t i = 0; i < x->size(); i += 3) {
            const double first = (*x)[i];
            (*x)[i] = (*x)[i + 1];
            (*x)[i + 1] = -(*x)[i + 2];
            (*x)[i + 2] = first;
        }
    return o;
}

void check_invariances(const std::vector<hostile_chain> &chains, std::uint64_t shuffle, std::vector<verdict> &out)
{
    std::vector<const hostile_chain *> parts;
    for (const hostile_chain &c : chains) parts.push_back(&c);
    const arrangement together = arrange(parts, shuffle);
    const library_results first = compute(together, 1), again = compute(together, 1),
                          views = compute_in_views(together, 1);
    hol_chains_set_threads(together.chains.get(), 3);
    const library_results threads = compute(together, 1);
    random_stream stream = random_seed(shuffle);
    for (std::size_t k = 0; k < chains.size(); ++k) {
        const library_results alone = compute(arrange({parts[k]}, 0), 1);
        for (const library_results *other : {&first, &again, &views, &threads}) {
            const library_results part = part_of(*other, together, k);
            check_same(alone, part, out[k]);
            check_outputs(chains[k], part, out[k]);
        }
        const auto exponent = [&] { return static_cast<int>(random_integer(&stream, -30, 30)); };
        const int m = exponent(), l = exponent(), t = exponent();
        check_units(chains[k], alone, m, l, t, out[k]);
        check_mirror(chains[k], alone, out[k]);
    }
    for (const library_results *other : {&again, &views, &threads})
        out[0].note(SAME_BITS, !same_bits(first.virial, other->virial) || !same_bits(first.lambda, other->lambda) ||
                                   !same_bits(first.g, other->g));
}

}  // namespace stress
