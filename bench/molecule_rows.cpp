// Molecules of any topology: made ones of every kind, and real ones where their files can be had. Each beside the
// library's own chains of as many bonds and beside the methods that can do them.
#include <algorithm>
#include <cstdio>

#include "methods/graph_methods.hpp"
#include "methods/methods.hpp"
#include "molecules/molecule_errors.hpp"
#include "sections.hpp"

namespace bench {
namespace {

const Level levels[] = {Level::acceleration, Level::velocity, Level::position};

void append(Methods &to, Methods &&from) {
    for (Method &m : from) to.push_back(std::move(m));
}

/// Rigid triangles and nothing else.
bool is_water(const Molecules &m) {
    return std::all_of(m.kinds.begin(), m.kinds.end(),
                       [](const Kind &kind) { return kind.n_atoms() == 3 && kind.n_bonds() == 3; });
}

Methods library(const Run &run, Level level, const Molecules &m, bool all) {
    Methods list = {holonomic(level, m)};
    if (run.threads > 1) list.push_back(holonomic(level, m, run.threads));
    list.push_back(holonomic_any_order(level, m));
    if (m.source.empty()) list.push_back(holonomic_chains_instead(level, m));
    if (level == Level::position && all) {
        std::vector<double> sweep = {1e-4, 1e-8, 1e-12};
        if (run.full()) sweep = {1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12};
        for (double tolerance : sweep) list.push_back(holonomic_tolerance(m, tolerance));
    }
    return list;
}

Methods position_peers(const Run &run, const Molecules &m, bool all) {
    Methods list;
    const bool sweeps = m.all_bonds() <= 100000;
    const std::vector<double> tolerances =
        all && run.full() ? std::vector<double>{1e-4, 1e-6, 1e-8, 1e-10, 1e-12} : std::vector<double>{1e-6, 1e-12};
    for (double tolerance : tolerances) {
        if (sweeps) list.push_back(graph_rattle(Level::position, m, tolerance));
        list.push_back(graph_newton(m, tolerance));
        list.push_back(graph_quasi_newton(m, tolerance));
    }
    list.push_back(graph_lincs(m, 4, 1));
    list.push_back(graph_lincs(m, 8, 4));
    return list;
}

Methods peers(const Run &run, Level level, const Molecules &m, bool all) {
    Methods list;
    if (level == Level::position) {
        list = position_peers(run, m, all);
    } else {
        list = {graph_direct(level, m), graph_eigen(level, m)};
        if (level == Level::velocity && m.all_bonds() <= 100000)
            for (double tolerance : {1e-6, 1e-12}) list.push_back(graph_rattle(level, m, tolerance));
    }
    if (level == Level::acceleration) return list;
    if (is_water(m)) list.push_back(settle(level, m));
    // Setting CCMA up takes a time that grows as the square of its bonds.
    if (have_openmm() && openmm_ccma_bonds(m) <= (run.full() ? 8200 : 4100))
        append(list, openmm(level, m, {1e-6, 1e-10}));
    return list;
}

/// `all`: at the position level the whole range of settings.
void work(const Run &run, const Molecules &m, bool all = false) {
    for (Level level : levels) {
        const MoleculeReference reference(m, level, run.effort.reference_bonds);
        Methods list = library(run, level, m, all);
        append(list, peers(run, level, m, all));
        run.measure(level, m, list, [&reference](const State &s, double) { return reference.error(s); });
    }
}

/// Groups with hydrogens as along a protein: 3 of 4 are XH or XH2.
std::vector<Kind> hydrogens() {
    const Kind ch = formula_kind("CH"), nh = formula_kind("NH"), oh = formula_kind("OH"), ch2 = formula_kind("C(H)H"),
               ch3 = formula_kind("C(H)(H)H"), nh3 = formula_kind("N(H)(H)H");
    return {nh, ch, ch2, ch3, nh, ch, ch3, oh, ch, ch2, ch2, ch3, nh, ch, ch2, nh3, nh, ch, ch2, ch3};
}

std::string dodecane() {
    std::string formula = "C(H)(H)(H)";
    for (int i = 0; i < 10; ++i) formula += "C(H)(H)";
    return formula + "C(H)(H)H";
}

/// As many molecules as make about so many bonds.
Molecules about(const std::string &name, const Kind &kind, std::int64_t bonds) {
    return make_molecules(name, {kind}, std::max<std::int64_t>(1, bonds / static_cast<std::int64_t>(kind.n_bonds())));
}

void made(const Run &run) {
    const bool tiny = run.extent == Extent::tiny;
    const std::int64_t bonds = tiny ? 200 : 8000;
    work(run, make_molecules("water", {water_kind()}, tiny ? 60 : 10000), true);
    work(run, make_molecules("hydrogens", hydrogens(), tiny ? 100 : 4560));
    work(run, about("dodecane", formula_kind(dodecane()), bonds), true);
    if (run.full()) work(run, about("dodecane", formula_kind(dodecane()), 370000));
    work(run, about("dendrimer", dendrimer_kind(3, 2, 5), bonds));
    work(run, about("comb", comb_kind(20, 1), bonds));
    work(run, about("brush", comb_kind(20, 10), bonds));
    work(run, about("ring", ring_kind(50), bonds));
    work(run, about("triangles", triangles_kind(50), bonds));
    for (std::int64_t size : {10000, 100000, 1000000}) {
        if (size > (tiny ? 0 : run.full() ? 1000000 : 10000)) continue;
        work(run, make_molecules("arms", {arms_kind(size, 1000)}, 1));
        work(run, make_molecules("random_tree", {random_tree_kind(size)}, 1));
        work(run, make_molecules("protein", {protein_kind(size)}, 1));
    }
}

}  // namespace

void molecules_section(const Run &run) {
    made(run);
    for (const std::string &name : real_scenes()) {
        Molecules m;
        if (!read_molecules(name, m))
            std::printf("   %s is left out: there is no %s\n", name.c_str(), m.source.c_str());
        else if (run.extent != Extent::tiny)
            work(run, m);
    }
}

}  // namespace bench
