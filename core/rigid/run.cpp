#include "core/rigid/run.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <new>

#include "core/run/outcomes.hpp"
#include "core/run/thread_memory.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

namespace holonomic::rigid {

namespace {

// Molecules whose sums are added together, whatever the number of threads; and rows that a thread is worth.
constexpr std::int64_t block = 64, rows_per_thread = 512;

void add(Found &total, const Found &part) {
    if (part.tally.n_bad > 0 && total.tally.n_bad == 0) total.first_outcome = part.first_outcome;
    holonomic::add(total.tally, part.tally);
}

// Why a molecule is bad, until its status is known.
std::int32_t noted(Outcome why) { return bad_outcome - static_cast<std::int32_t>(why); }
Outcome why(std::int32_t noted) { return static_cast<Outcome>(bad_outcome - noted); }

Found run_block(const Chains &chains, const Work &work, std::int64_t first, char *memory, OutcomeOf *outcomes) {
    const Bodies &bodies = *chains.bodies();
    Found found{empty_tally(), Outcome::good};
    const std::int64_t end = std::min(first + block, bodies.n_molecules());
    for (std::int64_t m = first; m < end; ++m) {
        if (!bodies.is_active(m)) continue;
        const System system(bodies.shape(m), bodies.kinds(), memory);
        const Place place{bodies.atoms(m), bodies.bonds(m), chains.n_chains() + m};
        Tally own = empty_tally();
        const Outcome outcome = work.molecule(system, place, outcomes ? own : found.tally);
        if (outcomes) {
            holonomic::add(found.tally, own);
            outcomes[place.number] = {outcome == Outcome::good ? 0 : noted(outcome),
                                      static_cast<std::int32_t>(own.iterations)};
        }
        if (outcome == Outcome::good) continue;
        if (found.tally.n_bad == 0) found.first_outcome = outcome;
        note_bad(place.number, found.tally);
    }
    return found;
}

}  // namespace

Found run(const Chains &chains, const Work &work) {
    const Bodies &bodies = *chains.bodies();
    const std::int64_t bytes = bodies.scratch_bytes(), n_blocks = (bodies.n_molecules() + block - 1) / block;
    char *const own = static_cast<char *>(thread_memory(Keep::rigid, bytes));
    Found *const parts =
        static_cast<Found *>(thread_memory(Keep::piece_tallies, n_blocks * static_cast<std::int64_t>(sizeof(Found))));
    if (!own || !parts) throw std::bad_alloc();
    OutcomeOf *const outcomes = outcomes_under_way();
    const int n_threads = static_cast<int>(std::min(std::min<std::int64_t>(chains.n_threads, n_blocks),
                                                    std::max<std::int64_t>(bodies.work() / rows_per_thread, 1)));
    if (n_threads <= 1 || work.is_in_order()) {
        for (std::int64_t j = 0; j < n_blocks; ++j) parts[j] = run_block(chains, work, j * block, own, outcomes);
    } else {
#ifdef _OPENMP
        std::atomic<std::int64_t> next{0};
        // A thread that gets no memory leaves its share to the others; the calling thread has its own.
#pragma omp parallel num_threads(n_threads)
        {
            char *const memory = static_cast<char *>(thread_memory(Keep::rigid, bytes));
            for (std::int64_t j; memory && (j = next.fetch_add(1)) < n_blocks;)
                parts[j] = run_block(chains, work, j * block, memory, outcomes);
        }
#else
        for (std::int64_t j = 0; j < n_blocks; ++j) parts[j] = run_block(chains, work, j * block, own, outcomes);
#endif
    }
    Found total{empty_tally(), Outcome::good};
    for (std::int64_t j = 0; j < n_blocks; ++j) add(total, parts[j]);
    return total;
}

Error error_of_values(const Chains &chains, std::int64_t molecule, const double *values, const char *what,
                      const Error &otherwise) {
    const Shape &s = chains.bodies()->shape(molecule);
    for (std::size_t k = 0; k < s.bonds.size(); ++k) {
        if (std::isfinite(values[chains.bodies()->bonds(molecule)[k]])) continue;
        Error error = make_error(Status::not_finite, "molecule %s: the %s of bond %lld is not finite",
                                 chains.name_of_rigid(otherwise.chain, chains.bodies()->atoms(molecule)[0]).text, what,
                                 static_cast<long long>(k) + chains.base);
        error.chain = otherwise.chain;
        error.bond = static_cast<std::int64_t>(k);
        error.n_bad = otherwise.n_bad;
        error.base = otherwise.base;
        return error;
    }
    return otherwise;
}

namespace {

Error error_of_first(const Chains &chains, const Found &found, const Named *arrays, int n_arrays) {
    const Bodies &bodies = *chains.bodies();
    const std::int64_t m = found.tally.first_bad - chains.n_chains();
    const Shape &shape = bodies.shape(m);
    const std::int64_t *const atoms = bodies.atoms(m);
    char name[160], others[80] = "";
    std::snprintf(name, sizeof name, "molecule %s", chains.name_of_rigid(found.tally.first_bad, atoms[0]).text);
    if (found.tally.n_bad > 1)
        std::snprintf(others, sizeof others, " (the first of %lld bad molecules)",
                      static_cast<long long>(found.tally.n_bad));
    const auto finish = [&](Error error, std::int64_t atom) {
        error.chain = found.tally.first_bad;
        error.atom = atom;
        error.n_bad = found.tally.n_bad;
        error.base = chains.base;
        return error;
    };
    for (int a = 0; a < n_arrays; ++a) {
        if (!arrays[a].array->x) continue;
        for (std::int32_t i = 0; i < shape.n_atoms; ++i) {
            double x[3];
            read_atom(*arrays[a].array, atoms[i], x);
            if (std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2])) continue;
            return finish(make_error(Status::not_finite, "%s: the %s of atom %s is not finite%s", name, arrays[a].what,
                                     chains.name_of_atom(atoms[i]).text, others),
                          atoms[i]);
        }
    }
    switch (found.first_outcome) {
        case Outcome::degenerate:
            return finish(
                make_error(Status::degenerate,
                           "%s, with %d bodies, the first of atom %s: its constraints depend on each other at "
                           "these positions (a bond of length zero, a body that is collapsed, taut between "
                           "fixed atoms, or bonds that hold the same)%s",
                           name, static_cast<int>(shape.parts.size()), chains.name_of_atom(atoms[0]).text, others),
                -1);
        case Outcome::no_convergence:
            return finish(
                make_error(Status::no_convergence,
                           "%s, with %d bodies, the first of atom %s: no corrections along the reference bring "
                           "bodies and bonds back to their lengths; the step is too large, or a length can't "
                           "be reached%s",
                           name, static_cast<int>(shape.parts.size()), chains.name_of_atom(atoms[0]).text, others),
                -1);
        case Outcome::stretched:
            return finish(
                make_error(Status::lengths,
                           "%s, with %d bodies, the first of atom %s: a bond or a body is more than 5 times as "
                           "long as it should be in the positions to be projected; the molecule was left as "
                           "it is (hol_chains_set_checks)%s",
                           name, static_cast<int>(shape.parts.size()), chains.name_of_atom(atoms[0]).text, others),
                -1);
        default:
            return finish(make_error(Status::not_finite, "%s: the numbers overflow or underflow; choose other units%s",
                                     name, others),
                          -1);
    }
}

}  // namespace

Error error_of(const Chains &chains, const Found &found, const Named *arrays, int n_arrays) {
    OutcomeOf *const outcomes = outcomes_under_way();
    for (std::int64_t m = chains.n_chains(); outcomes && m < chains.n_molecules(); ++m) {
        if (outcomes[m].status >= 0) continue;
        Found alone{found.tally, why(outcomes[m].status)};
        alone.tally.first_bad = m;
        outcomes[m].status = static_cast<std::int32_t>(error_of_first(chains, alone, arrays, n_arrays).status);
    }
    return error_of_first(chains, found, arrays, n_arrays);
}

}  // namespace holonomic::rigid
