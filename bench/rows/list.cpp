// The rows: what docs/performance.md and docs/benchmarks.md speak of, and molecules that people simulate.
#include <algorithm>

#include "row.hpp"

namespace rows {
namespace {

std::string of_bonds(std::int64_t n) { return std::to_string(n) + (n == 1 ? " bond" : " bonds"); }

/// A verb: its name, whether its positions have moved, and the call in packed arrays and in others.
struct Verb {
    std::string name;
    bool moved;
    std::function<int(const Call &)> packed, by_view;
};

const std::vector<Verb> &verbs() {
    static const std::vector<Verb> list = {
        {"forces", false,
         [](const Call &c) {
             Arrays &a = c.arrays;
             return c.calls.hol_forces(c.chains, a.r.packed(), a.v.packed(), a.f.packed(), a.lambda.data(), nullptr,
                                       a.g.packed(), HOL_WRITE, nullptr);
         },
         [](const Call &c) {
             Arrays &a = c.arrays;
             return c.calls.hol_forces_view(c.chains, a.r.input(), a.v.input(), a.f.input(), a.lambda.data(), nullptr,
                                            a.g.view(), HOL_WRITE, nullptr);
         }},
        {"velocities", false,
         [](const Call &c) {
             Arrays &a = c.arrays;
             return c.calls.hol_project_velocities(c.chains, a.r.packed(), a.v.packed(), a.lambda.data(), nullptr);
         },
         [](const Call &c) {
             Arrays &a = c.arrays;
             return c.calls.hol_project_velocities_view(c.chains, a.r.input(), a.v.view(), a.lambda.data(), nullptr);
         }},
        {"positions", true,
         [](const Call &c) {
             Arrays &a = c.arrays;
             return c.calls.hol_project_positions(c.chains, a.reference.packed(), a.r.packed(), a.v.packed(),
                                                  c.scene.dt, a.lambda.data(), 0, nullptr, nullptr);
         },
         [](const Call &c) {
             Arrays &a = c.arrays;
             return c.calls.hol_project_positions_view(c.chains, a.reference.input(), a.r.view(), a.v.view(),
                                                       c.scene.dt, a.lambda.data(), 0, nullptr, nullptr);
         }},
    };
    return list;
}

class List {
public:
    std::vector<Row> rows;
    std::string chosen = "forces velocities positions";  ///< verbs of the next lines

    /// The three verbs of a scene.
    void add(const std::string &name, const std::function<Recipe()> &recipe, Order order = Order::consecutive,
             Boxed box = Boxed::no, Layout layout = Layout::packed) {
        for (const Verb &verb : verbs()) {
            if (chosen.find(verb.name) == std::string::npos) continue;
            Row row;
            row.name = verb.name + ", " + name +
                       (order == Order::any     ? ", any order"
                        : order == Order::apart ? ", apart"
                                                : "") +
                       (box == Boxed::orthorhombic ? ", orthorhombic"
                        : box == Boxed::triclinic  ? ", triclinic"
                                                   : "") +
                       (layout == Layout::floats     ? ", floats"
                        : layout == Layout::separate ? ", separate"
                                                     : "");
            row.common = layout == Layout::packed && box != Boxed::triclinic;
            row.moved = verb.moved;
            row.layout = layout;
            row.call = layout == Layout::packed ? verb.packed : verb.by_view;
            row.recipe = with(recipe, order, box);
            rows.push_back(row);
        }
    }

    /// One call of any kind on packed arrays.
    void one(const std::string &name, const std::function<Recipe()> &recipe, bool moved, bool common,
             const std::function<int(const Call &)> &call, Order order = Order::consecutive, Boxed box = Boxed::no) {
        Row row;
        row.name = name;
        row.common = common;
        row.moved = moved;
        row.call = call;
        row.recipe = with(recipe, order, box);
        rows.push_back(row);
    }

    void alone(const std::string &name, const std::function<Recipe()> &recipe) {
        const std::size_t before = rows.size();
        add("alone, " + name, recipe);
        for (std::size_t i = before; i < rows.size(); ++i) rows[i].alone = true;
    }

private:
    static std::function<Recipe()> with(const std::function<Recipe()> &recipe, Order order, Boxed box) {
        return [=] {
            Recipe made = recipe();
            made.order = order;
            made.box = box;
            return made;
        };
    }
};

/// Chains of so many bonds, about 6000 bonds in all.
std::function<Recipe()> coil(std::int64_t bonds, const Chain &chain = {}, std::int64_t kinds = 1) {
    return [=] { return chains(std::max<std::int64_t>(6000 / bonds, 4), bonds, chain, kinds); };
}

std::function<Recipe()> of(std::int64_t n, const std::function<bench::Kind()> &kind) {
    return [=] { return molecules(n, {kind()}); };
}

void add_chains(List &list) {
    for (std::int64_t n : {1, 2, 3, 4, 5, 6, 10, 32, 100, 256, 1000}) list.add(of_bonds(n), coil(n));
    list.add("1 x 20000 bonds", [] { return chains(1, 20000); });
    for (std::int64_t n : {1, 2, 3, 10, 32, 100, 1000}) {
        list.add(of_bonds(n), coil(n), Order::any);
        list.add(of_bonds(n), coil(n), Order::consecutive, Boxed::orthorhombic);
    }
    for (std::int64_t n : {1, 3, 32, 100}) list.add(of_bonds(n), coil(n), Order::any, Boxed::orthorhombic);
    for (std::int64_t n : {1, 2, 3, 32, 100, 1000})
        list.add(of_bonds(n), coil(n), Order::consecutive, Boxed::triclinic);
    for (std::int64_t n : {3, 32}) list.add(of_bonds(n), coil(n), Order::any, Boxed::triclinic);
    for (Layout layout : {Layout::separate, Layout::floats}) {
        for (std::int64_t n : {1, 2, 3, 5, 10, 32, 100, 1000})
            list.add(of_bonds(n), coil(n), Order::consecutive, Boxed::no, layout);
        for (std::int64_t n : {1, 3, 32})
            list.add(of_bonds(n), coil(n), Order::consecutive, Boxed::orthorhombic, layout);
    }

    Chain heavy, masses, both;
    heavy.mass = 14;
    masses.general_masses = true;
    both.general_masses = both.general_lengths = true;
    list.add("32 bonds of mass 14", coil(32, heavy));
    for (std::int64_t n : {3, 32, 100, 1000}) {
        list.add(of_bonds(n) + ", unequal masses", coil(n, masses));
        list.add(of_bonds(n) + ", unequal masses and lengths", coil(n, both));
    }
    list.add("32 bonds, others in each chain", coil(32, both, 187));
    list.add("100 bonds, others in each chain", coil(100, both, 60), Order::any, Boxed::orthorhombic);
    list.add("chains of 1 to 40 bonds", [] {
        Recipe all = chains(0, 1);
        all.kinds.clear();
        for (std::int64_t n = 1; n <= 40; ++n) all.kinds.push_back(chains(1, n * 17 % 41).kinds[0]);
        all.molecules = 240;
        return all;
    });
    for (std::int64_t n : {1, 3, 12, 200}) list.alone(of_bonds(n), [n] { return chains(1, n); });
}

/// What a call is asked for beside the usual, and the other verbs, on chains of 32 bonds.
void add_options(List &list) {
    list.one("forces, 32 bonds, tension and virial", coil(32), false, false, [](const Call &c) {
        Arrays &a = c.arrays;
        double virial[9];
        return c.calls.hol_forces(c.chains, a.r.packed(), a.v.packed(), a.f.packed(), a.lambda.data(), a.more.data(),
                                  a.g.packed(), HOL_ADD, virial);
    });
    list.one("forces, 32 bonds, no v, no lambda", coil(32), false, true, [](const Call &c) {
        Arrays &a = c.arrays;
        return c.calls.hol_forces(c.chains, a.r.packed(), nullptr, a.f.packed(), nullptr, nullptr, a.g.packed(),
                                  HOL_WRITE, nullptr);
    });
    list.one("velocities, 32 bonds, virial", coil(32), false, false, [](const Call &c) {
        Arrays &a = c.arrays;
        double virial[9];
        return c.calls.hol_project_velocities(c.chains, a.r.packed(), a.v.packed(), a.lambda.data(), virial);
    });
    list.one("positions, 32 bonds, virial and report", coil(32), true, false, [](const Call &c) {
        Arrays &a = c.arrays;
        double virial[9];
        hol_report report;
        return c.calls.hol_project_positions(c.chains, a.reference.packed(), a.r.packed(), a.v.packed(), c.scene.dt,
                                             a.lambda.data(), 0, virial, &report);
    });
    list.one("positions, 32 bonds, no v, no lambda", coil(32), true, true, [](const Call &c) {
        Arrays &a = c.arrays;
        return c.calls.hol_project_positions(c.chains, a.reference.packed(), a.r.packed(), nullptr, c.scene.dt, nullptr,
                                             0, nullptr, nullptr);
    });
    const auto metric = [](const Call &c) {
        Arrays &a = c.arrays;
        double energy;
        return c.calls.hol_metric(c.chains, a.r.packed(), 1, a.more.data(), nullptr, &energy, a.g.packed(), HOL_WRITE);
    };
    for (std::int64_t n : {2, 3, 10, 32, 100, 1000}) list.one("metric, " + of_bonds(n), coil(n), false, true, metric);
    list.one("metric, 32 bonds, orthorhombic", coil(32), false, true, metric, Order::consecutive, Boxed::orthorhombic);
    list.one("metric, 32 bonds, any order", coil(32), false, true, metric, Order::any);
    const auto determinant = [](const Call &c) {
        return c.calls.hol_metric(c.chains, c.arrays.r.packed(), 1, c.arrays.more.data(), nullptr, nullptr, nullptr,
                                  HOL_WRITE);
    };
    list.one("metric, 32 bonds, determinant alone", coil(32), false, true, determinant);
    for (std::int64_t n : {1, 3, 12, 100}) {
        const auto recipe = [n] { return chains(1, n); };
        list.one("metric, alone, " + of_bonds(n), recipe, false, true, metric);
        list.rows.back().alone = true;
        list.one("determinant, alone, " + of_bonds(n), recipe, false, true, determinant);
        list.rows.back().alone = true;
    }
    list.one("metric, butane", of(400, [] { return bench::formula_kind("C(H)(H)(H)C(H)(H)C(H)(H)C(H)(H)H"); }), false,
             true, metric);
    list.one("metric, comb, 20 + 20", of(150, [] { return bench::comb_kind(20, 1); }), false, true, metric);
    list.one("metric, ring of 50", of(120, [] { return bench::ring_kind(50); }), false, true, metric);
    list.one("solve, 32 bonds", coil(32), false, true, [](const Call &c) {
        Arrays &a = c.arrays;
        return c.calls.hol_solve(c.chains, a.r.packed(), a.f.packed(), a.more.data(), a.g.packed(), HOL_WRITE, nullptr);
    });
    list.one("reactions, 32 bonds", coil(32), false, true, [](const Call &c) {
        Arrays &a = c.arrays;
        return c.calls.hol_reactions(c.chains, a.r.packed(), HOL_BOX, a.lambda.data(), nullptr, a.g.packed(), HOL_WRITE,
                                     nullptr, nullptr);
    });
    list.one("violation, 32 bonds", coil(32), false, true, [](const Call &c) {
        hol_worst worst;
        return c.calls.hol_violation(c.chains, c.arrays.r.packed(), c.arrays.v.packed(), &worst);
    });
}

/// As programs call: sums and reports beside short chains, positions that are right already, tolerances.
void add_calls_of_programs(List &list) {
    for (std::int64_t n : {1, 3, 5}) {
        list.one("forces, " + of_bonds(n) + ", virial", coil(n), false, false, [](const Call &c) {
            Arrays &a = c.arrays;
            double virial[9];
            return c.calls.hol_forces(c.chains, a.r.packed(), a.v.packed(), a.f.packed(), a.lambda.data(), nullptr,
                                      a.g.packed(), HOL_WRITE, virial);
        });
        list.one("velocities, " + of_bonds(n) + ", virial", coil(n), false, false, [](const Call &c) {
            Arrays &a = c.arrays;
            double virial[9];
            return c.calls.hol_project_velocities(c.chains, a.r.packed(), a.v.packed(), a.lambda.data(), virial);
        });
        list.one("positions, " + of_bonds(n) + ", virial", coil(n), true, false, [](const Call &c) {
            Arrays &a = c.arrays;
            double virial[9];
            return c.calls.hol_project_positions(c.chains, a.reference.packed(), a.r.packed(), a.v.packed(), c.scene.dt,
                                                 a.lambda.data(), 0, virial, nullptr);
        });
        list.one("positions, " + of_bonds(n) + ", report", coil(n), true, false, [](const Call &c) {
            Arrays &a = c.arrays;
            hol_report report;
            return c.calls.hol_project_positions(c.chains, a.reference.packed(), a.r.packed(), a.v.packed(), c.scene.dt,
                                                 a.lambda.data(), 0, nullptr, &report);
        });
    }
    for (std::int64_t n : {1, 2, 3, 5, 32})
        list.one("positions, " + of_bonds(n) + ", nothing to do", coil(n), false, false, [](const Call &c) {
            Arrays &a = c.arrays;
            return c.calls.hol_project_positions(c.chains, a.reference.packed(), a.r.packed(), a.v.packed(), c.scene.dt,
                                                 a.lambda.data(), 0, nullptr, nullptr);
        });
    for (std::int64_t n : {1, 2, 3, 5, 32})
        for (const char *tolerance : {"1e-10", "1e-8", "1e-6", "3e-5", "1e-4", "1e-3", "1e-2"})
            list.one("positions, " + of_bonds(n) + ", tolerance " + tolerance, coil(n), true, false,
                     [tolerance](const Call &c) {
                         Arrays &a = c.arrays;
                         const int status = c.calls.hol_chains_set_tolerance(c.chains, std::stod(tolerance));
                         if (status != HOL_OK) return status;
                         return c.calls.hol_project_positions(c.chains, a.reference.packed(), a.r.packed(),
                                                              a.v.packed(), c.scene.dt, a.lambda.data(), 0, nullptr,
                                                              nullptr);
                     });
}

/// Factors that are kept: beside the row of hol_forces on the same molecules, 0.6 of it and, of a right-hand side,
/// 0.35.
void add_factors(List &list) {
    const auto add = [&](const std::string &name, const std::function<Recipe()> &recipe) {
        list.one("kept forces, " + name, recipe, false, false, [](const Call &c) {
            Arrays &a = c.arrays;
            return c.calls.hol_factors_forces(c.factors, a.v.packed(), a.f.packed(), a.lambda.data(), nullptr,
                                              a.g.packed(), HOL_WRITE, nullptr);
        });
        list.one("kept solve, " + name, recipe, false, false, [](const Call &c) {
            Arrays &a = c.arrays;
            return c.calls.hol_factors_solve(c.factors, 1, a.f.packed(), a.more.data(), nullptr, HOL_WRITE, nullptr);
        });
        for (std::size_t i = list.rows.size() - 2; i < list.rows.size(); ++i) list.rows[i].keeps = true;
    };
    for (std::int64_t n : {1, 3, 10, 100, 1000}) add(of_bonds(n), coil(n));
    add("water", of(2000, bench::water_kind));
    add("CH3", of(2000, [] { return bench::formula_kind("C(H)(H)H"); }));
    add("butane", of(400, [] { return bench::formula_kind("C(H)(H)(H)C(H)(H)C(H)(H)C(H)(H)H"); }));
    add("comb, 20 + 20", of(150, [] { return bench::comb_kind(20, 1); }));
    add("ring of 50", of(120, [] { return bench::ring_kind(50); }));
    add("toluene", of(400, [] { return bench::formula_kind("C(H)(H)(H)C1C(H)C(H)C(H)C(H)C1H"); }));
    add("naphthalene", of(300, [] { return bench::formula_kind("C1C(H)C(H)C(H)C(H)C1C2C(H)C(H)C(H)C(H)C12"); }));
}

void add_molecules(List &list) {
    const auto formula = [](const char *text) { return [text] { return bench::formula_kind(text); }; };
    const auto water = of(2000, bench::water_kind), ch3 = of(2000, formula("C(H)(H)H")),
               ch4 = of(1500, formula("C(H)(H)(H)H")), butane = of(400, formula("C(H)(H)(H)C(H)(H)C(H)(H)C(H)(H)H")),
               toluene = of(400, formula("C(H)(H)(H)C1C(H)C(H)C(H)C(H)C1H")),
               dodecane = of(160, formula("C(H)(H)(H)C(H)(H)C(H)(H)C(H)(H)C(H)(H)C(H)(H)C(H)(H)C(H)(H)C(H)(H)C(H)(H)"
                                          "C(H)(H)C(H)(H)H"));
    list.add("CH", of(4000, formula("CH")));
    list.add("CH2", of(2000, formula("C(H)H")));
    list.add("CH3", ch3);
    list.add("CH4", ch4);
    list.add("water", water);
    list.add("butane", butane);
    list.add("dodecane", dodecane);
    list.add("toluene", toluene);
    for (Boxed box : {Boxed::no, Boxed::orthorhombic, Boxed::triclinic})
        for (Order order : {Order::consecutive, Order::apart, Order::any}) {
            if (box == Boxed::no && order == Order::consecutive) continue;  // above
            if (box == Boxed::triclinic && order != Order::consecutive) continue;
            list.add("water", water, order, box);
            list.add("CH3", ch3, order, box);
            list.add("dodecane", dodecane, order, box);
            list.add("toluene", toluene, order, box);
        }
    for (Layout layout : {Layout::separate, Layout::floats}) {
        for (Boxed box : {Boxed::no, Boxed::orthorhombic}) list.add("water", water, Order::consecutive, box, layout);
        list.add("CH3", ch3, Order::consecutive, Boxed::no, layout);
        list.add("CH4", ch4, Order::consecutive, Boxed::no, layout);
        list.add("butane", butane, Order::consecutive, Boxed::no, layout);
        list.add("dodecane", dodecane, Order::consecutive, Boxed::no, layout);
    }
    // Centres from far lighter to far heavier than the others, of 4: what is found without subtraction takes as long
    // for any.
    const std::pair<const char *, double> centres[] = {{"1e-6", 1e-6}, {"0.001", 0.001}, {"0.04", 0.04}, {"1e6", 1e6}};
    const std::pair<const char *, const char *> stars[] = {
        {"XH2", "C(H)H"}, {"XH3", "C(H)(H)H"}, {"XH4", "C(H)(H)(H)H"}};
    for (const auto &star : stars)
        for (const auto &centre : centres) {
            list.chosen = centre.second < 0.01 ? "forces velocities" : "forces velocities positions";
            list.add(std::string(star.first) + ", X of " + centre.first, of(1500, [star, centre] {
                         bench::Kind kind = bench::formula_kind(star.second);
                         for (std::size_t i = 0; i < kind.mass.size(); ++i) {
                             kind.mass[i] = i == 0 ? centre.second : 4;
                             kind.w[i] = 1 / kind.mass[i];
                         }
                         return kind;
                     }));
        }
    list.add("CH, CH2, CH3 and water in turns", [formula] {
        return molecules(2400, {formula("CH")(), formula("C(H)H")(), formula("C(H)(H)H")(), bench::water_kind()});
    });
    list.add("comb, 20 + 20", of(150, [] { return bench::comb_kind(20, 1); }));
    list.add("brush, 219 bonds", of(28, [] { return bench::comb_kind(20, 10); }));
    list.add("dendrimer, 93 bonds", of(64, [] { return bench::dendrimer_kind(3, 2, 5); }));
    list.add("ring of 6", of(1000, [] { return bench::ring_kind(6); }));
    list.add("ring of 50", of(120, [] { return bench::ring_kind(50); }));
    list.add("strip of triangles, 50 atoms", of(60, [] { return bench::triangles_kind(50); }));
    list.add("naphthalene", of(300, formula("C1C(H)C(H)C(H)C(H)C1C2C(H)C(H)C(H)C(H)C12")));
    list.add("naphthalene of united atoms", of(500, formula("C1CCCCC1C2CCCC12")));
    list.add("biphenyl", of(300, formula("C(H)1C(H)C(H)C(H)C(H)C1C1C(H)C(H)C(H)C(H)C1H")));
    list.add("protein, 200", of(30, [] { return bench::protein_kind(200); }));
    list.add("random tree, 40 bonds", of(150, [] { return bench::random_tree_kind(40); }));
    list.add("random tree, 1e4", of(1, [] { return bench::random_tree_kind(10000); }));
    list.add("arms of 100, 1e4", of(1, [] { return bench::arms_kind(10000, 100); }));
    list.add("arms of 1000, 1e4", of(1, [] { return bench::arms_kind(10000, 1000); }));
    list.add("protein, 1e3", of(4, [] { return bench::protein_kind(1000); }));
    list.add("protein, 1e4", of(1, [] { return bench::protein_kind(10000); }));
    list.add("ring of 1e4", of(1, [] { return bench::ring_kind(10000); }));
    list.add("strip of triangles, 5000 atoms", of(1, [] { return bench::triangles_kind(5000); }));
    list.alone("water", of(1, bench::water_kind));
    list.alone("CH3", of(1, formula("C(H)(H)H")));
    list.alone("butane", of(1, formula("C(H)(H)(H)C(H)(H)C(H)(H)C(H)(H)H")));
}

}  // namespace

std::vector<Row> all_rows() {
    List list;
    add_chains(list);
    add_options(list);
    add_calls_of_programs(list);
    add_factors(list);
    add_molecules(list);
    return list.rows;
}

}  // namespace rows
