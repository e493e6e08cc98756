#include "method.hpp"

#include <algorithm>
#include <cstdio>

namespace bench {

const char *level_name(Level level) {
    static const char *const names[] = {"acceleration", "velocity", "position", "metric", "solve"};
    return names[static_cast<int>(level)];
}

State::State(const Scene &p, Level level)
    : r(level == Level::position ? p.drifted : p.r), v(level == Level::velocity ? p.raw_v : p.v), g(p.r.size()),
      lambda(p.all_bonds()), log_det(p.n_chains()) {}

void State::restore(const Scene &p, Level level) {
    if (level == Level::position) {
        std::copy(p.drifted.begin(), p.drifted.end(), r.begin());
        std::copy(p.v.begin(), p.v.end(), v.begin());
    } else if (level == Level::velocity) {
        std::copy(p.raw_v.begin(), p.raw_v.end(), v.begin());
    }
}

std::string tolerance_setting(double tolerance) {
    char text[40];
    std::snprintf(text, sizeof text, "tolerance %.0e", tolerance);
    return text;
}

}  // namespace bench
