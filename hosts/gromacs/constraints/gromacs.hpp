// GROMACS as these sources see it: headers of its development package, and declarations of what they do not declare.
// Its functions are weak: a program that GROMACS is no part of, a shell for one, may be started with this object, too.
#pragma once
#include <cstdint>
#include <cstdio>
#include <functional>

#include "gromacs/math/vectypes.h"
#include "gromacs/mdtypes/inputrec.h"
#include "gromacs/mdtypes/md_enums.h"
#include "gromacs/pbcutil/pbc.h"
#include "gromacs/topology/idef.h"
#include "gromacs/topology/ifunc.h"
#include "gromacs/utility/arrayref.h"
#include "gromacs/utility/baseversion.h"
#include "gromacs/utility/listoflists.h"
#include "gromacs/utility/real.h"
#include "gromacs/version.h"
#if GMX_API_VERSION >= 20230000
#include <filesystem>
#endif

struct gmx_domdec_t;
struct gmx_mtop_t;
struct gmx_multisim_t;
struct gmx_wallcycle;
struct t_commrec;
struct t_nrnb;
enum class ModuleMultiThread : int { Lincs = 8 };

#define HOLONOMIC_WEAK __attribute__((weak))

#if GMX_API_VERSION >= 20230000
[[noreturn]] HOLONOMIC_WEAK void gmx_fatal(int, const std::filesystem::path &file, int line, const char *format, ...);
#else
[[noreturn]] HOLONOMIC_WEAK void gmx_fatal(int, const char *file, int line, const char *format, ...);
#endif
HOLONOMIC_WEAK const char *gmx_version();
HOLONOMIC_WEAK int gmx_omp_nthreads_get(ModuleMultiThread);
HOLONOMIC_WEAK int ddglatnr(const gmx_domdec_t *, int atom);  // counted from 1; without domains atom + 1
int dd_numHomeAtoms(const gmx_domdec_t &);

namespace gmx {

class Lincs;

// What is projected. With `Positions` lengths, with the others d . (q_j - q_i) = 0.
enum class ConstraintVariable : int { Positions, Velocities, Derivative, Deriv_FlexCon, Force, ForceDispl };

// GROMACS's class has a copy constructor of its own, so it is handed over by address, and this must be, too.
template <typename T>
class ArrayRefWithPadding {
public:
    ArrayRefWithPadding(const ArrayRefWithPadding &other)
        : begin(other.begin), end(other.end), padded_end(other.padded_end) {}
    T *data() const { return begin; }
    bool empty() const { return begin == end; }

private:
    T *begin, *end, *padded_end;
};

enum class ReductionRequirement : int { Soon, Eventually };
enum class ObservablesReducerStatus : int {};

// Sums over ranks that GROMACS makes with its own.
class ObservablesReducerBuilder {
public:
    using Require = std::function<ObservablesReducerStatus(ReductionRequirement)>;
    HOLONOMIC_WEAK void addSubscriber(int n_values, std::function<void(Require &&, ArrayRef<double>)> &&,
                                      std::function<void(int64_t)> &&reduced);
};

[[noreturn]] HOLONOMIC_WEAK void too_many_constraint_warnings(ConstraintAlgorithm, int n_warnings);

// These take the place of GROMACS's.
Lincs *init_lincs(FILE *log, const gmx_mtop_t &, int n_flexible, ArrayRef<const ListOfLists<int>>, bool split,
                  int iterations, int order, ObservablesReducerBuilder *);
void done_lincs(Lincs *);
real lincs_rmsd(const Lincs *);
void set_lincs(const InteractionDefinitions &, int n_atoms, ArrayRef<const real> inverse_masses, real lambda,
               bool dynamics, const t_commrec *, Lincs *);
bool constrain_lincs(bool wants_rmsd, const t_inputrec &, int64_t step, Lincs *, ArrayRef<const real> inverse_masses,
                     const t_commrec *, const gmx_multisim_t *, ArrayRefWithPadding<const RVec> x,
                     ArrayRefWithPadding<RVec> q, ArrayRef<RVec> projected, const matrix box, t_pbc *,
                     bool masses_change, real lambda, real *dvdlambda, real inverse_dt, ArrayRef<RVec> v,
                     bool wants_virial, tensor virial, ConstraintVariable, t_nrnb *, int max_warnings, int *n_warnings
#if GMX_API_VERSION >= 20230000
                     ,
                     gmx_wallcycle *
#endif
);

}  // namespace gmx
