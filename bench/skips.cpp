// What each thing costs that a scene may do without, and what the instruction sets give.
#include "methods/holonomic_chains.hpp"
#include "methods/methods.hpp"
#include "sections.hpp"

namespace bench {
namespace {

std::vector<Recipe> scenes(const Run &run) {
    if (run.extent == Extent::tiny) return {batch("melt", 64, 3)};
    if (run.extent == Extent::quick) return {batch("melt", 1000, 100)};
    return {batch("melt", 10000, 3), batch("melt", 1000, 100), batch("melt", 10000, 100)};
}

Recipe general(Recipe recipe) {
    recipe.general = true;
    return recipe;
}

}  // namespace

void skips_section(const Run &run) {
    for (const Recipe &recipe : scenes(run))
        for (Level level : {Level::acceleration, Level::velocity, Level::position, Level::metric}) {
            const Problem p = make_problem(recipe);
            Methods list = {holonomic(level, p)};
            for (Method &m : holonomic_skips(level, p)) list.push_back(m);
            if (run.threads > 1) list.push_back(holonomic(level, p, run.threads));
            run.measure(level, p, list);
            const Problem uneven = make_problem(general(recipe));
            Method m = holonomic(level, uneven);
            m.setting = "general masses and lengths";
            run.measure(level, uneven, {m});
        }
}

void instruction_set_section(const Run &run) {
    for (const Recipe &recipe : scenes(run))
        for (Level level : {Level::acceleration, Level::velocity, Level::position, Level::metric}) {
            const Problem p = make_problem(recipe);
            Method m = holonomic(level, p);
            m.setting = std::string("HOLONOMIC_ISA=") + hol_instruction_set();
            run.measure(level, p, {m});
        }
}

}  // namespace bench
