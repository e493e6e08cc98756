/** Handles of the library for the chains of a problem. */
#ifndef BENCH_METHODS_HOLONOMIC_CHAINS_HPP
#define BENCH_METHODS_HOLONOMIC_CHAINS_HPP

#include <holonomic.h>

#include <memory>
#include <vector>

#include "../problem.hpp"

namespace bench {

using Handle = std::unique_ptr<hol_chains, decltype(&hol_chains_destroy)>;

/// Ends the run with the library's message after a wrong call. Chains that the library reports as bad keep what they
/// had, and the error of the row shows it, as it does for the methods that report nothing.
void check(int status);

/// `chains` chains of the problem over atoms 0 .. of their own, added in one call.
Handle make_block(const Problem &p, std::int64_t chains);

/// One handle for all chains or, for a pool, one per chain.
std::vector<Handle> make_handles(const Problem &p, int threads);

/// The numbers of a chain's atoms in the order along it, shuffled in the same way in every chain.
std::vector<std::int64_t> shuffled_atoms(const Problem &p);

/// All chains in one handle, each added by its list of atoms in shuffled order.
Handle make_listed(const Problem &p, const std::vector<std::int64_t> &order);

}  // namespace bench

#endif
