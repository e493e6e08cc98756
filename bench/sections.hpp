/** Which methods are measured on which problems: one section per question. */
#ifndef BENCH_SECTIONS_HPP
#define BENCH_SECTIONS_HPP

#include "errors.hpp"
#include "measure.hpp"
#include "results.hpp"

namespace bench {

enum class Extent { tiny, quick, full };

/// What a section works with.
struct Run {
    Extent extent;
    Effort effort;
    Results &results;
    int threads;  ///< of the rows with more than one thread; 1: there are none

    bool full() const { return extent == Extent::full; }
    /// Measures, stores, and says so. Level solve needs its systems.
    void measure(Level level, const Problem &p, const Methods &methods, const UnitSystems *systems = nullptr) const;
    void measure(Level level, const Scene &p, const Methods &methods, const ErrorOf &error_of) const;
};

void acceleration_section(const Run &run);
void velocity_section(const Run &run);
void position_section(const Run &run);
void metric_section(const Run &run);
void solve_section(const Run &run);
void skips_section(const Run &run);
/// Multipliers of chains from condition number 1 to 1e16.
void condition_section(const Run &run);
/// Energy drift of a melt against the tolerance of the constraints.
void drift_section(const Run &run);
/// Molecules of any topology, level by level.
void molecules_section(const Run &run);
/// Making a handle: telling the library what is bonded.
void adding_section(const Run &run);
/// The library as it is, for one instruction set per process: rows are named after it.
void instruction_set_section(const Run &run);

}  // namespace bench

#endif
