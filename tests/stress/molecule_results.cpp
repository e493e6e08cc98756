#include "molecule_results.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "backwards.hpp"
#include "molecule_reference.hpp"
#include "random.h"

namespace stress
{

namespace
{

void scatter(const numbers &from, const std::vector<std::size_t> &atoms, numbers &to)
{
    for (std::size_t i = 0; i < atoms.size(); ++i)
        for (std::size_t x = 0; x < 3; ++x) to[3 * atoms[i] + x] = from[3 * i + x];
}

template <class T>
void shuffled(std::vector<T> &list, random_stream &stream)
{
    for (std::size_t i = list.size(); i-- > 1;)
        std::swap(list[i], list[static_cast<std::size_t>(random_integer(&stream, 0, static_cast<std::int64_t>(i)))]);
}

/** Which molecule each atom of the arrays belongs to; parts.size() for none. */
std::vector<std::size_t> owners(const std::vector<const hostile_molecule *> &parts, std::uint64_t shuffle,
                                random_stream &stream)
{
    std::vector<std::size_t> owner;
    for (std::size_t m = 0; m < parts.size(); ++m) owner.insert(owner.end(), parts[m]->w.size(), m);
    if (shuffle == 0) return owner;
    owner.insert(owner.end(), static_cast<std::size_t>(random_integer(&stream, 0, 9)), parts.size());
    if (random_uniform(&stream) < 0.7) shuffled(owner, stream);
    return owner;
}

struct listed_bond {
    std::size_t molecule, bond;
};

molecule_results blank_results(const placement &a)
{
    molecule_results o;
    o.lambda.assign(a.rhs.size(), blank());
    o.solved = o.mu = o.position_lambda = o.log_det = o.log_det_z = o.kept_lambda = o.kept_solved = o.lambda;
    o.g.assign(a.r.size(), blank());
    o.fixman = o.kept_g = o.g;
    o.virial.assign(9, blank());
    o.v = o.moved = a.v;
    o.r = a.drift;
    return o;
}

/** With factors that are kept: the first failure of three calls. Two right-hand sides of one molecule share a vector.
 */
void compute_kept(const placement &a, molecule_results &o)
{
    hol_factors *made = nullptr;
    o.kept = hol_factors_create(a.chains.get(), &made);
    if (o.kept != HOL_OK) return;
    const int update = hol_factors_update(made, a.r.data());
    const int forces = hol_factors_forces(made, a.v.data(), a.f.data(), o.kept_lambda.data(), nullptr, o.kept_g.data(),
                                          HOL_WRITE, nullptr);
    const auto n = static_cast<std::ptrdiff_t>(a.rhs.size());
    numbers rhs(a.rhs), solved(2 * a.rhs.size(), blank());
    rhs.insert(rhs.end(), a.rhs.begin(), a.rhs.end());
    const int solve = hol_factors_solve(made, 2, rhs.data(), solved.data(), nullptr, HOL_WRITE, nullptr);
    o.kept_solved.assign(solved.begin() + n, solved.end());
    o.kept = update != HOL_OK ? update : forces != HOL_OK ? forces : solve;
    hol_factors_destroy(made);
}

/** From values per molecule to values per bond. */
void spread(const placement &a, const numbers &of_molecule, numbers &of_bond)
{
    for (std::size_t k = 0; k < of_bond.size(); ++k)
        of_bond[k] = a.molecule_of_bond[k] < 0 ? 0 : of_molecule[static_cast<std::size_t>(a.molecule_of_bond[k])];
}

}  // namespace

double blank()
{
    const std::uint64_t pattern = UINT64_C(0x7ff4dead0000beef);
    double x;
    std::memcpy(&x, &pattern, sizeof x);
    return x;
}

bool is_blank(double x)
{
    const double pattern = blank();
    return std::memcmp(&x, &pattern, sizeof x) == 0;
}

bool identical(const numbers &a, const numbers &b)
{
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

placement place(const std::vector<const hostile_molecule *> &parts, std::uint64_t shuffle)
{
    placement a;
    random_stream stream = random_seed(shuffle);
    const std::vector<std::size_t> owner = owners(parts, shuffle, stream);
    a.atoms.resize(parts.size());
    a.bonds.resize(parts.size());
    numbers mass(owner.size(), 1.0), length;
    for (std::size_t i = 0; i < owner.size(); ++i)
        if (owner[i] < parts.size()) {
            mass[i] = parts[owner[i]]->mass[a.atoms[owner[i]].size()];
            a.atoms[owner[i]].push_back(i);
        }
    a.r.assign(3 * owner.size(), blank());
    a.v = a.f = a.drift = a.r;
    std::vector<listed_bond> list;
    for (std::size_t m = 0; m < parts.size(); ++m) {
        scatter(parts[m]->r, a.atoms[m], a.r);
        scatter(parts[m]->v, a.atoms[m], a.v);
        scatter(parts[m]->f, a.atoms[m], a.f);
        scatter(parts[m]->drifted(), a.atoms[m], a.drift);
        a.bonds[m].resize(parts[m]->length.size());
        for (std::size_t k = 0; k < parts[m]->length.size(); ++k) list.push_back({m, k});
    }
    if (shuffle) shuffled(list, stream);
    std::vector<std::int64_t> pairs;
    for (std::size_t k = 0; k < list.size(); ++k) {
        const hostile_molecule &m = *parts[list[k].molecule];
        const std::vector<std::size_t> &atoms = a.atoms[list[k].molecule];
        std::size_t ends[2];
        for (std::size_t e = 0; e < 2; ++e) ends[e] = atoms[static_cast<std::size_t>(m.pairs[2 * list[k].bond + e])];
        if (shuffle && random_uniform(&stream) < 0.5) std::swap(ends[0], ends[1]);
        for (std::size_t e : ends) pairs.push_back(static_cast<std::int64_t>(e));
        length.push_back(m.length[list[k].bond]);
        a.bonds[list[k].molecule][list[k].bond] = k;
        a.rhs.push_back(right_hand_side(m)[list[k].bond]);
    }
    hol_chains *chains = nullptr;
    a.status = hol_chains_create(static_cast<std::int64_t>(owner.size()), mass.data(), &chains);
    a.chains.reset(chains);
    if (a.status == HOL_OK)
        a.status = hol_chains_add_bonds(chains, static_cast<std::int64_t>(list.size()), pairs.data(), length.data());
    a.molecule_of_bond.assign(list.size(), -1);
    if (a.status == HOL_OK) hol_chains_molecules_of_bonds(chains, a.molecule_of_bond.data());
    return a;
}

molecule_results compute(const placement &a, double dt)
{
    molecule_results o = blank_results(a);
    const hol_chains *chains = a.chains.get();
    const std::size_t n = static_cast<std::size_t>(hol_chains_n_molecules(chains));
    numbers log_det(n, blank()), log_det_z(n, blank());
    o.forces = hol_forces(chains, a.r.data(), a.v.data(), a.f.data(), o.lambda.data(), nullptr, o.g.data(), HOL_WRITE,
                          o.virial.data());
    o.solve = hol_solve(chains, a.r.data(), a.rhs.data(), o.solved.data(), nullptr, HOL_WRITE, nullptr);
    compute_kept(a, o);
    o.metric = hol_metric(chains, a.r.data(), 1, log_det.data(), log_det_z.data(), nullptr, o.fixman.data(), HOL_WRITE);
    o.velocities = hol_project_velocities(chains, a.r.data(), o.v.data(), o.mu.data(), nullptr);
    o.positions = hol_project_positions(chains, a.r.data(), o.r.data(), o.moved.data(), dt, o.position_lambda.data(), 0,
                                        nullptr, nullptr);
    spread(a, log_det, o.log_det);
    spread(a, log_det_z, o.log_det_z);
    return o;
}

molecule_results compute_in_views(const placement &a, double dt)
{
    molecule_results o = blank_results(a);
    const hol_chains *chains = a.chains.get();
    const std::size_t n = static_cast<std::size_t>(hol_chains_n_molecules(chains));
    numbers log_det(n, blank()), log_det_z(n, blank());
    backwards r(a.r), v(a.v), f(a.f), g(o.g), fixman(o.fixman), projected(o.v), moved(o.moved), drift(o.r);
    o.forces = hol_forces_view(chains, r.input(), v.input(), f.input(), o.lambda.data(), nullptr, &g.view, HOL_WRITE,
                               o.virial.data());
    o.solve = hol_solve_view(chains, r.input(), a.rhs.data(), o.solved.data(), nullptr, HOL_WRITE, nullptr);
    compute_kept(a, o);
    o.metric =
        hol_metric_view(chains, r.input(), 1, log_det.data(), log_det_z.data(), nullptr, &fixman.view, HOL_WRITE);
    o.velocities = hol_project_velocities_view(chains, r.input(), &projected.view, o.mu.data(), nullptr);
    o.positions = hol_project_positions_view(chains, r.input(), &drift.view, &moved.view, dt, o.position_lambda.data(),
                                             0, nullptr, nullptr);
    g.give_back(o.g);
    fixman.give_back(o.fixman);
    projected.give_back(o.v);
    moved.give_back(o.moved);
    drift.give_back(o.r);
    spread(a, log_det, o.log_det);
    spread(a, log_det_z, o.log_det_z);
    return o;
}

molecule_results part_of(const molecule_results &all, const placement &a, std::size_t molecule)
{
    molecule_results o = all;
    for (numbers *x :
         {&o.lambda, &o.solved, &o.mu, &o.position_lambda, &o.log_det, &o.log_det_z, &o.kept_lambda, &o.kept_solved}) {
        const numbers from = *x;
        x->clear();
        for (const std::size_t k : a.bonds[molecule]) x->push_back(from[k]);
    }
    for (numbers *x : {&o.g, &o.fixman, &o.v, &o.moved, &o.r, &o.kept_g}) {
        const numbers from = *x;
        x->clear();
        for (const std::size_t i : a.atoms[molecule])
            x->insert(x->end(), from.begin() + static_cast<std::ptrdiff_t>(3 * i),
                      from.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
    }
    return o;
}

}  // namespace stress
