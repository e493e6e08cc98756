// The entries of the table of kernels: what the verbs of one instruction set define, and what core/kernels/call.hpp
// says of them.
#pragma once

#include "core/kernels/call.hpp"
#include "core/kernels/isa/target.hpp"

namespace holonomic::HOL_ISA {

void forces(const ForcesCall &, const Unit &, double *scratch, Tally &);
void long_forces_eliminate(const ForcesCall &, const Lane &, int64_t block, bool extended, double *store,
                           double *scratch);
void long_forces_finish(const ForcesCall &, const Lane &, int64_t block, double *store, double *scratch, Tally &);

JoinResult long_join(const Lane &, int64_t blocks, bool extended, double *store);

void velocities(const VelocitiesCall &, const Unit &, double *scratch, Tally &);
void long_velocities_eliminate(const VelocitiesCall &, const Lane &, int64_t block, bool extended, double *store,
                               double *scratch);
void long_velocities_finish(const VelocitiesCall &, const Lane &, int64_t block, double *store, double *scratch,
                            Tally &);

void positions(const PositionsCall &, const Unit &, double *scratch, Tally &);
int64_t long_positions_bytes(int64_t n_bonds);
bool long_positions(const PositionsCall &, const Lane &, const LongTeam &, double *store, Tally &);

void metric(const MetricCall &, const Unit &, double *scratch, Tally &);
int64_t long_metric_bytes(int64_t n_bonds);
bool long_metric(const MetricCall &, const Lane &, const LongTeam &, double *store, Tally &);
int64_t metric_bytes(const EliminationPlan &);
void molecules_metric(const MetricCall &, const MoleculeUnit &, double *scratch, Tally &);

int64_t molecules_scratch_bytes(const EliminationPlan &);
int64_t batch_scratch_bytes(const TreeBatch &);
void batches_forces(const ForcesCall &, const MoleculeUnit &, double *scratch, Tally &);
void batches_solve(const SolveCall &, const MoleculeUnit &, double *scratch, Tally &);
void batches_positions(const PositionsCall &, const MoleculeUnit &, double *scratch, Tally &);
void batches_velocities(const VelocitiesCall &, const MoleculeUnit &, double *scratch, Tally &);
void molecules_forces(const ForcesCall &, const MoleculeUnit &, double *scratch, Tally &);
void molecules_velocities(const VelocitiesCall &, const MoleculeUnit &, double *scratch, Tally &);
void molecules_positions(const PositionsCall &, const MoleculeUnit &, double *scratch, Tally &);
int64_t path_positions_bytes(const EliminationPlan &);
bool path_positions(const PositionsCall &, const EliminationPlan &, const MoleculeLane &, const LongTeam *,
                    double *scratch, Tally &);
void molecules_solve(const SolveCall &, const MoleculeUnit &, double *scratch, Tally &);

void keep_chains(const KeepCall &, const Unit &, double *scratch, Tally &);
void solve_kept_chains(const KeptCall &, const Unit &, double *scratch, Tally &);
bool is_kept(const EliminationPlan &);
int64_t kept_scratch_bytes(const EliminationPlan &);
void keep_molecules(const KeepCall &, const MoleculeUnit &, double *scratch, Tally &);
void solve_kept_molecules(const KeptCall *, int n_calls, const MoleculeUnit &, double *scratch, Tally &);

int64_t bodies_scratch_bytes(int64_t n_atoms);
uint64_t bodies_forces(const ForcesCall &, const BodyUnit &, double *scratch, BodyResult *);
uint64_t bodies_velocities(const VelocitiesCall &, const BodyUnit &, double *scratch, BodyResult *);
uint64_t bodies_positions(const PositionsCall &, const BodyUnit &, double *scratch, BodyResult *);

bool tridiagonal_solve(int64_t n, const double *gamma, const double *b, double *x, double *scratch);
bool tridiagonal_pivots(int64_t n, const double *gamma, double *pivots);

}  // namespace holonomic::HOL_ISA
