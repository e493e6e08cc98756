// Goes through the molecules with rigid bodies, on as many threads as the work is worth.
#pragma once

#include "core/kernels/tally.hpp"
#include "core/molecules/chains.hpp"
#include "core/rigid/bodies.hpp"
#include "core/rigid/system.hpp"

namespace holonomic::rigid {

// What a call has found: sums, and why the first bad molecule is bad. Numbers of molecules are those of the set.
struct RunResult {
    Tally tally;
    Outcome first_outcome;
};

// What a verb does with one molecule. Nothing of a molecule that is not good has been written.
class BodyWork {
public:
    virtual Outcome molecule(const System &system, const MoleculeView &view, Tally &tally) const = 0;
    // The same for bodies without bonds, side by side: bits of those that are done. The others come one by one.
    // bonds: also those that have some within them, whose values are wanted.
    virtual bool takes_blocks(bool bonds) const { return static_cast<void>(bonds), false; }
    virtual std::uint64_t bodies(const BodyUnit &, double *, BodyResult *) const { return 0; }
    // What a body that is done adds to the tally, if anything.
    virtual bool has_results() const { return false; }
    virtual void done(const BodyResult &, std::int64_t number, Tally &) const { static_cast<void>(number); }
    // Whether molecules add to atoms that they share, fixed ones: one after the other.
    virtual bool is_in_order() const { return false; }

protected:
    ~BodyWork() = default;
};

// Throws std::bad_alloc before anything is done, not if Parts has been made. Results do not depend on the number of
// threads.
RunResult run(const Chains &chains, const BodyWork &work);

// The error of the first bad molecule, once all others are complete.
struct Named {
    const char *what;
    const AtomArray *array;
};
Error error_of(const Chains &chains, const RunResult &found, const Named *arrays, int n_arrays);

// The same, or that of a value per bond that is not finite, if there is one.
Error error_of_values(const Chains &chains, std::int64_t molecule, const double *values, const char *what,
                      const Error &otherwise);

}  // namespace holonomic::rigid
