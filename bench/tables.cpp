#include "tables.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "markdown.hpp"

namespace bench {
namespace {

bool starts_with(const std::string &text, const std::string &start) { return text.rfind(start, 0) == 0; }

Key key_of(const Measurement &m) { return {m.level, m.problem, m.chains, m.bonds, m.method, m.setting, m.threads}; }

Key own_of(const Measurement &m) {
    Key key = key_of(m);
    key.method = "holonomic", key.setting = "default";
    return key;
}

std::string scene_of(const Measurement &m) {
    return m.level + ", " + m.problem + ", " + size_text(m.chains, m.bonds) +
           (m.threads > 1 ? ", " + std::to_string(m.threads) + " threads" : "");
}

struct Rival {
    const char *method, *setting, *title;
};

const Rival rivals[] = {
    {"omega-recursion", "unscaled scalar sweep", "scalar sweep"},
    {"lapack-dptsv", "assembled", "dptsv"},
    {"lapack-dgtsv", "assembled", "dgtsv"},
    {"rattle", "tolerance 1e-12", "RATTLE 1e-12"},
    {"milc-shake", "tolerance 1e-12", "MILC-SHAKE 1e-12"},
    {"sparse-newton", "tolerance 1e-12", "sparse Newton 1e-12"},
    {"lincs", "order 4 iterations 1", "LINCS 4, 1"},
};

/// The settings of a level that stand for each method in the tables by size.
const char *const plain_settings[] = {"assembled",       "as printed",      "unscaled scalar sweep",
                                      "dense",           "pattern reused",  "literal",
                                      "matrix given",    "tolerance 1e-06", "tolerance 1e-12",
                                      "tolerance 1e-10", "log_det alone",   "order 4 iterations 1"};

/// The fastest other method on the scene of a row, among those that are as accurate as the library or among the rest.
const Measurement *fastest_other(const Table &all, const Measurement &own, bool accurate) {
    const Measurement *best = nullptr;
    for (const Measurement &m : all.rows()) {
        if (m.method == "holonomic" || m.is_special() || scene_of(m) != scene_of(own)) continue;
        const bool as_accurate = m.error <= std::fmax(10 * own.error, 1.1e-12);
        if (as_accurate == accurate && (!best || m.ns < best->ns)) best = &m;
    }
    return best;
}

}  // namespace

std::string glance_block(const Table &all) {
    static const Key scenes[] = {
        {"acceleration", "melt", 1000, 100},  {"acceleration", "melt", 100000, 3},
        {"acceleration", "coil", 1, 1000000}, {"velocity", "melt", 1000, 100},
        {"position", "coil", 1000, 100},      {"position", "coil", 10000, 3},
        {"position", "coil", 100000, 1},      {"position", "coil", 1, 100000},
        {"position", "straight5", 64, 100},   {"position", "light_joints", 64, 100},
        {"acceleration", "coil", 1, 1000},    {"acceleration", "coil", 1, 100},
        {"position", "coil", 1, 100},         {"position", "coil", 1, 3},
        {"acceleration", "coil", 1, 3},
    };
    MarkdownTable table({"work: chains x bonds in a call", "holonomic: ns/bond", "error", "fastest other as accurate",
                         "ns/bond", "times faster", "use"});
    for (const Key &key : scenes) {
        const Measurement *own = all.find(key), *other = own ? fastest_other(all, *own, true) : nullptr;
        if (!other) continue;
        table.add({scene_of(*own), number(own->ns), error_text(own->error), other->method + ", " + other->setting,
                   number(other->ns), number(other->ns / own->ns), other->ns > own->ns ? "holonomic" : other->method});
    }
    return table.text();
}

std::string summary_block(const Table &all) {
    static const Key scenes[] = {
        {"acceleration", "melt", 10000, 100}, {"acceleration", "melt", 1000, 100},  {"acceleration", "melt", 256, 32},
        {"acceleration", "melt", 100000, 3},  {"acceleration", "coil", 1, 1000000}, {"acceleration", "coil", 1, 1000},
        {"velocity", "melt", 1000, 100},      {"position", "coil", 1000, 100},      {"position", "coil", 10000, 3},
        {"position", "coil", 100000, 1},      {"position", "coil", 1, 100000},
    };
    std::vector<std::string> head = {"scene", "ns/bond", "memory passes", "error"};
    for (const Rival &rival : rivals) head.push_back(rival.title);
    MarkdownTable table(head);
    for (const Key &key : scenes) {
        const Measurement *own = all.find(key);
        if (!own) continue;
        std::vector<std::string> cells = {scene_of(*own), number(own->ns), number(own->passes), error_text(own->error)};
        for (const Rival &rival : rivals) {
            Key other = key;
            other.method = rival.method, other.setting = rival.setting;
            cells.push_back(number(all.ns(other) / own->ns));
        }
        table.add(cells);
    }
    return table.text();
}

std::string sizes_block(const Table &all, const std::string &level) {
    const std::string problem = "coil";
    std::set<std::int64_t> sizes;
    std::vector<std::pair<std::string, std::string>> columns;  // method and setting
    for (const Measurement &m : all.rows()) {
        if (m.level != level || m.problem != problem || m.chains != 1 || m.threads != 1 || m.is_special()) continue;
        sizes.insert(m.bonds);
        const bool plain =
            std::find(std::begin(plain_settings), std::end(plain_settings), m.setting) != std::end(plain_settings);
        const std::pair<std::string, std::string> column(m.method, m.setting);
        if (m.method != "holonomic" && plain && std::find(columns.begin(), columns.end(), column) == columns.end())
            columns.push_back(column);
    }
    std::vector<std::string> head = {"N", "holonomic", "its error", "memory pass"};
    for (const auto &column : columns) head.push_back(column.first + ", " + column.second);
    MarkdownTable table(head);
    for (std::int64_t bonds : sizes) {
        Key key{level, problem, 1, bonds};
        const Measurement *own = all.find(key);
        if (!own) continue;
        std::vector<std::string> cells = {std::to_string(bonds), number(own->ns), error_text(own->error),
                                          number(own->ns / own->passes)};
        for (const auto &column : columns) {
            key.method = column.first, key.setting = column.second;
            cells.push_back(number(all.ns(key)));
        }
        table.add(cells);
    }
    return table.text();
}

std::string batches_block(const Table &all) {
    MarkdownTable table(
        {"scene", "ns/bond", "spread", "memory passes", "error", "two threads: times faster", "their memory passes"});
    for (const Measurement &m : all.rows()) {
        if (m.method != "holonomic" || m.setting != "default" || m.threads != 1 || m.chains == 1 || m.is_molecule())
            continue;
        if (all.find(key_of(m)) != &m) continue;  // measured again among what a scene saves
        Key key = key_of(m);
        key.threads = 2;
        const Measurement *two = all.find(key);
        table.add({scene_of(m), number(m.ns), number(100 * (m.upper - m.lower) / m.ns) + " %", number(m.passes),
                   error_text(m.error), two ? number(m.ns / two->ns) : "", two ? number(two->passes) : ""});
    }
    return table.text();
}

std::string accuracy_block(const Table &all, const std::string &problem) {
    // The scene in which every method went through all its settings.
    const Measurement *sharpest = nullptr;
    for (const Measurement &m : all.rows())
        if (m.level == "position" && m.problem == problem && m.chains > 1 && m.bonds == 100 &&
            m.setting == "order 12 iterations 4")
            sharpest = &m;
    if (!sharpest) return "not measured\n";
    MarkdownTable table({"method", "setting", "ns/bond", "error"});
    for (const Measurement &m : all.rows())
        if (m.level == "position" && m.problem == problem && m.chains == sharpest->chains && m.bonds == 100 &&
            m.threads == 1 && !m.is_special())
            table.add({m.method, m.setting, number(m.ns), error_text(m.error)});
    return "Positions, " + problem + ", " + size_text(sharpest->chains, 100) + ":\n\n" + table.text();
}

std::string condition_block(const Table &all) {
    const char *const methods[] = {"holonomic", "omega-recursion", "lapack-dptsv", "eigen-ldlt"};
    MarkdownTable table({"condition number", "holonomic", "omega-recursion", "dptsv", "dense LDL^T"});
    for (const Measurement &m : all.rows()) {
        if (m.method != "holonomic" || !starts_with(m.setting, "condition ")) continue;
        std::vector<std::string> cells = {m.setting.substr(10)};
        for (const char *method : methods) {
            Key key = key_of(m);
            key.method = method;
            const Measurement *row = all.find(key);
            cells.push_back(row ? error_text(row->error) : "");
        }
        table.add(cells);
    }
    return table.text();
}

std::string drift_block(const Table &all) {
    const std::string start = "energy drift ";
    MarkdownTable table({"constraints", "energy drift", "ns/bond and step"});
    for (const Measurement &m : all.rows())
        if (starts_with(m.setting, start))
            table.add({m.method + ", " + m.setting.substr(start.size()), error_text(m.error), number(m.ns)});
    return table.text();
}

std::string skips_block(const Table &all) {
    static const char *const levels[] = {"acceleration", "velocity", "position", "metric"};
    static const char *const problems[] = {"melt", "light_joints"};
    const std::int64_t chains = 1000, bonds = 100;
    std::vector<std::string> settings;
    for (const Measurement &m : all.rows()) {
        const bool here = m.chains == chains && m.bonds == bonds && m.threads == 1 && m.method == "holonomic";
        if (here && m.problem != "coil" && std::find(settings.begin(), settings.end(), m.setting) == settings.end())
            settings.push_back(m.setting);
    }
    MarkdownTable table({"setting", "acceleration", "velocity", "position", "metric"});
    for (const std::string &setting : settings) {
        std::vector<std::string> cells = {setting};
        for (const char *level : levels) {
            const double whole = all.ns({level, "melt", chains, bonds});
            double ns = std::nan("");
            for (const char *problem : problems) {
                Key key{level, problem, chains, bonds};
                key.setting = setting;
                if (std::isnan(ns)) ns = all.ns(key);
            }
            cells.push_back(std::isnan(ns) ? "" : number(ns) + " (" + number(ns / whole) + ")");
        }
        table.add(cells);
    }
    return table.text();
}

std::string losses_block(const Table &all, bool accurate, bool molecules) {
    struct Loss {
        std::string work, method, sizes;
        double factor;
        const Measurement *own, *other;  // where it is greatest
    };
    std::vector<Loss> losses;
    std::set<std::string> done;
    for (const Measurement &first : all.rows()) {
        if (first.is_special() || first.is_molecule() != molecules || !done.insert(scene_of(first)).second) continue;
        // Others find no force with the metric: beside all that the library finds by default, and beside as little.
        for (const std::string setting : {"default", "log_det alone"}) {
            Key key = own_of(first);
            key.setting = setting;
            const Measurement *own = all.find(key);
            const Measurement *best = own ? fastest_other(all, *own, accurate) : nullptr;
            if (!best || best->ns >= own->ns) continue;
            const Loss loss = {own->level + ", " + own->problem + (setting == "default" ? "" : ", " + setting),
                               best->method + ", " + best->setting,
                               size_text(own->chains, own->bonds),
                               own->ns / best->ns,
                               own,
                               best};
            const auto same = std::find_if(losses.begin(), losses.end(), [&](const Loss &other) {
                return other.work == loss.work && other.method == loss.method;
            });
            if (same == losses.end()) {
                losses.push_back(loss);
                continue;
            }
            const std::string sizes = same->sizes + ", " + loss.sizes;
            if (loss.factor > same->factor) *same = loss;
            same->sizes = sizes;
        }
    }
    MarkdownTable table({"work", "faster", "at chains x bonds", "times faster, at most", "ns/bond", "error",
                         "holonomic: ns/bond", "error"});
    for (const Loss &l : losses)
        table.add({l.work, l.method, l.sizes, number(l.factor), number(l.other->ns), error_text(l.other->error),
                   number(l.own->ns), error_text(l.own->error)});
    return table.empty() ? "none\n" : table.text();
}

}  // namespace bench
