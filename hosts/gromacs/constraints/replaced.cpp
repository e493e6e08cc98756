// The functions of GROMACS that these take the place of. The dynamic linker finds them first, also from within
// libgromacs, because this object is loaded before it. What stands in GROMACS's own `Lincs` is looked at nowhere.
#include <cmath>
#include <map>
#include <mutex>

#include "found.hpp"
#include "rank.hpp"

namespace {

using holonomic::Rank;

std::mutex mutex;
std::map<const gmx::Lincs *, std::unique_ptr<Rank>> ranks;

Rank &rank_of(const gmx::Lincs *lincs) {
    const std::lock_guard<std::mutex> lock(mutex);
    std::unique_ptr<Rank> &rank = ranks[lincs];
    if (!rank) rank = std::make_unique<Rank>();
    return *rank;
}

// The sum over ranks is made with GROMACS's own, some time before lincs_rmsd is asked.
void join_sums(Rank &rank, gmx::ObservablesReducerBuilder &builder) {
    builder.addSubscriber(
        2,
        [&rank](gmx::ObservablesReducerBuilder::Require &&require, gmx::ArrayRef<double> values) {
            rank.ask_for_sum = std::move(require);
            rank.sum = values;
        },
        [&rank](int64_t) {
            if (rank.sum[0] > 0) rank.rmsd = std::sqrt(rank.sum[1] / rank.sum[0]);
        });
}

}  // namespace

namespace gmx {

Lincs *init_lincs(FILE *log, const gmx_mtop_t &topology, int n_flexible, ArrayRef<const ListOfLists<int>> constraints,
                  bool split, int iterations, int order, ObservablesReducerBuilder *builder) {
    static const auto original = holonomic::original(&init_lincs);
    Lincs *const lincs = original(log, topology, n_flexible, constraints, split, iterations, order, builder);
    holonomic::domain = nullptr;
    if (log) {
        for (FILE *file : {log, stderr}) holonomic::tell_what_was_found(file);
    }
    Rank &rank = rank_of(lincs);
    if (split) rank.molecules.set_topology(holonomic::Topology(topology, constraints));
    if (builder) join_sums(rank, *builder);
    return lincs;
}

void done_lincs(Lincs *lincs) {
    static const auto original = holonomic::original(&done_lincs);
    {
        const std::lock_guard<std::mutex> lock(mutex);
        ranks.erase(lincs);
    }
    original(lincs);
}

real lincs_rmsd(const Lincs *lincs) { return static_cast<real>(rank_of(lincs).rmsd.value_or(0)); }

void set_lincs(const InteractionDefinitions &definitions, int n_atoms, ArrayRef<const real> inverse_masses, real lambda,
               bool dynamics, const t_commrec *, Lincs *lincs) {
    rank_of(lincs).molecules.set(definitions, n_atoms, inverse_masses, lambda, dynamics);
}

bool constrain_lincs(bool wants_rmsd, const t_inputrec &parameters, int64_t step, Lincs *lincs,
                     ArrayRef<const real> inverse_masses, const t_commrec *, const gmx_multisim_t *,
                     ArrayRefWithPadding<const RVec> x, ArrayRefWithPadding<RVec> q, ArrayRef<RVec> projected,
                     const matrix, t_pbc *pbc, bool masses_change, real lambda, real *dvdlambda, real inverse_dt,
                     ArrayRef<RVec> v, bool wants_virial, tensor virial, ConstraintVariable what, t_nrnb *,
                     int max_warnings, int *n_warnings
#if GMX_API_VERSION >= 20230000
                     ,
                     gmx_wallcycle *
#endif
) {
    Rank &rank = rank_of(lincs);
    const bool perturbed = parameters.efep != FreeEnergyPerturbationType::No;
    const bool positions = what == ConstraintVariable::Positions;
    if (perturbed && positions) {
        if (masses_change && rank.molecules.mass_lambda() != lambda) rank.molecules.set_masses(inverse_masses, lambda);
        rank.molecules.set_lambda(lambda);
    }

    double sum[9] = {}, by_lambda = 0;
    const holonomic::Call call{step,
                               parameters,
                               pbc,
                               reinterpret_cast<const real *>(x.data()),
                               reinterpret_cast<real *>(q.data()),
                               positions && !v.empty() ? reinterpret_cast<real *>(v.data()) : nullptr,
                               inverse_dt,
                               wants_virial ? sum : nullptr,
                               perturbed && dvdlambda ? &by_lambda : nullptr,
                               max_warnings,
                               n_warnings};
    bool solved = true;
    if (positions)
        solved = rank.positions(call, wants_rmsd);
    else
        rank.derivatives(call, reinterpret_cast<real *>(projected.data()), what);

    if (wants_virial)
        for (int i = 0; i < 9; i++) virial[i / 3][i % 3] -= static_cast<real>(sum[i]);
    if (call.dvdlambda) {
        if (positions) by_lambda /= parameters.delta_t * parameters.delta_t;
        *dvdlambda += static_cast<real>(by_lambda);
    }
    return solved;
}

}  // namespace gmx

// Called where the atoms of a domain are handed to constraints: the way to know the domain, of which nothing else is
// told.
int dd_numHomeAtoms(const gmx_domdec_t &domain) {
    static const auto original = holonomic::original(&dd_numHomeAtoms);
    holonomic::domain = &domain;
    return holonomic::n_home = original(domain);
}
