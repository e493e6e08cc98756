#include "library_results.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "backwards.hpp"

namespace stress
{

namespace
{

std::size_t at(std::int64_t i)
{
    return static_cast<std::size_t>(i);
}

void must(int status)
{
    if (status == HOL_OK) return;
    std::fprintf(stderr, "stress: the library refuses a chain that is allowed: %s\n", hol_error_message());
    std::abort();
}

void scatter(const vec &from, const std::vector<std::int64_t> &atoms, vec &to)
{
    for (std::size_t i = 0; i < atoms.size(); ++i)
        for (std::size_t x = 0; x < 3; ++x) to[3 * at(atoms[i]) + x] = from[3 * i + x];
}

vec gather(const vec &from, const std::vector<std::int64_t> &atoms)
{
    vec to(3 * atoms.size());
    for (std::size_t i = 0; i < atoms.size(); ++i)
        for (std::size_t x = 0; x < 3; ++x) to[3 * i + x] = from[3 * at(atoms[i]) + x];
    return to;
}

library_results blank(const arrangement &a)
{
    library_results o;
    const std::size_t bonds = at(a.n_bonds);
    o.lambda.assign(bonds, unwritten());
    o.velocity_lambda = o.position_lambda = o.lambda;
    o.g.assign(3 * at(a.n_atoms), unwritten());
    o.fixman = o.g;
    o.virial.assign(9, unwritten());
    o.log_det.assign(a.atoms.size(), unwritten());
    o.v = o.moved = a.v;
    o.r = a.drift;
    o.report = {};
    return o;
}

}  // namespace

double unwritten()
{
    const std::uint64_t pattern = UINT64_C(0x7ff4dead0000beef);
    double x;
    std::memcpy(&x, &pattern, sizeof x);
    return x;
}

bool is_unwritten(double x)
{
    const double pattern = unwritten();
    return std::memcmp(&x, &pattern, sizeof x) == 0;
}

bool same_bits(const vec &a, const vec &b)
{
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

arrangement arrange(const std::vector<const hostile_chain *> &parts, std::uint64_t shuffle)
{
    arrangement a;
    random_stream stream = random_seed(shuffle);
    std::int64_t gap = 0;
    for (const hostile_chain *c : parts) {
        a.n_bonds += c->n_bonds;
        a.n_atoms += c->n_bonds + 1;
    }
    if (shuffle) gap = random_integer(&stream, 0, 9);
    a.n_atoms += gap;
    std::vector<std::int64_t> order(at(a.n_atoms));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::int64_t>(i);
    if (shuffle)
        for (std::size_t i = order.size() - 1; i > 0; --i)
            std::swap(order[i], order[at(random_integer(&stream, 0, static_cast<std::int64_t>(i)))]);
    const std::size_t size = 3 * at(a.n_atoms);
    a.r.assign(size, unwritten());
    a.v = a.f = a.drift = a.r;
    vec mass(at(a.n_atoms), 1.0);
    std::size_t next = 0;
    for (const hostile_chain *c : parts) {
        std::vector<std::int64_t> atoms(order.begin() + static_cast<std::ptrdiff_t>(next),
                                        order.begin() + static_cast<std::ptrdiff_t>(next) + c->n_bonds + 1);
        next += atoms.size();
        scatter(c->r, atoms, a.r);
        scatter(c->v, atoms, a.v);
        scatter(c->f, atoms, a.f);
        scatter(drifted(*c), atoms, a.drift);
        for (std::size_t i = 0; i < atoms.size(); ++i) mass[at(atoms[i])] = c->mass[i];
        a.atoms.push_back(std::move(atoms));
    }
    hol_chains *chains = nullptr;
    must(hol_chains_create(a.n_atoms, mass.data(), &chains));
    a.chains.reset(chains);
    for (std::size_t c = 0; c < parts.size(); ++c)
        must(hol_chains_add(chains, parts[c]->n_bonds, a.atoms[c].data(), parts[c]->length.data()));
    return a;
}

library_results compute(const arrangement &a, double dt)
{
    library_results o = blank(a);
    const hol_chains *chains = a.chains.get();
    o.forces = hol_forces(chains, a.r.data(), a.v.data(), a.f.data(), o.lambda.data(), nullptr, o.g.data(), HOL_WRITE,
                          o.virial.data());
    o.metric = hol_metric(chains, a.r.data(), 1, o.log_det.data(), nullptr, nullptr, o.fixman.data(), HOL_WRITE);
    o.velocities = hol_project_velocities(chains, a.r.data(), o.v.data(), o.velocity_lambda.data(), nullptr);
    o.positions = hol_project_positions(chains, a.r.data(), o.r.data(), o.moved.data(), dt, o.position_lambda.data(), 0,
                                        nullptr, &o.report);
    return o;
}

library_results compute_in_views(const arrangement &a, double dt)
{
    library_results o = blank(a);
    const hol_chains *chains = a.chains.get();
    backwards r(a.r), v(a.v), f(a.f), g(o.g), fixman(o.fixman), projected(o.v), moved(o.moved), drift(o.r);
    o.forces = hol_forces_view(chains, r.input(), v.input(), f.input(), o.lambda.data(), nullptr, &g.view, HOL_WRITE,
                               o.virial.data());
    o.metric = hol_metric_view(chains, r.input(), 1, o.log_det.data(), nullptr, nullptr, &fixman.view, HOL_WRITE);
    o.velocities = hol_project_velocities_view(chains, r.input(), &projected.view, o.velocity_lambda.data(), nullptr);
    o.positions = hol_project_positions_view(chains, r.input(), &drift.view, &moved.view, dt, o.position_lambda.data(),
                                             0, nullptr, &o.report);
    g.give_back(o.g);
    fixman.give_back(o.fixman);
    projected.give_back(o.v);
    moved.give_back(o.moved);
    drift.give_back(o.r);
    return o;
}

library_results part_of(const library_results &all, const arrangement &a, std::size_t chain)
{
    library_results o = all;
    std::ptrdiff_t first = 0;
    for (std::size_t c = 0; c < chain; ++c) first += static_cast<std::ptrdiff_t>(a.atoms[c].size()) - 1;
    const std::ptrdiff_t last = first + static_cast<std::ptrdiff_t>(a.atoms[chain].size()) - 1;
    for (vec *x : {&o.lambda, &o.velocity_lambda, &o.position_lambda}) *x = vec(x->begin() + first, x->begin() + last);
    for (vec *x : {&o.g, &o.fixman, &o.v, &o.moved, &o.r}) *x = gather(*x, a.atoms[chain]);
    o.log_det.assign(1, all.log_det[chain]);
    return o;
}

}  // namespace stress
