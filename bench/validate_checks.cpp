// The checks of positions against lengths (hol_chains_set_checks) refuse no scene that is measured, in any call of a
// run, nor one whose reference is a thousandth of a bond off, as some barostats leave it.
#include <algorithm>

#include "methods/bond_list.hpp"
#include "random.h"
#include "validate.hpp"

namespace bench {
namespace {

/// Whether a call refuses the scene for its lengths: 0 or 1.
int refused(const hol_chains *chains, const Scene &scene, const std::vector<double> &r_ref) {
    std::vector<double> r = scene.drifted, v = scene.v;
    const int at_once = hol_chains_check(chains, r_ref.data(), HOL_BOX),
              step = hol_project_positions(chains, r_ref.data(), r.data(), v.data(), scene.dt, nullptr, 0, nullptr,
                                           nullptr);
    return at_once != HOL_OK || step == HOL_ERR_LENGTHS;
}

void expect_accepted(const std::string &name, const Scene &scene, hol_chains *chains, const double *shortest_bond) {
    check(hol_chains_set_checks(chains, HOL_ALWAYS));
    expect(name + ": refused for its lengths", refused(chains, scene, scene.r), 0, 0);
    std::vector<double> off = scene.r;
    random_stream s = random_seed(11);
    for (double &x : off) x += 1e-3 * *shortest_bond * (2 * random_uniform(&s) - 1);
    expect(name + ": refused with a reference 1e-3 off", refused(chains, scene, off), 0, 0);
}

void chains_of(Recipe recipe, const std::string &what) {
    const Problem p = make_problem(recipe);
    const Handle chains = make_block(p, p.chains);
    expect_accepted(recipe.name + what, p, chains.get(), &*std::min_element(p.length.begin(), p.length.end()));
}

void molecules_of(const Molecules &m) {
    const BondList bonds(m);
    const Handle chains = make_handle(bonds, 1);
    expect_accepted(m.name, m, chains.get(), &*std::min_element(bonds.lengths.begin(), bonds.lengths.end()));
}

}  // namespace

void validate_checks() {
    for (const char *name : {"coil", "tetrahedral", "straight5", "light_joints", "fixed_ends", "melt"}) {
        for (const std::int64_t bonds : {1, 3, 100, 1000}) {
            if (bonds == 1 && name == std::string("fixed_ends")) continue;  // nothing that can move
            const std::string size = " of " + std::to_string(bonds);
            chains_of(batch(name, 2000 / bonds, bonds), size);
            Recipe recipe = batch(name, 2000 / bonds, bonds);
            recipe.general_masses = recipe.general_lengths = true;
            chains_of(recipe, size + ", general");
        }
    }
    for (int which = 0; which < 3; ++which) {
        Recipe recipe = batch("coil", 20, 100);
        recipe.flat = which == 0;
        recipe.orthogonal = which == 1;
        recipe.fixed_every = which == 2 ? 10 : 0;
        chains_of(recipe, which == 0 ? ", flat" : which == 1 ? ", right angles" : ", fixed atoms");
    }
    for (const Molecules &m : validated_scenes()) molecules_of(m);
    for (const std::string &name : real_scenes()) {
        Molecules m;
        if (read_molecules(name, m)) molecules_of(m);
    }
}

}  // namespace bench
