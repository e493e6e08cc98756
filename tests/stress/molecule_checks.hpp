/**
 * @file molecule_checks.hpp
 * Compares what the library says about molecules with the reference solution, whose bounds are those of
 * tests/oracle/molecules/README.md.
 */
#ifndef STRESS_MOLECULE_CHECKS_HPP
#define STRESS_MOLECULE_CHECKS_HPP

#include <vector>

#include "hostile_molecule.hpp"
#include "molecule_quantities.hpp"
#include "molecule_reference.hpp"
#include "molecule_results.hpp"

namespace stress
{

/** What the reference says about a molecule. */
struct molecule_facts {
    bool regular = false;
    long double condition = 0, least_pivot = 0;
    /** Whether bounds are promised: trees and triangles always, rings as long as no pivot of Z~ is below 1e-24, graphs
     * 1e-20. Graphs with one below 1e-25 in another order may be refused, but not solved wrongly.
     */
    bool promised = false;
};

/** Everything about one molecule on its own. */
molecule_verdict check_alone(const hostile_molecule &m, const molecule_reference &exact, molecule_facts &facts);

/**
 * To the bit: alone, among the others with bonds in any order and direction, in separate arrays backwards, a second
 * time and on three threads; in units that are other powers of two, and mirrored. One verdict per molecule.
 */
void check_invariances(const std::vector<hostile_molecule> &molecules, std::uint64_t shuffle,
                       std::vector<molecule_verdict> &out);

/** By how much farther from `drifted` another solution is than the reference's, over what is allowed. Both have a
 * number for each of `drifted`. */
long double how_much_farther(const std::vector<double> &drifted, const long double *other, const long double *exact);

/** All but blanks times a factor; the first coordinates with the other sign. */
void scale(numbers &x, double factor);
void mirror(numbers &x);

/**
 * A zero may have either sign, which hangs on the sign of what is added to it; and where multipliers die away, numbers
 * underflow in one unit that do not in another.
 */
void without_signs_of_zeros(molecule_results &o);

/** Notes whether both are the same to the bit. */
void check_same(const molecule_results &one, const molecule_results &other, molecule_quantity q, molecule_verdict &out);

/** What failed keeps its outputs bit for bit; what did not has only finite ones. */
void check_outputs(const hostile_molecule &m, const molecule_results &part, molecule_verdict &out);

}  // namespace stress

#endif
