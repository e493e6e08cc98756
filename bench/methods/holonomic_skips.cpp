// One thing less or more than the whole work of a level at a time.
#include <algorithm>

#include "holonomic_parts.hpp"

namespace bench {
namespace {

/// All that can be left out or added in a call with the plain arrays.
Methods parts_skips(Level level, const Problem &p, const Shared &h) {
    Methods list;
    auto add = [&](const std::string &setting, void (*change)(Parts &)) {
        Parts with;
        change(with);
        Method m = holonomic_row(level, p, setting, {with}, h);
        if (level == Level::acceleration && !with.lambda)  // the multipliers of the same call, had they been asked for
            m.for_error = holonomic_row(level, p, setting, {Parts()}, h).call;
        list.push_back(m);
    };
    if (level == Level::acceleration) {
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
        add("report too", [](Parts &w) { w.report = true; });
        add("r alone", [](Parts &w) { w.v = w.lambda = false; });
    }
    return list;
}

/// Multipliers as the last step would have left them: those of the acceleration level, halved since the drift is dt v.
Method with_guess(const Problem &p, const Shared &h) {
    State before(p, Level::acceleration);
    Parts plain;
    plain.f = plain.g = false;
    call(Level::acceleration, p, plain, *h, before);
    h->start = before.lambda;
    for (double &x : h->start) x /= 2;
    Parts with;
    with.guess = true;
    Method m = holonomic_row(Level::position, p, "guess", {with}, h);
    m.before = [h](State &s) { s.lambda = h->start; };
    return m;
}

Method satisfied(const Problem &p, const Shared &h) {
    Method m = holonomic_row(Level::position, p, "already satisfied", {Parts()}, h);
    m.before = [&p](State &s) { std::copy(p.r.begin(), p.r.end(), s.r.begin()); };
    return m;
}

/// The first `active` hundredths of the chains are active.
Method inactive(Level level, const Problem &p, const std::string &setting, std::size_t active) {
    auto h = std::make_shared<Handles>(p, 1);
    std::vector<unsigned char> flags(p.n_chains());
    for (std::size_t c = 0; c < flags.size(); ++c) flags[c] = 100 * c < active * flags.size();
    check(hol_chains_set_active(h->all[0].get(), flags.data()));
    Method m = holonomic_row(level, p, setting, {Parts()}, h);
    m.part_done = static_cast<double>(active) / 100;
    return m;
}

/// Every output in one pass over memory, and one call for each.
Methods together_and_apart(Level level, const Problem &p, const Shared &h) {
    if (level == Level::metric) {
        Parts log_det, gradient;
        log_det.gradient = gradient.log_det = false;
        return {holonomic_row(level, p, "outputs by separate calls", {log_det, gradient}, h)};
    }
    if (level != Level::acceleration) return {};
    Parts all, none;
    all.tension = all.virial = true;
    none.lambda = none.g = false;
    std::vector<Parts> apart(4, none);
    apart[0].lambda = apart[1].tension = apart[2].g = apart[3].virial = true;
    return {holonomic_row(level, p, "all outputs in one call", {all}, h),
            holonomic_row(level, p, "all outputs by separate calls", apart, h)};
}

Method boxed(Level level, const Problem &p, bool triclinic) {
    auto h = std::make_shared<Handles>(p, 1);
    // Wide enough that no bond is folded: the answer is that without a box, and the work is the box's.
    const double box[9] = {400, 0, 0, triclinic ? 30.0 : 0.0, 400, 0, triclinic ? 20.0 : 0.0, triclinic ? 10.0 : 0.0,
                           400};
    for (Handle &handle : h->all) check(hol_chains_set_box(handle.get(), box));
    return holonomic_row(level, p, triclinic ? "box triclinic" : "box orthorhombic", {Parts()}, h);
}

}  // namespace

Method holonomic_without(const Problem &p, bool v, bool f) {
    Parts with;
    with.v = !v, with.f = !f;
    const char *setting = v && f ? "v = NULL and f = NULL" : v ? "v = NULL" : "f = NULL";
    return holonomic_row(Level::acceleration, p, setting, {with}, std::make_shared<Handles>(p, 1));
}

Methods holonomic_skips(Level level, const Problem &p) {
    auto h = std::make_shared<Handles>(p, 1);
    Methods list = parts_skips(level, p, h);
    for (Method &m : together_and_apart(level, p, h)) list.push_back(m);
    if (level == Level::position) {
        list.push_back(with_guess(p, h));
        list.push_back(satisfied(p, h));
    }
    list.push_back(inactive(level, p, "half inactive", 50));
    list.push_back(inactive(level, p, "all inactive", 0));
    list.push_back(boxed(level, p, false));
    list.push_back(boxed(level, p, true));
    for (Method &m : holonomic_layouts(level, p)) list.push_back(m);
    return list;
}

}  // namespace bench
