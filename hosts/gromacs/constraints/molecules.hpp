// The molecules that the constraints of one rank form, kept from one distribution of atoms to the next.
#pragma once
#include <memory>
#include <string>

#include "arrangement.hpp"
#include "cut.hpp"
#include "gromacs.hpp"
#include "holonomic.h"

namespace holonomic {

struct Destroy {
    void operator()(hol_chains *chains) const { hol_chains_destroy(chains); }
};

class Molecules {
public:
    void set_topology(Topology &&whole) { topology = std::move(whole); }  // where domains may cut molecules
    // Takes the list as it is now. What has not changed is not made anew.
    void set(const InteractionDefinitions &, int n_atoms, gmx::ArrayRef<const real> inverse_masses, double lambda,
             bool dynamics);
    // Masses of another lambda, of the same atoms. Frozen atoms stay frozen.
    void set_masses(gmx::ArrayRef<const real> inverse_masses, double lambda);
    void set_lambda(double lambda);      // lengths between those of A and B
    void set_flexible(const double *x);  // flexible constraints have the lengths of x, at the places of `places`
    // The library's last message once more, with atoms as the topology counts them. `again` repeats the call.
    template <typename Call>
    std::string message(Call again) const {
        set_labels();
        again();
        return words();
    }
    [[noreturn]] void end_run() const;  // with the library's message

    hol_chains *chains() const { return handle.get(); }
    const Arrangement &places() const { return arrangement; }
    size_t n_bonds() const { return lengths.size(); }
    size_t n_atoms() const { return arrangement.atoms.size(); }
    int n_threads() const { return threads; }
    int number(int place) const;  // of the atom there, as the topology counts
    double length(size_t bond) const { return lengths[bond]; }
    // The part of a bond that is the rank's, by its atoms, where domains cut molecules; of sums over ranks each takes
    // that.
    bool cut() const { return !shares.empty(); }
    double share(size_t bond) const { return cut() ? shares[bond] : 1; }
    double shortest() const { return shortest_length; }
    double change_with_lambda(size_t bond) const { return arrangement.bonds[bond].b - arrangement.bonds[bond].a; }
    bool flexible(size_t bond) const { return arrangement.bonds[bond].a == 0 && arrangement.bonds[bond].b == 0; }
    double inverse_mass(size_t place) const { return masses[place] > 0 ? 1 / masses[place] : 0; }
    double mass_lambda() const { return lambda_of_masses; }
    bool perturbed() const { return any_perturbed; }

private:
    void make();
    bool add(hol_chains *) const;
    void leave_own(std::vector<Bond> &, int n_atoms) const;
    void find_shares();
    bool set_lengths();  // of lambda; whether one has changed
    void find_shortest();
    void set_labels() const;
    static std::string words();
    void check(int status) const {
        if (status != HOL_OK) end_run();
    }

    std::unique_ptr<hol_chains, Destroy> handle;
    Topology topology;
    std::vector<Bond> list;          // as GROMACS has it
    std::vector<double> all_masses;  // of the rank's atoms; 0: held fixed
    Arrangement arrangement;
    std::vector<double> lengths, masses, shares;  // at the arrangement's places
    double lambda_of_lengths = 0, lambda_of_masses = 0, shortest_length = 0;
    bool any_perturbed = false, any_flexible = false;
    int threads = 1;
};

// The domain of this thread's rank, for the numbers of atoms in the topology; null without domains.
inline thread_local const gmx_domdec_t *domain = nullptr;
inline thread_local int n_home = 0;  // its own atoms, which come first

}  // namespace holonomic
