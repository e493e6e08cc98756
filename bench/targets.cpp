// The ratios that the library is meant to reach, against those of a run.
#include <algorithm>
#include <cmath>

#include "markdown.hpp"
#include "tables.hpp"

namespace bench {
namespace {

const double nothing = std::nan("");

Key scene(const char *level, const char *problem, std::int64_t chains, std::int64_t bonds) {
    Key key;
    key.level = level, key.problem = problem, key.chains = chains, key.bonds = bonds;
    return key;
}

struct Targets {
    const Table &all;
    MarkdownTable table{{"work", "scene", "measure", "wanted", "measured", ""}};

    void add(const std::string &work, const Key &key, const std::string &measure, bool at_most, double wanted,
             double value) {
        const bool met = at_most ? value <= wanted : value >= wanted;
        table.add({work, key.problem + " " + size_text(key.chains, key.bonds), measure,
                   (at_most ? "<= " : ">= ") + number(wanted), number(value),
                   std::isnan(value) ? "not measured"
                   : met             ? "met"
                                     : "missed"});
    }
    void passes(const std::string &work, const Key &key, double wanted) {
        const Measurement *m = all.find(key);
        add(work + (key.setting == "default" ? "" : ", " + key.setting), key, "memory passes", true, wanted,
            m ? m->passes : nothing);
    }
    void faster(const std::string &work, const Key &key, const std::string &method, const std::string &setting,
                double wanted) {
        Key rival = key;
        rival.method = method, rival.setting = setting;
        add(work, key, "times faster than " + method + ", " + setting, false, wanted, all.ns(rival) / all.ns(key));
    }
    void threads(const std::string &work, const Key &key) {
        Key two = key;
        two.threads = 2;
        add(work, key, "two threads, times faster", false, 1.8, all.ns(key) / all.ns(two));
    }
    /// The dearest of the three levels.
    void extra(const std::string &setting) {
        double worst = nothing;
        for (const char *level : {"acceleration", "velocity", "position"}) {
            Key plain = scene(level, "melt", 1000, 100), other = plain;
            other.setting = setting;
            worst = std::fmax(worst, all.ns(other) / all.ns(plain));
        }
        add("forces, velocities, positions", scene("", "melt", 1000, 100), setting + ", times the plain case, worst",
            true, 1.5, worst);
    }
};

}  // namespace

std::string targets_block(const Table &all) {
    Targets t{all};
    const std::string forces = "lambda and G", velocities = "velocities", positions = "positions";
    t.passes(forces, scene("acceleration", "melt", 10000, 100), 1.7);
    t.passes(forces, scene("acceleration", "melt", 256, 32), 2.8);
    t.passes(forces, scene("acceleration", "melt", 100000, 3), 1.4);
    t.passes(forces, scene("acceleration", "coil", 1, 1000000), 1.9);
    Key straight = scene("acceleration", "straight5", 1, 1000000);
    straight.setting = "truly straight";
    t.passes(forces, straight, 2.8);
    const Key in_cache = scene("acceleration", "coil", 1, 1000);
    t.passes(forces, in_cache, 5);
    t.faster(forces, in_cache, "omega-recursion", "unscaled scalar sweep", 2);
    t.faster(velocities, scene("velocity", "melt", 1000, 100), "lapack-dgtsv", "assembled", 12);
    const Key coils = scene("position", "coil", 1000, 100), molecules = scene("position", "coil", 10000, 3);
    t.faster(positions, coils, "sparse-newton", "tolerance 1e-12", 7);
    t.faster(positions, coils, "milc-shake", "tolerance 1e-12", 12);
    t.faster(positions, coils, "lincs", "order 4 iterations 1", 3.5);
    t.faster(positions, molecules, "rattle", "tolerance 1e-12", 15);
    t.faster(positions, molecules, "sparse-newton", "tolerance 1e-12", 5);
    t.faster(positions, scene("position", "coil", 100000, 1), "rattle", "tolerance 1e-12", 6);
    t.faster(positions, scene("position", "coil", 1, 100000), "sparse-newton", "tolerance 1e-12", 6);
    t.threads(forces, scene("acceleration", "melt", 1000, 100));
    t.threads(velocities, scene("velocity", "melt", 1000, 100));
    t.threads(positions, coils);
    t.add(forces, scene("acceleration", "coil", 1, 1000000), "times 10000 chains of 100, per bond", true, 1.25,
          all.ns(scene("acceleration", "coil", 1, 1000000)) / all.ns(scene("acceleration", "melt", 10000, 100)));
    for (std::int64_t bonds : {1, 3})
        t.add(forces, scene("acceleration", "coil", 1, bonds), "ns for the whole call", true, 1000,
              static_cast<double>(bonds) * all.ns(scene("acceleration", "coil", 1, bonds)));
    for (const char *setting :
         {"general masses and lengths", "index list", "box orthorhombic", "box triclinic", "float view", "x y z apart"})
        t.extra(setting);
    return t.table.text();
}

}  // namespace bench
