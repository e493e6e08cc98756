#include "core/run/execute.hpp"

#include <algorithm>
#include <new>

#include "core/run/thread_memory.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

namespace holonomic {

namespace {

// Below this a second thread costs more than it saves.
constexpr std::int64_t bonds_per_thread = 4096;

double *scratch_memory(std::int64_t bytes) { return static_cast<double *>(thread_memory(Keep::scratch, bytes)); }
double *store_memory(std::int64_t bytes) { return static_cast<double *>(thread_memory(Keep::store, bytes)); }

double *scratch_of_this_thread(std::int64_t bytes) {
    double *const scratch = scratch_memory(bytes);
    if (!scratch) throw std::bad_alloc();
    return scratch;
}

#ifdef _OPENMP
Tally *tallies(Keep what, std::int64_t n) {
    void *const memory = thread_memory(what, n * static_cast<std::int64_t>(sizeof(Tally)));
    if (!memory) throw std::bad_alloc();
    return static_cast<Tally *>(memory);
}

// Gives every thread of a team its memory, so that nothing can fail later.
void reserve(int n_threads, std::int64_t scratch_bytes, std::int64_t store_bytes) {
    bool failed = false;
#pragma omp parallel num_threads(n_threads)
    if (!scratch_memory(scratch_bytes) || (store_bytes > 0 && !store_memory(store_bytes))) {
#pragma omp atomic write
        failed = true;
    }
    if (failed) throw std::bad_alloc();
}
#endif

// Bonds of a chain that is worked on in segments, 0 if the piece is none.
std::int64_t long_chain_bonds(const Chains &chains, const Plan &plan, std::int64_t p) {
    const Plan::Piece &piece = plan.pieces[static_cast<std::size_t>(p)];
    if (piece.shape != linear) return 0;
    const std::int64_t n = chains.piece_bonds(piece);
    return n > longest_lane ? n : 0;
}

// Molecules whose cycles do not close are bad; the others are worked on.
void work_on_molecules(const Work &work, const MoleculeUnit &unit, int where, double *scratch, Tally &tally) {
    Images images[2];
    const int n = work.images(where, images);
    const auto is_closed = [&](const MoleculeLane &lane) {
        for (int i = 0; i < n; ++i)
            if (may_stay_open(*unit.schedule, images[i]) && !closes(*unit.schedule, lane, images[i], scratch))
                return false;
        return true;
    };
    bool all = true;
    for (int i = 0; i < n; ++i)
        if (may_stay_open(*unit.schedule, images[i]))
            for (std::int64_t j = 0; all && j < unit.count; ++j)
                all = closes(*unit.schedule, lane_of(unit, j), images[i], scratch);
    if (all) return work.unit(unit, where, scratch, tally);
    MoleculeLane lanes[loose_piece];
    MoleculeUnit closed{unit.schedule, lanes, 0, false, unit.large};
    for (std::int64_t j = 0; j < unit.count; ++j) {
        const MoleculeLane lane = lane_of(unit, j);
        if (is_closed(lane))
            lanes[closed.count++] = lane;
        else if (tally.n_bad++ == 0 || lane.molecule < tally.first_bad)
            tally.first_bad = lane.molecule;
        if (closed.count == loose_piece || (j + 1 == unit.count && closed.count > 0)) {
            work.unit(closed, where, scratch, tally);
            closed.count = 0;
        }
    }
}

}  // namespace

void Team::run(std::int64_t n, Tally &total, void (*call)(const void *, std::int64_t, double *, Tally &),
               const void *body) const {
#ifdef _OPENMP
    if (n_threads_ > 1) {
        Tally *const parts = tallies(Keep::block_tallies, n);
#pragma omp parallel for schedule(static) num_threads(n_threads_)
        for (std::int64_t j = 0; j < n; ++j) {
            Tally tally = empty_tally();
            call(body, j, scratch_memory(scratch_bytes_), tally);
            parts[j] = tally;
        }
        for (std::int64_t j = 0; j < n; ++j) add(total, parts[j]);
        return;
    }
#else
    static_cast<void>(n_threads_);
#endif
    for (std::int64_t j = 0; j < n; ++j) {
        Tally tally = empty_tally();
        call(body, j, scratch_memory(scratch_bytes_), tally);
        add(total, tally);
    }
}

void write_virial(const Tally &tally, double *virial) {
    const int place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (int i = 0; i < 9; ++i) virial[i] = tally.virial[place[i]];
}

Tally execute(const Chains &chains, const Work &work) { return execute(chains, chains.plan(), work); }

Tally execute(const Chains &chains, const Plan &plan, const Work &work) {
    const std::int64_t n_pieces = static_cast<std::int64_t>(plan.pieces.size());
    std::int64_t scratch_bytes = holonomic::scratch_bytes(plan.longest);
    for (const std::int32_t shape : plan.shapes)
        scratch_bytes = std::max(scratch_bytes,
                                 kernels().molecules.scratch_bytes(*plan.schedules[static_cast<std::size_t>(shape)]));
    const int n_threads = static_cast<int>(
        std::min<std::int64_t>(chains.n_threads, std::max<std::int64_t>(plan.n_bonds / bonds_per_thread, 1)));

    // A chain long enough to keep all threads busy is shared among them; of all others each is one thread's work.
    const std::int64_t shared_blocks = 8 * n_threads;
    std::int64_t own_store = 0, shared_store = 0;
    bool any_shared = false;
    if (plan.longest > longest_lane)
        for (std::int64_t p = 0; p < n_pieces; ++p) {
            const std::int64_t n = long_chain_bonds(chains, plan, p);
            if (n == 0) continue;
            const bool shared = n_threads > 1 && work.long_blocks(n) >= shared_blocks;
            any_shared = any_shared || shared;
            (shared ? shared_store : own_store) = std::max(shared ? shared_store : own_store, work.long_bytes(n));
        }
    double *const own_scratch = scratch_of_this_thread(scratch_bytes);
    if (std::max(own_store, shared_store) > 0 && !store_memory(std::max(own_store, shared_store)))
        throw std::bad_alloc();

    const Team alone(1, scratch_bytes);
    const auto work_on = [&](std::int64_t p, double *scratch, Tally &tally) {
        const Plan::Piece &piece = plan.pieces[static_cast<std::size_t>(p)];
        if (piece.shape != linear) {
            MoleculeLane lanes[loose_piece];
            return work_on_molecules(work, chains.unit(plan, piece, lanes), piece.where, scratch, tally);
        }
        Lane lanes[loose_piece];
        const Unit unit = chains.unit(plan, piece, lanes);
        if (unit.lanes[0].n_bonds <= longest_lane)
            work.unit(unit, piece.where, scratch, tally);
        else
            work.long_chain(unit.lanes[0], piece.where, alone, store_memory(own_store), tally);
    };
    Tally total = empty_tally();
#ifdef _OPENMP
    if (n_threads > 1) {
        reserve(n_threads, scratch_bytes, own_store);
        Tally *const parts = tallies(Keep::piece_tallies, n_pieces);
        const auto is_shared = [&](std::int64_t p) {
            if (!any_shared) return false;
            const std::int64_t n = long_chain_bonds(chains, plan, p);
            return n > 0 && work.long_blocks(n) >= shared_blocks;
        };
#pragma omp parallel for schedule(dynamic) num_threads(n_threads)
        for (std::int64_t p = 0; p < n_pieces; ++p) {
            Tally tally = empty_tally();
            if (!is_shared(p)) work_on(p, scratch_memory(scratch_bytes), tally);
            parts[p] = tally;
        }
        const Team team(n_threads, scratch_bytes);
        for (std::int64_t p = 0; any_shared && p < n_pieces; ++p) {
            if (!is_shared(p)) continue;
            const Plan::Piece &piece = plan.pieces[static_cast<std::size_t>(p)];
            Lane lanes[loose_piece];
            work.long_chain(chains.unit(plan, piece, lanes).lanes[0], piece.where, team, store_memory(shared_store),
                            parts[p]);
        }
        for (std::int64_t p = 0; p < n_pieces; ++p) add(total, parts[p]);
        return total;
    }
#endif
    if (n_pieces == 1) {
        work_on(0, own_scratch, total);
        return total;
    }
    for (std::int64_t p = 0; p < n_pieces; ++p) {
        Tally tally = empty_tally();
        work_on(p, own_scratch, tally);
        add(total, tally);
    }
    return total;
}

}  // namespace holonomic
