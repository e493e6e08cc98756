// The molecules that the constraints of one rank form, kept from one distribution of atoms to the next.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "gromacs.hpp"
#include "holonomic.h"

namespace holonomic {

struct Destroy {
    void operator()(hol_chains *chains) const { hol_chains_destroy(chains); }
};

class Molecules {
public:
    // Takes the list as it is now. What has not changed is not made anew.
    void set(const InteractionDefinitions &, int n_atoms, gmx::ArrayRef<const real> inverse_masses, double lambda,
             bool dynamics);
    void set_masses(gmx::ArrayRef<const real> inverse_masses, double lambda);
    void set_lambda(double lambda);             // lengths between those of A and B
    void set_flexible(const hol_view &x);       // flexible constraints have the lengths of x
    void set_box(const t_pbc *);                // null: molecules are whole
    void set_labels(const gmx_domdec_t *);      // atoms as the topology counts them

    hol_chains *chains() const { return handle.get(); }
    bool empty() const { return pairs.empty(); }
    size_t n_bonds() const { return lengths.size(); }
    int n_atoms() const { return static_cast<int>(masses.size()); }
    int first_atom(size_t bond) const { return static_cast<int>(pairs[2 * bond]) - 1; }
    int second_atom(size_t bond) const { return static_cast<int>(pairs[2 * bond + 1]) - 1; }
    double length(size_t bond) const { return lengths[bond]; }
    double change_with_lambda(size_t bond) const { return length_b[bond] - length_a[bond]; }
    double inverse_mass(int atom) const { return masses[atom] > 0 ? 1 / masses[atom] : 0; }
    double mass_lambda() const { return lambda_of_masses; }
    bool perturbed() const { return any_perturbed; }
    bool flexible(size_t bond) const { return length_a[bond] == 0 && length_b[bond] == 0; }

private:
    void make();
    bool set_lengths();  // of lambda; whether one has changed

    std::unique_ptr<hol_chains, Destroy> handle;
    std::vector<int64_t> pairs;  // counted from 1, as GROMACS's messages do
    std::vector<double> length_a, length_b, lengths, masses;
    double lambda_of_lengths = 0, lambda_of_masses = 0;
    bool any_perturbed = false, any_flexible = false;
};

// GROMACS's end of a run, with the library's words and `hint`.
[[noreturn]] void end_run(const std::string &hint);

}  // namespace holonomic
