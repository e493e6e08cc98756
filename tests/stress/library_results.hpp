/**
 * @file library_results.hpp
 * Everything that the library says about some chains, through the public interface.
 */
#ifndef STRESS_LIBRARY_RESULTS_HPP
#define STRESS_LIBRARY_RESULTS_HPP

#include <holonomic.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "hostile_chain.hpp"

namespace stress
{

using vec = std::vector<double>;

struct handle_deleter {
    void operator()(hol_chains *c) const
    {
        hol_chains_destroy(c);
    }
    void operator()(hol_inverse *i) const
    {
        hol_inverse_destroy(i);
    }
};
using handle = std::unique_ptr<hol_chains, handle_deleter>;
using inverse_handle = std::unique_ptr<hol_inverse, handle_deleter>;

/** Several chains over the same arrays, their atoms in any order and with others, which hold NaN, between them. */
struct arrangement {
    std::vector<std::vector<std::int64_t>> atoms;  ///< of each chain
    std::int64_t n_atoms = 0, n_bonds = 0;
    vec r, v, f, drift;  ///< [n_atoms][3]
    handle chains;
};

/** In order without gaps if shuffle is 0, otherwise shuffled by it. */
arrangement arrange(const std::vector<const hostile_chain *> &parts, std::uint64_t shuffle);

struct library_results {
    int forces = 0, velocities = 0, positions = 0, metric = 0;  ///< statuses
    vec lambda, g, virial;
    vec log_det, fixman;
    vec velocity_lambda, v;
    vec position_lambda, r, moved;  ///< moved: velocities after the position level
    hol_report report;
};

/** dt: time step of the position level. Outputs that are not written hold unwritten(). */
library_results compute(const arrangement &a, double dt);

/** The same through separate arrays, each backwards. */
library_results compute_in_views(const arrangement &a, double dt);

/** The part of one chain, in the order of the chain. */
library_results part_of(const library_results &all, const arrangement &a, std::size_t chain);

/** A number that no calculation gives, told by its bits. */
double unwritten();
bool is_unwritten(double x);
bool same_bits(const vec &a, const vec &b);

}  // namespace stress

#endif
