// The library on arrays that are not [n_atoms][3] of double: through views, and through index lists.
#include "holonomic_arrays.hpp"
#include "holonomic_parts.hpp"

namespace bench {
namespace {

template <class T>
struct Layout {
    Handle chains;
    Array<T> reference, r, v, f, g;
    Layout(const Problem &p, Level level, const Shape &shape, const std::vector<std::int64_t> &order)
        : chains(order.empty() ? make_block(p, p.chains) : make_listed(p, order)), reference(p, shape, order),
          r(p, shape, order), v(p, shape, order), f(p, shape, order), g(p, shape, order) {
        const State start(p, level);
        reference.copy_from(p.r);
        r.copy_from(start.r);
        v.copy_from(start.v);
        f.copy_from(p.f);
    }
    void call(Level level, const Problem &p, State &s) {
        const hol_view reference_view = reference.view(), r_view = r.view(), v_view = v.view(), f_view = f.view(),
                       g_view = g.view();
        const hol_const_view reference_read = hol_view_read(&reference_view), r_read = hol_view_read(&r_view),
                             v_read = hol_view_read(&v_view), f_read = hol_view_read(&f_view);
        double energy;
        if (level == Level::acceleration)
            check(hol_forces_view(chains.get(), &r_read, &v_read, &f_read, s.lambda.data(), nullptr, &g_view, HOL_WRITE,
                                  nullptr));
        else if (level == Level::velocity)
            check(hol_project_velocities_view(chains.get(), &reference_read, &v_view, s.lambda.data(), nullptr));
        else if (level == Level::metric)
            check(hol_metric_view(chains.get(), &r_read, 1.0, s.log_det.data(), nullptr, &energy, &g_view, HOL_WRITE));
        else
            check(hol_project_positions_view(chains.get(), &reference_read, &r_view, &v_view, p.dt, s.lambda.data(), 0,
                                             nullptr, nullptr));
    }
};

template <class T>
Method layout(Level level, const Problem &p, const std::string &setting, const Shape &shape,
              const std::vector<std::int64_t> &order = {}) {
    auto a = std::make_shared<Layout<T>>(p, level, shape, order);
    Method m;
    m.name = "holonomic";
    m.setting = setting;
    m.call = [a, level, &p](State &s) { a->call(level, p, s); };
    if (level == Level::acceleration || level == Level::metric) return m;  // which change none of their inputs
    m.before = [a](State &s) {
        a->r.copy_from(s.r);
        a->v.copy_from(s.v);
    };
    m.after = [a](State &s) {
        a->r.copy_to(s.r);
        a->v.copy_to(s.v);
    };
    return m;
}

}  // namespace

Method holonomic_flat(Level level, const Problem &p) {
    return layout<double>(level, p, "two dimensions", {2, 2, false});
}

Methods holonomic_layouts(Level level, const Problem &p) {
    const Shape packed = {3, 3, false}, padded = {3, 4, false}, apart = {3, 1, true};
    return {layout<double>(level, p, "view of the plain layout", packed),
            layout<double>(level, p, "x y z apart", apart), layout<double>(level, p, "padded to four doubles", padded),
            layout<float>(level, p, "float view", packed),
            layout<double>(level, p, "index list", packed, shuffled_atoms(p))};
}

}  // namespace bench
