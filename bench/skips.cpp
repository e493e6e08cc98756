// What each thing costs that a scene may do without, and what the instruction sets give.
#include "methods/holonomic_chains.hpp"
#include "methods/methods.hpp"
#include "sections.hpp"

namespace bench {
namespace {

const Level levels[] = {Level::acceleration, Level::velocity, Level::position, Level::metric};

std::vector<Recipe> scenes(const Run &run) {
    if (run.extent == Extent::tiny) return {batch("melt", 64, 3)};
    if (run.extent == Extent::quick) return {batch("melt", 1000, 100)};
    return {batch("melt", 10000, 3), batch("melt", 1000, 100), batch("melt", 10000, 100)};
}

/// Scenes that differ from the plain one in their chains: what each needs or saves.
std::vector<std::pair<std::string, Recipe>> other_chains(const Recipe &plain) {
    Recipe masses = plain, lengths = plain, both = plain, fixed = plain, orthogonal = plain;
    masses.general_masses = both.general_masses = true;
    lengths.general_lengths = both.general_lengths = true;
    fixed.fixed_every = 10;
    orthogonal.orthogonal = true;
    Recipe compensated = with_joints(plain, 1e-12, 0.5e-6, 1e-6);
    compensated.name = "light_joints";
    return {{"general masses", masses},
            {"general lengths", lengths},
            {"general masses and lengths", both},
            {"every 10th atom fixed", fixed},
            {"orthogonal neighbours", orthogonal},
            {"compensated arithmetic", compensated}};
}

/// A row of the library under another setting, on a problem of its own.
void measure_as(const Run &run, Level level, const std::string &setting, const Recipe &recipe) {
    const Problem p = make_problem(recipe);
    Method m = recipe.flat ? holonomic_flat(level, p) : holonomic(level, p);
    m.setting = setting;
    run.measure(level, p, {m});
}

/// The same chains at rest, without forces, or both: what NULL says.
void measure_null_inputs(const Run &run, const Problem &p) {
    for (const bool v : {true, false})
        for (const bool f : {true, false}) {
            if (!v && !f) continue;
            Problem changed = p;
            if (v) changed.v.assign(p.v.size(), 0);
            if (f) changed.f.assign(p.f.size(), 0);
            run.measure(Level::acceleration, changed, {holonomic_without(changed, v, f)});
        }
}

}  // namespace

void skips_section(const Run &run) {
    for (const Recipe &recipe : scenes(run)) {
        const Problem p = make_problem(recipe);
        for (Level level : levels) {
            Methods list = {holonomic(level, p)};
            for (Method &m : holonomic_skips(level, p)) list.push_back(m);
            if (run.threads > 1) list.push_back(holonomic(level, p, run.threads));
            run.measure(level, p, list);
        }
        measure_null_inputs(run, p);
        Recipe flat = recipe;
        flat.flat = true;
        for (Level level : levels) {
            for (const auto &other : other_chains(recipe)) {
                // Straight chains of such joints have no solution after a drift of dt = 0.005.
                if (level == Level::position && other.second.name == "light_joints") continue;
                measure_as(run, level, other.first, other.second);
            }
            measure_as(run, level, "two dimensions", flat);
        }
    }
}

void instruction_set_section(const Run &run) {
    for (const Recipe &recipe : scenes(run))
        for (Level level : levels)
            measure_as(run, level, std::string("HOLONOMIC_ISA=") + hol_instruction_set(), recipe);
}

}  // namespace bench
