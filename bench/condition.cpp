// Error of the multipliers against the condition number of Z~, from right angles to light joints in straight chains.
#include <cmath>
#include <cstdio>

#include "methods/holonomic_chains.hpp"
#include "methods/methods.hpp"
#include "sections.hpp"

namespace bench {
namespace {

/// The condition number of the pool's chain in the middle.
double condition_of(const Problem &p) {
    const Handle handle = make_block(p, p.chains);
    hol_inverse *inverse = nullptr;
    double condition = 0;
    check(hol_inverse_create(handle.get(), p.chains / 2, p.r.data(), &inverse));
    const std::unique_ptr<hol_inverse, decltype(&hol_inverse_destroy)> owner(inverse, hol_inverse_destroy);
    check(hol_inverse_condition(inverse, &condition));
    return condition;
}

/// Chains of 64 bonds whose condition number grows along the list: turns from 90 degrees to small ones, then light
/// joints.
std::vector<Recipe> family(const Run &run) {
    std::vector<Recipe> list;
    auto add = [&list, &run](double from, double to, double light) {
        list.push_back(
            with_joints(single("light_joints", 64, run.extent == Extent::tiny ? 64 : 1280), light, from, to));
    };
    add(90, 90, 1);
    if (run.extent == Extent::tiny) return list;
    for (double turn : {60.0, 30.0, 15.0, 5.0}) add(0.8 * turn, turn, 1);
    const int step = run.full() ? 1 : 3;
    for (int digits = 1; digits <= 13; digits += step) add(0.5e-6, 1e-6, std::pow(10, -digits));
    return list;
}

}  // namespace

void condition_section(const Run &run) {
    for (const Recipe &recipe : family(run)) {
        const Problem p = make_problem(recipe);
        Methods list = {holonomic(Level::acceleration, p)};
        if (have_lapack()) list.push_back(direct_forces(p, "lapack-dptsv", "", lapack_dptsv()));
        list.push_back(direct_forces(p, "eigen-ldlt", "", eigen_ldlt()));
        list.push_back(direct_forces(p, "omega-recursion", "", omega_recursion()));
        char setting[40];
        std::snprintf(setting, sizeof setting, "condition %.2e", condition_of(p));
        for (Method &m : list) m.setting = setting;
        run.measure(Level::acceleration, p, list);
    }
}

}  // namespace bench
