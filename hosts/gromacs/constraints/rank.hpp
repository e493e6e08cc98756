// What one rank needs where GROMACS has a `Lincs`: its molecules, scratch, and the deviation that is shown. A rank of
// thread-MPI is a thread among others of one process, so nothing of this is shared.
#pragma once
#include <optional>

#include "molecules.hpp"

namespace holonomic {

// One call of gmx::constrain_lincs.
struct Call {
    int64_t step;
    const t_inputrec &parameters;
    const t_pbc *pbc;
    const real *x;      // [n_atoms][3] of the rank
    real *q, *v;        // q may be x; v may be null
    double inverse_dt;  // of v
    double *virial;     // [3][3], or null: sum of r (x) m dq
    double *dvdlambda;  // or null
    int max_warnings;
    int *n_warnings;
};

struct Rank {
    Molecules molecules;

    // sqrt of the mean square of |d| / a - 1, of all ranks where there are several.
    std::optional<double> rmsd;
    gmx::ObservablesReducerBuilder::Require ask_for_sum;
    gmx::ArrayRef<double> sum;  // number of bonds, sum of squares

    bool positions(const Call &, bool wants_rmsd);
    void derivatives(const Call &, real *projected, gmx::ConstraintVariable);

private:
    double *multipliers_if(bool wanted);
    double derivative_by_lambda() const;
    void add_own_virial(double *) const;
    int move_crude_start();
    void measure(const Call &);

    // At the places of the molecules' arrangement. change: 0 between calls, what positions change by during one.
    std::vector<double> x, q, change, multipliers;
};

// What is left of the constraints at q, in the precision of GROMACS.
struct Deviation {
    double n_bonds = 0, sum_of_squares = 0, largest = 0;
    size_t bond = 0;  // of the largest
};
Deviation deviation(const Molecules &, const t_pbc *, const real *q);

// No bond turns by that angle in a step in which each atom moves by less: by half of this in each direction, and then
// by an eighth.
double no_turn(const Molecules &, const Call &);
// Whether a bond has turned by more than lincs-warnangle between x and q.
bool any_turned(const Molecules &, const Call &, const double *x, const double *q);
// Tells and counts what GROMACS does: molecules that could not be solved, in `words`, and turned bonds.
void warn(const Molecules &, const Call &, const std::string &words, int64_t n_unsolved, const double *x,
          const double *q);

}  // namespace holonomic
