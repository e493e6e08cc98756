// What one rank needs where GROMACS has a `Lincs`: its molecules, scratch, and the deviation that is shown. A rank of
// thread-MPI is a thread among others of one process, so nothing of this is shared.
#pragma once
#include <optional>

#include "molecules.hpp"

namespace holonomic {

// The domain of this thread's rank, for the numbers of atoms in the topology; null without domains.
inline thread_local const gmx_domdec_t *domain = nullptr;

// One call of gmx::constrain_lincs.
struct Call {
    int64_t step;
    const t_inputrec &parameters;
    const t_pbc *pbc;
    real *x, *q, *v;    // [n_atoms][3]; v may be null; q may be x
    double dt;          // of v
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
    int move_crude_start(const Call &);
    void measure(const Call &);

    std::vector<double> multipliers, scratch;
};

// What is left of the constraints.
struct Deviation {
    double sum_of_squares = 0, largest = 0;
    size_t bond = 0;  // of the largest
};
Deviation deviation(const Molecules &, real *q);

// Whether a bond has turned by more than lincs-warnangle between x and q.
bool any_turned(const Molecules &, const Call &);
// Tells and counts what GROMACS does: molecules that could not be solved, with the library's words, and turned bonds.
void warn(Molecules &, const Call &, int status);

// [n_atoms][3], in either precision.
template <typename T>
hol_view view(T *q) {
    return {q, q + 1, q + 2, 3 * sizeof(T), sizeof(T) == 8 ? HOL_DOUBLE : HOL_FLOAT, 0};
}

}  // namespace holonomic
