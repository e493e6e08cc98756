// The library through its public header: the whole work of each level, and one thing less or more at a time.
#include <memory>

#include "holonomic_arrays.hpp"
#include "holonomic_chains.hpp"
#include "methods.hpp"

namespace bench {
namespace {

/// What a call is given; everything a caller may leave out.
struct Parts {
    bool v = true, f = true, lambda = true, g = true, virial = false, tension = false, add = false, guess = false;
    bool gradient = true;  ///< metric: the Fixman energy and force beside ln det
};

struct Handles {
    std::vector<Handle> all;
    std::vector<double> start;    ///< multipliers of a step before, where Parts::guess
    std::vector<double> tension;  ///< output
    std::size_t atoms_each, bonds_each;
    Handles(const Problem &p, int threads)
        : all(make_handles(p, threads)), tension(p.all_bonds()), atoms_each(p.atoms() / all.size()),
          bonds_each(p.all_bonds() / all.size()) {}
};

using Shared = std::shared_ptr<Handles>;

double *at(std::vector<double> &x, std::size_t i, bool wanted = true) { return wanted ? x.data() + i : nullptr; }
const double *at(const std::vector<double> &x, std::size_t i, bool wanted = true) {
    return wanted ? x.data() + i : nullptr;
}

void forces(const Problem &p, const Parts &with, Handles &h, State &s) {
    double virial[9];
    for (std::size_t c = 0; c < h.all.size(); ++c) {
        const std::size_t atom = 3 * c * h.atoms_each, bond = c * h.bonds_each;
        check(hol_forces(h.all[c].get(), at(p.r, atom), at(p.v, atom, with.v), at(p.f, atom, with.f),
                         at(s.lambda, bond, with.lambda), at(h.tension, bond, with.tension), at(s.g, atom, with.g),
                         with.add ? HOL_ADD : HOL_WRITE, with.virial ? virial : nullptr));
    }
}

void velocities(const Problem &p, const Parts &with, Handles &h, State &s) {
    double virial[9];
    for (std::size_t c = 0; c < h.all.size(); ++c) {
        const std::size_t atom = 3 * c * h.atoms_each;
        check(hol_project_velocities(h.all[c].get(), at(p.r, atom), at(s.v, atom),
                                     at(s.lambda, c * h.bonds_each, with.lambda), with.virial ? virial : nullptr));
    }
}

void positions(const Problem &p, const Parts &with, Handles &h, State &s) {
    double virial[9];
    s.iterations = 0;
    for (std::size_t c = 0; c < h.all.size(); ++c) {
        const std::size_t atom = 3 * c * h.atoms_each;
        hol_report report;
        check(hol_project_positions(h.all[c].get(), at(p.r, atom), at(s.r, atom), at(s.v, atom, with.v), p.dt,
                                    at(s.lambda, c * h.bonds_each, with.lambda), with.guess,
                                    with.virial ? virial : nullptr, &report));
        s.iterations = std::max(s.iterations, report.iterations);
    }
}

void metric(const Problem &p, const Parts &with, Handles &h, State &s) {
    double energy;
    for (std::size_t c = 0; c < h.all.size(); ++c) {
        const std::size_t atom = 3 * c * h.atoms_each;
        check(hol_metric(h.all[c].get(), at(p.r, atom), 1.0, at(s.log_det, c * (h.bonds_each / p.n())), nullptr,
                         with.gradient ? &energy : nullptr, at(s.g, atom, with.gradient), HOL_WRITE));
    }
}

Method make(Level level, const Problem &p, const std::string &setting, const Parts &with, const Shared &h) {
    Method m;
    m.name = "holonomic";
    m.setting = setting;
    m.call = [level, &p, with, h](State &s) {
        switch (level) {
            case Level::acceleration:
                return forces(p, with, *h, s);
            case Level::velocity:
                return velocities(p, with, *h, s);
            case Level::position:
                return positions(p, with, *h, s);
            case Level::metric:
                return metric(p, with, *h, s);
            case Level::solve:
                break;
        }
    };
    return m;
}

/// All that can be left out or added in a call with the plain arrays.
Methods parts_skips(Level level, const Problem &p, const Shared &h) {
    Methods list;
    auto add = [&](const std::string &setting, void (*change)(Parts &)) {
        Parts with;
        change(with);
        list.push_back(make(level, p, setting, with, h));
    };
    if (level == Level::acceleration) {
        add("v = NULL", [](Parts &w) { w.v = false; });
        add("f = NULL", [](Parts &w) { w.f = false; });
        add("no g", [](Parts &w) { w.g = false; });
        add("tension too", [](Parts &w) { w.tension = true; });
        add("g added to", [](Parts &w) { w.add = true; });
    }
    if (level == Level::metric)
        add("log_det alone", [](Parts &w) { w.gradient = false; });
    else {
        add("no lambda", [](Parts &w) { w.lambda = false; });
        add("virial too", [](Parts &w) { w.virial = true; });
    }
    if (level == Level::position) {
        add("v = NULL", [](Parts &w) { w.v = false; });
        add("r alone", [](Parts &w) { w.v = w.lambda = false; });
    }
    return list;
}

/// Multipliers as the last step would have left them: those of the acceleration level, halved since the drift is dt v.
Method with_guess(const Problem &p, const Shared &h) {
    State before(p, Level::acceleration);
    Parts plain;
    plain.f = plain.g = false;
    forces(p, plain, *h, before);
    h->start = before.lambda;
    for (double &x : h->start) x /= 2;
    Parts with;
    with.guess = true;
    Method m = make(Level::position, p, "guess", with, h);
    m.before = [h](State &s) { s.lambda = h->start; };
    return m;
}

Method satisfied(const Problem &p, const Shared &h) {
    Method m = make(Level::position, p, "already satisfied", Parts(), h);
    m.before = [&p](State &s) { std::copy(p.r.begin(), p.r.end(), s.r.begin()); };
    return m;
}

Method half_inactive(Level level, const Problem &p) {
    auto h = std::make_shared<Handles>(p, 1);
    std::vector<unsigned char> active(p.n_chains());
    for (std::size_t c = 0; c < active.size(); ++c) active[c] = c < active.size() / 2;
    check(hol_chains_set_active(h->all[0].get(), active.data()));
    return make(level, p, "half inactive", Parts(), h);
}

Method boxed(Level level, const Problem &p, bool triclinic) {
    auto h = std::make_shared<Handles>(p, 1);
    // Wide enough that no bond is folded: the answer is that without a box, and the work is the box's.
    const double box[9] = {400, 0, 0, triclinic ? 30.0 : 0.0, 400, 0, triclinic ? 20.0 : 0.0, triclinic ? 10.0 : 0.0,
                           400};
    for (Handle &handle : h->all) check(hol_chains_set_box(handle.get(), box));
    return make(level, p, triclinic ? "box triclinic" : "box orthorhombic", Parts(), h);
}

template <class T>
struct Layout {
    Handle chains;
    Array<T> reference, r, v, f, g;
    Layout(const Problem &p, typename Array<T>::Components components, const std::vector<std::int64_t> &order)
        : chains(order.empty() ? make_block(p, p.chains) : make_listed(p, order)), reference(p, components, order),
          r(p, components, order), v(p, components, order), f(p, components, order), g(p, components, order) {
        reference.copy_from(p.r);
        f.copy_from(p.f);
    }
};

template <class T>
Method laid_out(Level level, const Problem &p, const std::string &setting, std::shared_ptr<Layout<T>> a) {
    Method m;
    m.name = "holonomic";
    m.setting = setting;
    m.before = [a](State &s) {
        a->r.copy_from(s.r);
        a->v.copy_from(s.v);
    };
    m.after = [a](State &s) {
        a->r.copy_to(s.r);
        a->v.copy_to(s.v);
    };
    m.call = [a, level, &p](State &s) {
        const hol_view reference = a->reference.view(), r = a->r.view(), v = a->v.view(), f = a->f.view(),
                       g = a->g.view();
        double energy;
        if (level == Level::acceleration)
            check(hol_forces_view(a->chains.get(), &r, &v, &f, s.lambda.data(), nullptr, &g, HOL_WRITE, nullptr));
        else if (level == Level::velocity)
            check(hol_project_velocities_view(a->chains.get(), &reference, &v, s.lambda.data(), nullptr));
        else if (level == Level::metric)
            check(hol_metric_view(a->chains.get(), &r, 1.0, s.log_det.data(), nullptr, &energy, &g, HOL_WRITE));
        else
            check(hol_project_positions_view(a->chains.get(), &reference, &r, &v, p.dt, s.lambda.data(), 0, nullptr,
                                             nullptr));
    };
    return m;
}

template <class T>
Method layout(Level level, const Problem &p, const std::string &setting, typename Array<T>::Components components,
              const std::vector<std::int64_t> &order) {
    return laid_out<T>(level, p, setting, std::make_shared<Layout<T>>(p, components, order));
}

}  // namespace

Method holonomic(Level level, const Problem &p, int threads) {
    Method m = make(level, p, "default", Parts(), std::make_shared<Handles>(p, threads));
    m.threads = threads;
    return m;
}

Method holonomic_tolerance(const Problem &p, double tolerance) {
    auto h = std::make_shared<Handles>(p, 1);
    for (Handle &handle : h->all) check(hol_chains_set_tolerance(handle.get(), tolerance));
    return make(Level::position, p, tolerance_setting(tolerance), Parts(), h);
}

Method holonomic_solve(const Problem &p, const UnitSystems &systems) {
    return {"holonomic", "default", [&p, &systems](State &s) {
                const std::size_t n = p.n();
                for (std::size_t c = 0; c < p.n_chains(); ++c)
                    check(hol_tridiagonal_solve(p.bonds, systems.gamma.data() + c * n + (n > 1 ? 1 : 0),
                                                &systems.right_side[c * n], &s.lambda[c * n]));
            }};
}

Methods holonomic_skips(Level level, const Problem &p) {
    auto h = std::make_shared<Handles>(p, 1);
    Methods list = parts_skips(level, p, h);
    if (level == Level::position) {
        list.push_back(with_guess(p, h));
        list.push_back(satisfied(p, h));
    }
    list.push_back(half_inactive(level, p));
    list.push_back(boxed(level, p, false));
    list.push_back(boxed(level, p, true));
    using Together = Array<double>::Components;
    list.push_back(layout<double>(level, p, "x y z apart", Together::apart, {}));
    list.push_back(layout<float>(level, p, "float view", Array<float>::Components::together, {}));
    list.push_back(layout<double>(level, p, "index list", Together::together, shuffled_atoms(p)));
    return list;
}

}  // namespace bench
