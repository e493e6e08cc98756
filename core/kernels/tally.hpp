// Sums of a call. Internal linkage: the kernels of every instruction set have them, too.
#pragma once

#include "core/kernels/call.hpp"

namespace holonomic {

static inline Tally empty_tally() {
    Tally tally;  // one by one: gcc sets more than 96 bytes to zero by instructions that take 30 cycles to begin
    double *const sum = tally.virial;
    sum[0] = sum[1] = sum[2] = sum[3] = sum[4] = sum[5] = tally.worst = tally.log_det = tally.log_det_z = 0;
    tally.n_bad = tally.iterations = tally.n_corrected = 0;
    tally.first_bad = tally.worst_chain = tally.worst_bond = -1;
    tally.bad = nullptr;
    return tally;
}

// Whether a bond of a molecule is worse than the worst so far; of equal ones that of the first molecule counts.
static inline bool is_worse(const Tally &tally, double error, int64_t molecule) {
    return tally.worst_chain < 0 || error > tally.worst || (error == tally.worst && molecule < tally.worst_chain);
}

// Whether it is, and then it takes the place.
static inline bool take_worst(Tally &tally, double error, int64_t molecule) {
    if (!is_worse(tally, error, molecule)) return false;
    tally.worst = error;
    tally.worst_chain = molecule;
    return true;
}

// Counts molecules that were moved, and how many solves it took.
static inline void count_moved(Tally &tally, int n, int64_t solves) {
    tally.n_corrected += n;
    if (solves > tally.iterations) tally.iterations = solves;
}

static inline void add(Tally &total, const Tally &part) {
    for (int i = 0; i < 6; ++i) total.virial[i] += part.virial[i];
    if (part.n_bad > 0 && (total.n_bad == 0 || part.first_bad < total.first_bad)) total.first_bad = part.first_bad;
    total.n_bad += part.n_bad;
    total.log_det += part.log_det;
    total.log_det_z += part.log_det_z;
    if (part.iterations > total.iterations) total.iterations = part.iterations;
    total.n_corrected += part.n_corrected;
    if (part.worst_chain >= 0 && take_worst(total, part.worst, part.worst_chain)) total.worst_bond = part.worst_bond;
}

// Counts a molecule, by its number, as bad.
static inline void note_bad(int64_t molecule, Tally &tally) {
    if (tally.bad && tally.n_bad < most_listed) tally.bad[tally.n_bad] = molecule;
    if (tally.n_bad++ == 0 || molecule < tally.first_bad) tally.first_bad = molecule;
}

}  // namespace holonomic
