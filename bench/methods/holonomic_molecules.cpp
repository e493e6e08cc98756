// The library through its public header, for molecules of any topology given as a list of bonds.
#include <memory>

#include "../errors.hpp"
#include "bond_list.hpp"
#include "graph_methods.hpp"
#include "methods.hpp"

namespace bench {
namespace {

void call(Level level, const Molecules &m, const hol_chains *chains, State &s, double *lambda) {
    if (level == Level::acceleration)
        check(hol_forces(chains, m.r.data(), m.v.data(), m.f.data(), lambda, nullptr, s.g.data(), HOL_WRITE, nullptr));
    else if (level == Level::velocity)
        check(hol_project_velocities(chains, m.r.data(), s.v.data(), lambda, nullptr));
    else
        check(hol_project_positions(chains, m.r.data(), s.r.data(), s.v.data(), m.dt, lambda, 0, nullptr, nullptr));
}

Method made(Level level, const Molecules &m, const std::string &setting, const std::shared_ptr<Handle> &handle) {
    return {"holonomic", setting, [level, &m, handle](State &s) { call(level, m, handle->get(), s, s.lambda.data()); }};
}

}  // namespace

Method holonomic(Level level, const Molecules &m, int threads) {
    Method method = made(level, m, "default", std::make_shared<Handle>(make_handle(BondList(m), threads)));
    method.threads = threads;
    return method;
}

Method holonomic_tolerance(const Molecules &m, double tolerance) {
    auto handle = std::make_shared<Handle>(make_handle(BondList(m), 1));
    check(hol_chains_set_tolerance(handle->get(), tolerance));
    return made(Level::position, m, tolerance_setting(tolerance), handle);
}

Method holonomic_any_order(Level level, const Molecules &m) {
    BondList bonds(m);
    const std::vector<std::size_t> place = bonds.shuffle_bonds();
    auto handle = std::make_shared<Handle>(make_handle(bonds, 1));
    auto lambda = std::make_shared<std::vector<double>>(bonds.lengths.size());
    Method method = made(level, m, "bonds in any order", handle);
    method.call = [level, &m, handle, lambda](State &s) { call(level, m, handle->get(), s, lambda->data()); };
    method.for_error = [call = method.call, lambda, place](State &s) {
        call(s);
        for (std::size_t k = 0; k < place.size(); ++k) s.lambda[k] = (*lambda)[place[k]];
    };
    return method;
}

Method holonomic_chains_instead(Level level, const Molecules &m) {
    const auto bonds = static_cast<std::int64_t>(m.all_bonds());
    Recipe recipe = batch(level == Level::position ? "coil" : "melt", bonds / m.bonds, m.bonds);
    recipe.general_masses = true;
    recipe.decades = 1;
    const auto p = std::make_shared<const Problem>(make_problem(recipe));
    const auto state = std::make_shared<State>(*p, level);
    const Method inner = holonomic(level, *p);
    // Times are per bond of the scene.
    Method method = {"holonomic", "chains instead", [p, state, inner](State &) { inner.call(*state); }};
    method.before = [p, state, level](State &) { state->restore(*p, level); };
    method.own_error = [p, state, level] { return Reference(*p, level, nullptr, 2000).error(*state); };
    return method;
}

}  // namespace bench
