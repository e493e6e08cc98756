/**
 * What is compared: a method is a call that does the work of one level for all molecules of a scene.
 */
#ifndef BENCH_METHOD_HPP
#define BENCH_METHOD_HPP

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scene.hpp"

namespace bench {

enum class Level { acceleration, velocity, position, metric, solve };

const char *level_name(Level level);

/// The arrays on which a call works.
struct State {
    std::vector<double> r, v;     ///< [atoms][3]; in: what the level starts from; out: projected
    std::vector<double> g;        ///< [atoms][3], constraint forces
    std::vector<double> lambda;   ///< [bonds of all chains]; level solve: the solution x
    std::vector<double> log_det;  ///< [chains]
    std::int64_t iterations = 0;  ///< largest number of iterations (sweeps) that a chain took

    State(const Scene &p, Level level);
    /// Puts back what a call of this level changes.
    void restore(const Scene &p, Level level);
};

struct Method {
    std::string name;     ///< as in results.csv
    std::string setting;  ///< "default", or what was changed
    std::function<void(State &)> call;
    int threads = 1;
    /// Before and after each call, not timed: for methods with arrays of their own.
    std::function<void(State &)> before = nullptr, after = nullptr;
    /// What is run for the error where `call` doesn't leave what the error is measured by.
    std::function<void(State &)> for_error = nullptr;
    double part_done = 1;          ///< the error is that of the first chains, this part of all
    std::size_t bonds_worked = 0;  ///< what the time is divided by, if not all bonds of the scene
    /// Of a method that works on a scene of its own; otherwise the error is that of the state that `call` was given.
    std::function<double()> own_error = nullptr;
};

using Methods = std::vector<Method>;

/// "tolerance 1e-06"
std::string tolerance_setting(double tolerance);

}  // namespace bench

#endif
