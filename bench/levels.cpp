// The sections that compare methods level by level, over the sizes.
#include "methods/methods.hpp"
#include "sections.hpp"

namespace bench {
namespace {

std::vector<std::int64_t> sizes(const Run &run) {
    if (run.extent == Extent::tiny) return {1, 3, 32};
    if (run.extent == Extent::quick) return {1, 3, 100, 1000, 10000};
    return {1, 2, 3, 4, 5, 10, 32, 100, 1000, 10000, 100000, 1000000};
}

std::vector<Recipe> batches(const Run &run, const std::string &name) {
    if (run.extent == Extent::tiny) return {batch(name, 64, 3)};
    if (run.extent == Extent::quick) return {batch(name, 10000, 3), batch(name, 256, 32), batch(name, 1000, 100)};
    return {batch(name, 100000, 1), batch(name, 10000, 3),  batch(name, 100000, 3),
            batch(name, 256, 32),   batch(name, 1000, 100), batch(name, 10000, 100)};
}

std::int64_t pool(const Run &run) { return run.extent == Extent::tiny ? 64 : run.full() ? 20000 : 5000; }

void append(Methods &to, Methods &&from) {
    for (Method &m : from) to.push_back(std::move(m));
}

Methods library(const Run &run, Level level, const Problem &p) {
    Methods list = {holonomic(level, p)};
    // A short first look leaves out that small calls start no second thread.
    if (run.threads > 1 && (run.full() || p.chains_per_call() * p.bonds >= 1000))
        list.push_back(holonomic(level, p, run.threads));
    return list;
}

using Wrap = Method (*)(const Problem &, const std::string &, const std::string &, Solver);

/// The direct solvers around the same assembly.
Methods direct(const Problem &p, Wrap wrap) {
    Methods list;
    if (have_lapack()) {
        list.push_back(wrap(p, "lapack-dptsv", "assembled", lapack_dptsv()));
        list.push_back(wrap(p, "lapack-dgtsv", "assembled", lapack_dgtsv()));
    }
    if (p.bonds <= 100000) list.push_back(wrap(p, "eigen-simplicial", "pattern reused", eigen_simplicial()));
    if (p.bonds <= 100 && p.all_bonds() <= 100000) list.push_back(wrap(p, "eigen-ldlt", "dense", eigen_ldlt()));
    if (p.bonds <= 1000 && p.all_bonds() <= 100000) list.push_back(wrap(p, "eq20", "literal", eq20()));
    list.push_back(wrap(p, "omega-recursion", "as printed", omega_recursion()));
    return list;
}

/// What peers do at the position level; `all`: the whole range of settings, otherwise the usual and the sharpest.
Methods position_peers(const Run &run, const Problem &p, bool all) {
    Methods list;
    std::vector<double> tolerances = {1e-6, 1e-12};
    if (all) tolerances = {1e-4, 1e-6, 1e-8, 1e-10, 1e-12};
    if (all && !run.full()) tolerances = {1e-4, 1e-8, 1e-12};
    // Sweeps grow as N^2 on straight chains: hours at a thousand bonds.
    const bool sweeps = p.name != "straight5" || p.bonds <= 100;
    for (double tolerance : tolerances) {
        if (sweeps) list.push_back(rattle(Level::position, p, tolerance));
        if (have_lapack()) list.push_back(milc_shake(p, tolerance));
        list.push_back(sparse_newton(p, tolerance));
    }
    for (int order : all ? std::vector<int>{4, 8, 12} : std::vector<int>{4, 8})
        for (int iterations : all ? std::vector<int>{1, 2, 4} : std::vector<int>{order == 4 ? 1 : 4})
            list.push_back(lincs(p, order, iterations));
    // Setting CCMA up takes a time that grows as the square of its bonds; pools are not done in full.
    if (have_openmm() && p.name != "fixed_ends" && p.chains_per_call() * p.bonds <= (run.full() ? 8200 : 7000))
        for (bool angles : {false, true})
            append(list,
                   openmm_ccma(Level::position, p,
                               all ? std::vector<double>{1e-4, 1e-6, 1e-8, 1e-10} : std::vector<double>{1e-6, 1e-10},
                               angles));
    return list;
}

/// The other kinds of chains than coils.
std::vector<Recipe> shapes(const Run &run) {
    if (run.extent == Extent::tiny) return {batch("straight5", 2, 32)};
    if (!run.full()) return {batch("straight5", 4, 100), batch("light_joints", 16, 100)};
    std::vector<Recipe> list;
    for (const char *name : {"straight5", "light_joints", "tetrahedral", "fixed_ends"})
        list.push_back(batch(name, 64, 100));
    list.push_back(single("straight5", 1000, 2000));
    return list;
}

/// A million bonds in one line: no memory of the far end dies on the way.
void truly_straight(const Run &run) {
    const Problem p = make_problem(with_joints(single("straight5", 1000000), 1, 0, 0));
    Methods list = library(run, Level::acceleration, p);
    for (Method &m : list) m.setting = "truly straight";
    list.push_back(scalar_sweep(p));
    if (have_lapack()) list.push_back(direct_forces(p, "lapack-dptsv", "assembled", lapack_dptsv()));
    for (Method &m : list)
        if (m.name != "holonomic") m.setting += " truly straight";
    run.measure(Level::acceleration, p, list);
}

}  // namespace

void acceleration_section(const Run &run) {
    auto work = [&run](const Recipe &recipe) {
        const Problem p = make_problem(recipe);
        Methods list = library(run, Level::acceleration, p);
        append(list, direct(p, direct_forces));
        list.push_back(scalar_sweep(p));
        run.measure(Level::acceleration, p, list);
    };
    for (std::int64_t n : sizes(run)) work(single("coil", n, pool(run)));
    for (const Recipe &recipe : batches(run, "melt")) work(recipe);
    for (const Recipe &recipe : shapes(run)) work(recipe);
    if (!run.full()) return;
    work(single("straight5", 1000000));
    truly_straight(run);
}

void velocity_section(const Run &run) {
    auto work = [&run](const Recipe &recipe, bool iterative) {
        const Problem p = make_problem(recipe);
        Methods list = library(run, Level::velocity, p);
        append(list, direct(p, direct_velocities));
        if (iterative) {
            for (double tolerance : run.full() ? std::vector<double>{1e-6, 1e-9, 1e-12} : std::vector<double>{1e-6})
                if (p.name != "straight5" || p.bonds <= 100) list.push_back(rattle(Level::velocity, p, tolerance));
            if (have_openmm() && p.name != "fixed_ends" && p.chains_per_call() * p.bonds <= 3000)
                append(list, openmm_ccma(Level::velocity, p, {1e-6, 1e-10}, false));
        }
        run.measure(Level::velocity, p, list);
    };
    for (std::int64_t n : sizes(run)) work(single("coil", n, pool(run)), n <= 10000);
    for (const Recipe &recipe : batches(run, "melt")) work(recipe, recipe.chains * recipe.bonds <= 100000);
    for (const Recipe &recipe : shapes(run)) work(recipe, true);
}

void position_section(const Run &run) {
    auto work = [&run](const Recipe &recipe, bool all) {
        const Problem p = make_problem(recipe);
        Methods list = library(run, Level::position, p);
        if (all)
            for (double tolerance : {1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12})
                list.push_back(holonomic_tolerance(p, tolerance));
        append(list, position_peers(run, p, all));
        run.measure(Level::position, p, list);
    };
    for (std::int64_t n : sizes(run)) work(single("coil", n, pool(run)), run.extent == Extent::tiny);
    for (const Recipe &recipe : batches(run, "coil")) work(recipe, false);
    // The whole range of settings, on many chains in a call: error against run time.
    if (run.extent == Extent::tiny) return;
    for (const char *name : {"coil", "light_joints", "straight5"})
        work(batch(name, run.full() ? 64 : name[0] == 's' ? 4 : 16, 100), true);
    if (!run.full()) return;
    for (const char *name : {"tetrahedral", "fixed_ends"}) work(batch(name, 64, 100), true);
    work(single("straight5", 1000, 2000), true);
}

void metric_section(const Run &run) {
    auto work = [&run](const Recipe &recipe) {
        const Problem p = make_problem(recipe);
        Methods list = library(run, Level::metric, p);
        for (Method &m : holonomic_skips(Level::metric, p))
            if (m.setting == "log_det alone") list.push_back(m);
        if (p.bonds <= 100) list.push_back(direct_metric(p, "eigen-ldlt", "log_det alone", eigen_ldlt_log_det()));
        list.push_back(direct_metric(p, "eigen-simplicial", "log_det alone", eigen_simplicial_log_det()));
        list.push_back(direct_metric(p, "omega-recursion", "log_det alone", omega_recursion_log_det()));
        run.measure(Level::metric, p, list);
    };
    // The reference, by an independent O(N^2) way, ends at a thousand bonds.
    for (std::int64_t n : sizes(run))
        if (n >= 2 && n <= 1000) work(single("coil", n, pool(run)));
    for (const Recipe &recipe : batches(run, "melt"))
        if (recipe.bonds >= 2) work(recipe);
    for (const Recipe &recipe : shapes(run)) work(recipe);
}

void solve_section(const Run &run) {
    auto work = [&run](const Recipe &recipe) {
        const Problem p = make_problem(recipe);
        const UnitSystems systems(p);
        Methods list = {holonomic_solve(p, systems)};
        auto add = [&](const char *name, const Solver &solver) {
            list.push_back(direct_solve(p, systems, name, "matrix given", solver));
        };
        if (have_lapack()) {
            add("lapack-dptsv", lapack_dptsv());
            add("lapack-dgtsv", lapack_dgtsv());
        }
        if (p.bonds <= 100000) add("eigen-simplicial", eigen_simplicial());
        if (p.bonds <= 100) add("eigen-ldlt", eigen_ldlt());
        if (p.bonds <= 1000) add("eq20", eq20());
        add("omega-recursion", omega_recursion());
        run.measure(Level::solve, p, list, &systems);
    };
    for (std::int64_t n : sizes(run)) work(single("coil", n, pool(run)));
    if (!run.full()) return;
    for (const char *name : {"tetrahedral", "straight5", "light_joints", "fixed_ends", "melt"})
        work(single(name, 100, 6400));
}

}  // namespace bench
