// Goes through the molecules with rigid bodies, on as many threads as the work is worth.
#pragma once

#include <initializer_list>

#include "core/kernels/tally.hpp"
#include "core/molecules/chains.hpp"
#include "core/rigid/bodies.hpp"
#include "core/rigid/system.hpp"
#include "core/run/diagnose.hpp"

namespace holonomic::rigid {

// What a call has found: sums, and why the first bad molecule is bad. Numbers of molecules are those of the set.
struct RunResult {
    Tally tally;
    Outcome first_outcome;
};

// What a verb does with one molecule. Nothing of a molecule that is not good has been written.
class BodyWork {
public:
    // g: forces that it writes, or absent. Fixed atoms are shared, so that molecules add to them one after the other.
    explicit BodyWork(const Chains &chains, const AtomArray &g = {})
        : is_in_order(g.x && !chains.bodies()->fixed_atoms().empty()) {}
    const bool is_in_order;

    virtual Outcome molecule(const System &system, const MoleculeView &view, Tally &tally) const = 0;
    // The same for bodies without bonds, side by side: bits of those that are done. The others come one by one.
    // bonds: also those that have some within them, whose values are wanted.
    virtual bool takes_blocks(bool bonds) const { return static_cast<void>(bonds), false; }
    virtual std::uint64_t bodies(const BodyUnit &, double *, BodyResult *) const { return 0; }
    // What a body that is done adds to the tally, if anything: its virial, or what else a verb has.
    virtual bool has_results() const { return false; }
    virtual void done(const BodyResult &result, std::int64_t number, Tally &tally) const {
        static_cast<void>(number);
        for (int i = 0; i < 6; ++i) tally.virial[i] += result.virial[i];
    }

protected:
    ~BodyWork() = default;
};

// Throws std::bad_alloc before anything is done, not if Parts has been made. Results do not depend on the number of
// threads.
RunResult run(const Chains &chains, const BodyWork &work);

// Values that a call was given per bond.
struct NamedValues {
    const char *what;
    const double *values;
};

// Throws the error of the first bad molecule, if there is one, once all others are complete: of arrays per atom or of
// values per bond that are not finite, or what its outcome says.
void throw_if_bad(const Chains &chains, const RunResult &found, std::initializer_list<NamedArray> arrays,
                  const NamedValues *values = nullptr);

// Goes through all, adds to the virial unless it is null, and returns the sums.
Tally run_all(const Chains &chains, const BodyWork &work, std::initializer_list<NamedArray> arrays, double *virial,
              const NamedValues *values = nullptr);

}  // namespace holonomic::rigid
