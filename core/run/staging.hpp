// Copies of the caller's arrays for those molecules that can't be worked on in place: values per bond in the order of
// the molecules, where the caller has them in another; atoms of molecules that share fixed atoms, each molecule with
// its own copy of the shared ones, so that no two kernels write to the same place.
#pragma once

#include <cstdint>
#include <new>
#include <type_traits>

#include "core/molecules/chains.hpp"

namespace holonomic {

class Staging {
public:
    // Takes memory of the calling thread for all arrays that a call may have: four per atom, and four per bond beside
    // one of `wide` values for each. Networks have a list of their bonds instead where nothing is wide and no other
    // molecule needs copies. Throws std::bad_alloc.
    explicit Staging(const Chains &chains, int wide = 0) : Staging(chains, chains.plan(), wide) {}
    Staging(const Chains &chains, const Plan &plan, int wide = 0)
        : chains_(chains), plan_(plan), reorders_(wide > 0 ? plan.reordered : plan.copied) {
        if (reorders() || stages()) take_memory(wide);
    }

    bool reorders() const { return reorders_; }
    bool stages() const { return !plan_.stage.empty(); }

    // Values per bond, `width` of them, or null: as they are in the caller's array, in the order of the molecules. Put
    // back at the end.
    double *results(double *callers, int width = 1);
    // The same of what is only read.
    const double *inputs(const double *callers);

    // A vector per atom of the stage, as the caller has it; absent if it is.
    AtomArray atoms(const AtomArray &callers);
    // Of which the atoms that can move are put back at the end. Fixed ones don't change.
    AtomArray moved_atoms(const AtomArray &callers);
    // Of which all are put back, the copies of a shared atom summed up: over what was there if add, else in its place
    // unless no kernel wrote any.
    AtomArray summed_atoms(const AtomArray &callers, bool add);

    // Writes everything to where it belongs.
    void put_back() const {
        if (n_values_ > 0 || n_atoms_ > 0) put_all_back();
    }

private:
    static constexpr int most = 4;
    enum class Use { read, moved, written, added };
    struct StagedValues {
        const double *callers;
        double *copy, *result;  // null: only read
        int width;
    };
    struct StagedAtoms {
        AtomArray callers, copy;
        Use use;
    };
    void take_memory(int wide);
    void put_all_back() const;
    StagedValues &copy_of(const double *callers, int width);
    AtomArray stage(const AtomArray &callers, Use use);
    void put_back(const StagedAtoms &atoms) const;
    void sum_copies(const StagedAtoms &atoms) const;

    const Chains &chains_;
    const Plan &plan_;
    const bool reorders_;
    char *memory_ = nullptr;  // what of it is free
    StagedValues values_[most + 1];
    StagedAtoms atoms_[most];
    int n_values_ = 0, n_atoms_ = 0;
};

// A call as it is given, and variants of it by Where: most calls need none, and none is set up for them.
template <class Call>
class Variants {
public:
    // `values` and `atoms` replace a variant's arrays. Variants that no molecule needs are not made.
    template <class Values, class Atoms>
    Variants(const Call &call, const Staging &staging, Values values, Atoms atoms)
        : call_(call), made_of_((staging.reorders() ? reordered : 0) | (staging.stages() ? staged : 0)) {
        for (int where = 1; where < n_wheres; ++where) {
            if ((where & made_of_) != where) continue;
            new (&made_[where - 1]) Call(call);
            if (where & reordered) values(made_[where - 1]);
            if (where & staged) atoms(made_[where - 1]);
        }
    }
    const Call &operator[](int where) const {
        where &= made_of_;
        return where == in_place ? call_ : made_[where - 1];
    }

private:
    const Call &call_;
    const int made_of_;
    static_assert(std::is_trivially_destructible<Call>::value, "nothing ends those that are made");
    union {
        Call made_[n_wheres - 1];
    };
};

// Bonds that are no constraints get a value of 0. Null: nothing.
inline void clear_unconstrained(const Chains &chains, double *values, int width = 1) {
    if (!values) return;
    for (const std::int64_t bond : chains.unconstrained())
        for (int i = 0; i < width; ++i) values[bond * width + i] = 0;
}

}  // namespace holonomic
