/**
 * A call of the library's verb of a level, with everything that a caller may leave out: what the rows of the library
 * differ in.
 */
#ifndef BENCH_METHODS_HOLONOMIC_PARTS_HPP
#define BENCH_METHODS_HOLONOMIC_PARTS_HPP

#include <memory>

#include "holonomic_chains.hpp"
#include "methods.hpp"

namespace bench {

/// What a call is given. The defaults are the whole work of a level.
struct Parts {
    bool v = true, f = true, lambda = true, g = true, virial = false, tension = false, add = false, guess = false;
    bool report = false;                   ///< positions
    bool log_det = true, gradient = true;  ///< metric; gradient: the Fixman energy and force
};

/// The handles of a problem, one per call, and arrays that only the library's rows need.
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

/// One call of the level's verb for each handle.
void call(Level level, const Problem &p, const Parts &with, Handles &h, State &s);

/// A row of the library: the calls of all `parts`, one after the other.
Method holonomic_row(Level level, const Problem &p, const std::string &setting, const std::vector<Parts> &parts,
                     const Shared &h);

/// The same work on arrays in other layouts: holonomic_layouts.cpp.
Methods holonomic_layouts(Level level, const Problem &p);

}  // namespace bench

#endif
