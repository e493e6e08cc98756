/** The tables of the report and of docs/benchmarks.md: one per question, each from the rows of a run. */
#ifndef BENCH_TABLES_HPP
#define BENCH_TABLES_HPP

#include <string>

#include "table.hpp"

namespace bench {

/// When to use the library: beside the fastest other method that is as accurate.
std::string glance_block(const Table &all);
/// What was aimed at, and what was reached.
std::string targets_block(const Table &all);
/// The library beside the strongest others.
std::string summary_block(const Table &all);
/// Time per bond against the length of single chains, for all methods.
std::string sizes_block(const Table &all, const std::string &level);
/// Many chains in a call: time per bond, memory passes, two threads.
std::string batches_block(const Table &all);
/// Position level: error and time of every setting.
std::string accuracy_block(const Table &all, const std::string &problem);
/// Error of the multipliers against the condition number.
std::string condition_block(const Table &all);
std::string drift_block(const Table &all);
/// What each thing costs that a scene may do without.
std::string skips_block(const Table &all);
/// Scenes of chains or of molecules in which another method was faster, as accurate or not.
std::string losses_block(const Table &all, bool accurate, bool molecules);
/// Molecules of any topology, level by level: over chains of as many bonds, and beside the others.
std::string molecules_block(const Table &all);
std::string molecule_targets_block(const Table &all);
/// What it costs to tell the library what is bonded.
std::string adding_block(const Table &all);

}  // namespace bench

#endif
