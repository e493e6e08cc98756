// A call over all molecules: those of bonds alone, and those with rigid bodies. Verbs come here; none of them asks
// which there are.
#pragma once

#include "core/error.hpp"
#include "core/molecules/chains.hpp"
#include "core/run/execute.hpp"

namespace holonomic::rigid {

// Runs the parts of a call, that of molecules without bodies and that with them, each to its end; then throws the first
// Error, with all bad molecules counted. Where one finds no memory nothing has been written.
class Parts {
public:
    // Gets the memory that the part with bodies will need: throws std::bad_alloc before the other one has written.
    explicit Parts(const Chains &chains);
    // Fixed atoms have their forces back unless a part has come to its end.
    ~Parts();
    Parts(const Parts &) = delete;
    Parts &operator=(const Parts &) = delete;

    // g of fixed atoms at molecules with bodies is zero before anything is added to it.
    void clear_fixed(const AtomArray &g);

    template <class Part>
    void run(const Part &part) {
        try {
            part();
        } catch (const Error &error) {
            if (error.n_bad == 0) throw;
            if (failed_)
                error_.n_bad += error.n_bad;
            else
                error_ = error;
            failed_ = true;
        }
        ended_ = true;
    }
    // Throws if one has failed.
    void finish() const {
        if (failed_) throw error_;
    }

private:
    template <class Each>
    void for_each_fixed(const Each &each) const;

    const Chains &chains_;
    double *before_;  // forces on fixed atoms, in the memory that the part with bodies will write to
    AtomArray cleared_{};
    bool failed_ = false, ended_ = false;
    Error error_{};
};

template <class OfBonds, class OfBodies>
[[gnu::noinline]] void over_parts(const Chains &chains, const AtomArray *g, const OfBonds &of_bonds,
                                  const OfBodies &of_bodies) {
    Parts parts(chains);
    if (g && g->x) parts.clear_fixed(*g);
    parts.run(of_bonds);
    parts.run(of_bodies);
    parts.finish();
}
template <class OfBonds, class OfBodies>
[[gnu::noinline]] void over_parts(const Chains &chains, const AtomArray *g, double *virial, const OfBonds &of_bonds,
                                  const OfBodies &of_bodies) {
    double sum[9], *const to = virial ? sum : nullptr;
    over_parts(
        chains, g, [&] { of_bonds(to); }, [&] { of_bodies(to); });
    if (virial) write_virial(sum, virial);
}

// of_bonds(), and of_bodies() if there are bodies. `g`: what both write to in place of what was there, or null.
// Inlined by force: a call on one molecule of bonds passes here.
template <class OfBonds, class OfBodies>
__attribute__((always_inline)) inline void over_all(const Chains &chains, const AtomArray *g, const OfBonds &of_bonds,
                                                    const OfBodies &of_bodies) {
    if (__builtin_expect(!chains.bodies(), 1)) return of_bonds();
    over_parts(chains, g, of_bonds, of_bodies);
}

// The same with a virial [9] or null: of_bonds(virial) writes it, of_bodies(virial) adds to it.
template <class OfBonds, class OfBodies>
__attribute__((always_inline)) inline void over_all(const Chains &chains, const AtomArray *g, double *virial,
                                                    const OfBonds &of_bonds, const OfBodies &of_bodies) {
    if (__builtin_expect(!chains.bodies(), 1)) return of_bonds(virial);
    over_parts(chains, g, virial, of_bonds, of_bodies);
}

// Throws Error of Status::unsupported with these words if there are bodies.
inline void refuse_bodies(const Chains &chains, const char *words) {
    if (chains.bodies()) throw make_error(Status::unsupported, "%s", words);
}

}  // namespace holonomic::rigid
