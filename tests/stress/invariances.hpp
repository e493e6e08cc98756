/**
 * @file invariances.hpp
 * The same chain told in another way: results must be the same to the last bit, or within the same bounds.
 */
#ifndef STRESS_INVARIANCES_HPP
#define STRESS_INVARIANCES_HPP

#include <vector>

#include "hostile_chain.hpp"
#include "quantities.hpp"

namespace stress
{

/** The last atom first. */
hostile_chain reversed(const hostile_chain &c);

/** Axes exchanged (x, y, z) -> (y, -z, x): an exact rotation by 120 degrees and a reflection. */
hostile_chain turned(const hostile_chain &c);

/**
 * To the bit: alone, among the others in shuffled order with gaps, on three threads, in separate arrays backwards, a
 * second time, in units that are other powers of two, and mirrored. One verdict per chain.
 */
void check_invariances(const std::vector<hostile_chain> &chains, std::uint64_t shuffle, std::vector<verdict> &out);

}  // namespace stress

#endif
