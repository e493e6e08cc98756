// The tables of the report that are about molecules of any topology.
#include <algorithm>
#include <cmath>

#include "markdown.hpp"
#include "tables.hpp"

namespace bench {
namespace {

struct Rival {
    const char *method, *setting, *title;
};

/// Whichever of these is there on a scene: the settings that are as accurate as the method gets.
const Rival forces_rivals[] = {{"sparse-ldl", "pattern reused", "sparse L D L^T"},
                               {"eigen-simplicial", "pattern reused", "Eigen"}};
const Rival velocity_rivals[] = {{"settle", "default", "SETTLE"},
                                 {"sparse-ldl", "pattern reused", "sparse L D L^T"},
                                 {"eigen-simplicial", "pattern reused", "Eigen"},
                                 {"rattle", "tolerance 1e-12", "RATTLE 1e-12"},
                                 {"openmm", "tolerance 1e-10", "OpenMM 1e-10"}};
const Rival position_rivals[] = {{"settle", "default", "SETTLE"},
                                 {"rattle", "tolerance 1e-06", "SHAKE 1e-6"},
                                 {"rattle", "tolerance 1e-12", "SHAKE 1e-12"},
                                 {"sparse-newton", "tolerance 1e-12", "sparse Newton 1e-12"},
                                 {"quasi-newton", "tolerance 1e-12", "quasi-Newton 1e-12"},
                                 {"lincs", "order 4 iterations 1", "LINCS 4, 1"},
                                 {"openmm", "tolerance 1e-10", "OpenMM 1e-10"}};

Key key_of(const Measurement &m) { return {m.level, m.problem, m.chains, m.bonds, m.method, m.setting, m.threads}; }

/// OpenMM's rows say so where it was told the angles.
double rival_ns(const Table &all, Key key, const Rival &rival) {
    key.method = rival.method, key.setting = rival.setting;
    const double ns = all.ns(key);
    if (!std::isnan(ns)) return ns;
    key.setting += " exact angles";
    return all.ns(key);
}

std::string ratio(double x) { return std::isfinite(x) ? number(x) : ""; }

template <std::size_t n>
void add_level(const Table &all, const char *level, const Rival (&rivals)[n], std::string &text, const char *title) {
    std::vector<std::string> head = {
        "molecules x bonds",        "ns/bond", "error", "over chains of as many bonds", "bonds in any order",
        "two threads: times faster"};
    for (const Rival &rival : rivals) head.push_back(rival.title);
    MarkdownTable table(head);
    for (const Measurement &m : all.rows()) {
        if (m.level != level || !m.is_molecule() || m.method != "holonomic" || m.setting != "default" || m.threads != 1)
            continue;
        Key chains = key_of(m), order = chains, two = chains;
        chains.setting = "chains instead", order.setting = "bonds in any order", two.threads = 2;
        std::vector<std::string> cells = {m.problem + ", " + size_text(m.chains, m.bonds),
                                          number(m.ns),
                                          error_text(m.error),
                                          ratio(m.ns / all.ns(chains)),
                                          ratio(all.ns(order) / m.ns),
                                          ratio(m.ns / all.ns(two))};
        for (const Rival &rival : rivals) cells.push_back(ratio(rival_ns(all, key_of(m), rival) / m.ns));
        table.add(cells);
    }
    if (!table.empty()) text += std::string(title) + "\n\n" + table.text() + "\n";
}

}  // namespace

std::string molecules_block(const Table &all) {
    std::string text;
    add_level(all, "acceleration", forces_rivals, text, "Forces (lambda and G):");
    add_level(all, "velocity", velocity_rivals, text, "Velocities:");
    add_level(all, "position", position_rivals, text, "Positions (with velocities and lambda):");
    return text.empty() ? "not measured\n" : text;
}

std::string adding_block(const Table &all) {
    MarkdownTable table({"molecules x bonds", "bonds given", "ns/bond", "memory passes"});
    for (const Measurement &m : all.rows())
        if (m.level == "setup")
            table.add({m.problem + ", " + size_text(m.chains, m.bonds), m.setting, number(m.ns), number(m.passes)});
    return table.empty() ? "not measured\n" : table.text();
}

namespace {

/// Rows of the targets: ratios of two times in the same scene.
struct MoleculeTargets {
    const Table &all;
    MarkdownTable table{{"work", "scene", "measure", "wanted", "measured", ""}};

    void add(const Measurement &own, const std::string &measure, bool at_most, double wanted, double value) {
        const bool met = at_most ? value <= wanted : value >= wanted;
        table.add({own.level, own.problem + ", " + size_text(own.chains, own.bonds), measure,
                   (at_most ? "<= " : ">= ") + number(wanted), number(value),
                   std::isnan(value) ? "not measured"
                   : met             ? "met"
                                     : "missed"});
    }
    /// Every size of the problem that was measured.
    template <class Act>
    void each(const char *level, const char *problem, const Act &act) {
        for (const Measurement &m : all.rows())
            if (m.level == level && m.problem == problem && m.method == "holonomic" && m.setting == "default" &&
                m.threads == 1)
                act(m);
    }
    void chains(const char *level, const char *problem, double wanted, std::int64_t bonds_at_most = 10000) {
        each(level, problem, [&](const Measurement &m) {
            Key key = key_of(m);
            key.setting = "chains instead";
            if (m.chains == 1 || m.chains * m.bonds <= bonds_at_most)
                add(m, "over chains of as many bonds", true, wanted, m.ns / all.ns(key));
        });
    }
    void faster(const char *level, const char *problem, const Rival &rival, double wanted) {
        each(level, problem, [&](const Measurement &m) {
            add(m, std::string("times faster than ") + rival.title, false, wanted,
                rival_ns(all, key_of(m), rival) / m.ns);
        });
    }
};

}  // namespace

std::string molecule_targets_block(const Table &all) {
    MoleculeTargets t{all};
    const Rival &settle = position_rivals[0], &shake6 = position_rivals[1], &shake12 = position_rivals[2],
                &newton = position_rivals[3], &openmm = position_rivals[6];
    const Rival &direct = forces_rivals[0];
    for (const char *problem : {"dodecane", "dendrimer", "comb", "brush"}) t.chains("acceleration", problem, 1.3);
    t.faster("position", "water", settle, 4);
    t.faster("position", "water", openmm, 4);
    t.faster("position", "water", shake12, 10);
    t.faster("velocity", "water", velocity_rivals[0], 4);
    t.faster("velocity", "water", velocity_rivals[4], 4);
    t.faster("position", "hydrogens", shake6, 4);
    t.chains("acceleration", "ring", 2.2);
    t.chains("acceleration", "triangles", 4);
    t.faster("position", "ring", newton, 4);
    t.faster("position", "triangles", newton, 4);
    for (const char *level : {"acceleration", "position"}) t.chains(level, "arms", 1.1);
    for (const char *problem : {"random_tree", "protein"}) {
        t.faster("position", problem, newton, 2);
        t.faster("acceleration", problem, direct, 2);
    }
    t.each("acceleration", "arms", [&](const Measurement &m) {
        Key two = key_of(m);
        two.threads = 2;
        if (m.bonds >= 100000) t.add(m, "two threads, times faster", false, 1.5, m.ns / all.ns(two));
    });
    for (const Measurement &m : all.rows())
        if (m.level == "setup" && m.setting == "bonds in any order")
            t.add(m, "ns a bond, " + m.setting, true, 100, m.ns);
    return t.table.text();
}

}  // namespace bench
