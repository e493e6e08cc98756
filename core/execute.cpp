#include "execute.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace holonomic {

namespace {

// Below this a second thread costs more than it saves.
constexpr std::int64_t bonds_per_thread = 4096;

struct ThreadMemory {
    double *data = nullptr;
    std::int64_t bytes = 0;
    ~ThreadMemory() { std::free(data); }
};

thread_local ThreadMemory memory;
thread_local std::vector<Tally> tallies;

}  // namespace

Tally empty_tally() {
    Tally tally{};
    tally.first_bad = tally.worst_chain = tally.worst_bond = -1;
    return tally;
}

void add(Tally &total, const Tally &piece) {
    for (int i = 0; i < 6; ++i) total.virial[i] += piece.virial[i];
    if (piece.n_bad > 0 && (total.n_bad == 0 || piece.first_bad < total.first_bad)) total.first_bad = piece.first_bad;
    total.n_bad += piece.n_bad;
    total.iterations = std::max(total.iterations, piece.iterations);
    total.n_corrected += piece.n_corrected;
    if (piece.worst_chain >= 0 && (total.worst_chain < 0 || piece.worst > total.worst ||
                                   (piece.worst == total.worst && piece.worst_chain < total.worst_chain))) {
        total.worst = piece.worst;
        total.worst_chain = piece.worst_chain;
        total.worst_bond = piece.worst_bond;
    }
}

double *thread_scratch(std::int64_t bytes) {
    if (bytes <= memory.bytes) return memory.data;
    std::free(memory.data);
    memory.bytes = 0;
    const std::size_t rounded = static_cast<std::size_t>((bytes + 63) / 64 * 64);
    memory.data = static_cast<double *>(std::aligned_alloc(64, rounded));
    if (memory.data) memory.bytes = static_cast<std::int64_t>(rounded);
    return memory.data;
}

Tally execute(const Chains &chains, const Work &work) {
    const Plan &plan = chains.plan();
    const std::int64_t n_pieces = static_cast<std::int64_t>(plan.pieces.size());
    const std::int64_t bytes = kernels().scratch_bytes(plan.longest_in_lane);
    Tally total = empty_tally();
    const std::int64_t worthwhile = std::min(n_pieces, plan.n_bonds / bonds_per_thread);
    const int n_threads = static_cast<int>(std::min<std::int64_t>(chains.n_threads, worthwhile));
#ifdef _OPENMP
    if (n_threads > 1) {
        if (static_cast<std::int64_t>(tallies.size()) < n_pieces) tallies.resize(static_cast<std::size_t>(n_pieces));
        Tally *const piece_tallies = tallies.data();
        bool out_of_memory = false;
#pragma omp parallel num_threads(n_threads)
        {
            double *const scratch = thread_scratch(bytes);
            if (!scratch) {
#pragma omp atomic write
                out_of_memory = true;
            }
#pragma omp barrier
            bool stop;
#pragma omp atomic read
            stop = out_of_memory;
            if (!stop) {
#pragma omp for schedule(dynamic, 4)
                for (std::int64_t p = 0; p < n_pieces; ++p) {
                    Lane lanes[loose_piece];
                    Tally tally = empty_tally();
                    work(chains.unit(plan, p, lanes), scratch, tally);
                    piece_tallies[p] = tally;
                }
            }
        }
        if (out_of_memory) throw std::bad_alloc();
        for (std::int64_t p = 0; p < n_pieces; ++p) add(total, piece_tallies[p]);
        return total;
    }
#endif
    static_cast<void>(n_threads);
    double *const scratch = thread_scratch(bytes);
    if (!scratch) throw std::bad_alloc();
    Lane lanes[loose_piece];
    for (std::int64_t p = 0; p < n_pieces; ++p) {
        Tally tally = empty_tally();
        work(chains.unit(plan, p, lanes), scratch, tally);
        add(total, tally);
    }
    return total;
}

}  // namespace holonomic
