#include "core/run/execute.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>

#include "core/error.hpp"
#include "core/molecules/planned/way.hpp"
#include "core/plan/tree_batch.hpp"
#include "core/run/lane.hpp"
#include "core/run/outcomes.hpp"
#include "core/run/thread_memory.hpp"
#include "core/run/threads.hpp"

namespace holonomic {

namespace {

// Below this a second thread costs more than it saves.
constexpr std::int64_t bonds_per_thread = 4096;

double *scratch_memory(std::int64_t bytes) { return static_cast<double *>(thread_memory(Keep::scratch, bytes)); }
double *store_memory(std::int64_t bytes) { return static_cast<double *>(thread_memory(Keep::store, bytes)); }

Tally *tallies(Keep what, std::int64_t n) {
    void *const memory = thread_memory(what, n * static_cast<std::int64_t>(sizeof(Tally)));
    if (!memory) throw std::bad_alloc();
    return static_cast<Tally *>(memory);
}

// Calls body(j, scratch) for j = 0 .. n-1 on the threads of a team. Each has a share of its own, the same in every
// call, so that it finds in its cache what it worked on before, and takes over what is left of the others' when it is
// done: one that has to wait for a processor keeps nobody waiting but for what it has begun. A thread that gets no
// memory leaves its share to the others; the calling thread has its memory already.
template <class Body>
void share(int n_threads, std::int64_t scratch_bytes, std::int64_t store_bytes, std::int64_t n, Team::Direction order,
           const Body &body) {
    struct alignas(64) Share {
        std::atomic<std::int64_t> next;
        std::int64_t first, end;
    };
    constexpr int most = 64;
    Share shares[most];
    const int n_shares = std::min(n_threads, most);
    for (int i = 0; i < n_shares; ++i) {
        shares[i].first = n * i / n_shares;
        shares[i].end = n * (i + 1) / n_shares;
        shares[i].next.store(shares[i].first, std::memory_order_relaxed);
    }
    on_threads(n_threads, [&](int thread) {
        double *const scratch = scratch_memory(scratch_bytes);
        const int own = static_cast<int>(static_cast<std::int64_t>(thread) * n_shares / n_threads);
        for (int i = 0; scratch && (store_bytes == 0 || store_memory(store_bytes)) && i < n_shares; ++i) {
            Share &of = shares[(own + i) % n_shares];
            for (std::int64_t j; (j = of.next.fetch_add(1, std::memory_order_relaxed)) < of.end;)
                body(order == Team::forwards ? j : of.first + of.end - 1 - j, scratch);
        }
    });
}

// A single molecule whose tiles are shared among the threads: a large one, or one of few, so that not every thread has
// molecules of its own, or that is more than a thread's part of all bonds.
bool is_shared_molecule(const Plan &plan, std::int64_t p, int n_threads, bool paths) {
    const Plan::Chunk &chunk = plan.chunks[static_cast<std::size_t>(p)];
    if (chunk.shape == linear || chunk.count != 1) return false;
    const EliminationPlan &s = *plan.elimination_plans[static_cast<std::size_t>(chunk.shape)];
    const std::int64_t n = s.n_tiles, n_molecules = static_cast<std::int64_t>(plan.chunks.size());
    const bool large = n_molecules < n_threads || static_cast<std::int64_t>(s.n_bonds) * n_threads > plan.n_bonds;
    if (large && has_shares(s, paths)) return true;
    return n > 1 && (n >= 8 * n_threads || n_molecules < 4 * n_threads);
}

// Bonds of a chain that is worked on in segments, 0 if the chunk is none.
std::int64_t long_chain_bonds(const Chains &chains, const Plan &plan, std::int64_t p) {
    const Plan::Chunk &chunk = plan.chunks[static_cast<std::size_t>(p)];
    if (chunk.shape != linear) return 0;
    const std::int64_t n = chains.chunk_bonds(chunk);
    return n > longest_lane ? n : 0;
}

// Different trees side by side, for a verb that has no way for batches of trees: those of each shape, which the plan
// has one after the other.
[[gnu::noinline]] void work_on_each_shape(const Work &work, const MoleculeUnit &unit, int where, double *scratch,
                                          Tally &tally) {
    MoleculeUnit alike{nullptr, unit.lanes, 0, false, unit.large};
    const auto work_on_alike = [&] {
        if (alike.count > 0) work.unit(alike, where, scratch, tally);
        alike.lanes += alike.count;
        alike.count = 0;
    };
    for (std::int64_t i = 0; i < unit.n_batches; ++i)
        for (int l = 0; l < unit.tree_batches[i].n_trees; ++l, ++alike.count) {
            const EliminationPlan *const shape = unit.tree_batches[i].elimination[l];
            if (shape != alike.elimination) work_on_alike();
            alike.elimination = shape;
        }
    work_on_alike();
}
inline void work_on_molecules(const Work &work, const MoleculeUnit &unit, int where, double *scratch, Tally &tally) {
    if (!unit.tree_batches || work.walks_batches()) return work.unit(unit, where, scratch, tally);
    work_on_each_shape(work, unit, where, scratch, tally);
}

Unit one_of(const Unit &unit, std::int64_t i, Lane *lane) {
    *lane = lane_of(unit, i);
    return {lane, 1, unit.regular, unit.large};
}
MoleculeUnit one_of(const MoleculeUnit &unit, std::int64_t i, MoleculeLane *lane) {
    *lane = lane_of(unit, i);
    MoleculeUnit one{unit.elimination, lane, 1, true, unit.large};
    if (unit.tree_batches && unit.count == 1) one = unit;
    for (std::int64_t f = 0, first = 0; unit.tree_batches && unit.count > 1 && f < unit.n_batches; ++f) {
        if (i >= first && i < first + unit.tree_batches[f].n_trees)
            one.elimination = unit.tree_batches[f].elimination[i - first];
        first += unit.tree_batches[f].n_trees;
    }
    return one;
}
std::int64_t number_of(const Lane &lane) { return lane.chain; }
std::int64_t number_of(const MoleculeLane &lane) { return lane.molecule; }

// Does the molecules of a unit in ordinary units, one by one. `which`(number): those that are to be done.
template <class AnyUnit, class Which>
void work_on_rescaled(const Work &work, const AnyUnit &unit, int where, double *scratch, Tally &tally,
                      const Which &which) {
    for (std::int64_t i = 0; i < unit.count; ++i) {
        LaneOf<AnyUnit> lane;
        const AnyUnit one = one_of(unit, i, &lane);
        if (which(number_of(lane)) && !work.again(one, where, scratch, tally)) note_bad(number_of(lane), tally);
    }
}

template <class AnyUnit>
void do_bad_ones_again(const Work &work, const AnyUnit &unit, int where, double *scratch, Tally &tally) {
    const std::int64_t n = tally.n_bad, *const bad = tally.bad;
    tally.bad = nullptr;
    if (!work.rescales() || (n > most_listed && n < unit.count)) return;
    tally.n_bad = 0;
    work_on_rescaled(work, unit, where, scratch, tally, [&](std::int64_t number) {
        return n == unit.count || std::find(bad, bad + n, number) != bad + n;
    });
}

// A unit as it is, or in ordinary units; do_it(tally) does the first. Inlined by force: all of a call on one molecule
// passes here.
template <class AnyUnit, class Do>
void with_a_list_of_bad_ones(const Work &work, const AnyUnit &unit, int where, double *scratch, Tally &tally,
                             const Do &do_it) {
    std::int64_t bad[most_listed];
    tally.bad = bad;
    do_it(tally);
    if (__builtin_expect(tally.n_bad > 0, 0)) do_bad_ones_again(work, unit, where, scratch, tally);
    tally.bad = nullptr;
}
template <class AnyUnit, class Do>
__attribute__((always_inline)) inline void in_its_units(const Work &work, const AnyUnit &unit, int where,
                                                        double *scratch, Tally &tally, const Do &do_it) {
    if (__builtin_expect((where & far_units) && work.rescales(), 0))
        return work_on_rescaled(work, unit, where, scratch, tally, [](std::int64_t) { return true; });
    if (__builtin_expect(tally.n_bad == 0, 1)) return with_a_list_of_bad_ones(work, unit, where, scratch, tally, do_it);
    Tally own = empty_tally();  // the bad ones so far are other molecules
    with_a_list_of_bad_ones(work, unit, where, scratch, own, do_it);
    add(tally, own);
}

// One call: what it needs, and its chunks one by one or shared.
class Execution {
public:
    Execution(const Chains &chains, const Plan &plan, const Work &work)
        : chains_(chains), plan_(plan), work_(work), outcomes_(chains.keeps_outcomes ? outcomes_under_way() : nullptr),
          n_chunks_(static_cast<std::int64_t>(plan.chunks.size())),
          scratch_bytes_(std::max(plan.scratch_bytes, work.scratch_bytes())) {
        n_threads_ = static_cast<int>(
            std::min<std::int64_t>(chains.n_threads, std::max<std::int64_t>(plan.n_bonds / bonds_per_thread, 1)));
        for (std::int64_t p = 0; plan.longest > longest_lane && p < n_chunks_; ++p) {
            const std::int64_t n = long_chain_bonds(chains, plan, p);
            if (n == 0) continue;
            std::int64_t &store = is_shared_chain(n) ? shared_store_ : own_store_;
            store = std::max(store, work.long_bytes(n));
        }
    }

    // Adds to `total`, which is empty.
    void run(Tally &total) const {
        double *const own_scratch = scratch_of_this_thread(scratch_bytes_);
        const std::int64_t store = std::max(own_store_, shared_store_);
        if (store > 0 && !store_memory(store)) throw std::bad_alloc();
        if (n_threads_ > 1) return run_on_threads(own_scratch, total);
        if (n_chunks_ == 1) return work_on(0, own_scratch, total, nullptr);
        for (std::int64_t p = 0; p < n_chunks_; ++p) {
            Tally tally = empty_tally();
            work_on(p, own_scratch, tally, nullptr);
            add(total, tally);
        }
    }

private:
    // Chains long enough to keep all threads busy are shared among them; of all others each is one thread's work.
    bool is_shared_chain(std::int64_t n_bonds) const {
        return n_threads_ > 1 && work_.long_blocks(n_bonds) >= 8 * n_threads_;
    }

    void work_on(std::int64_t p, double *scratch, Tally &tally, const LongTeam *team) const {
        const Plan::Chunk &chunk = plan_.chunks[static_cast<std::size_t>(p)];
        if (chunk.shape != linear) {
            MoleculeLane lane;
            MoleculeUnit unit = chains_.unit(plan_, chunk, &lane);
            unit.team = team;
            if (outcomes_) return work_on_each(unit, chunk.where, scratch, tally);
            return in_its_units(work_, unit, chunk.where, scratch, tally,
                                [&](Tally &own) { work_on_molecules(work_, unit, chunk.where, scratch, own); });
        }
        Lane lane;
        const Unit unit = chains_.unit(plan_, chunk, &lane);
        if (unit.lanes[0].n_bonds > longest_lane)
            work_on_long_chain(unit.lanes[0], chunk.where, Team(1, scratch_bytes_), store_memory(own_store_), tally);
        else if (outcomes_)
            work_on_each(unit, chunk.where, scratch, tally);
        else
            in_its_units(work_, unit, chunk.where, scratch, tally,
                         [&](Tally &own) { work_.unit(unit, chunk.where, scratch, own); });
    }

    void work_on_long_chain(const Lane &lane, int where, const Team &team, double *store, Tally &tally) const {
        with_outcome(outcome_of(lane.chain), tally, [&](Tally &own) {
            Tally once = empty_tally();
            if (!(where & far_units) || !work_.rescales()) {
                work_.long_chain(lane, where, team, store, once);
                if (once.n_bad == 0 || !work_.rescales()) return add(own, once);
            }
            if (!work_.again(lane, where, team, store, own)) note_bad(lane.chain, own);
        });
    }

    // The molecules of a unit one by one, so that each has a tally of its own: the same results, for lanes are
    // independent of each other, in more time.
    void work_on_each(const Unit &unit, int where, double *scratch, Tally &tally) const {
        for (std::int64_t i = 0; i < unit.count; ++i) {
            const Lane lane = unit.regular ? lane_of(unit, i) : unit.lanes[i];
            const Unit one{&lane, 1, unit.regular, unit.large};
            with_outcome(outcome_of(lane.chain), tally, [&](Tally &own) {
                in_its_units(work_, one, where, scratch, own,
                             [&](Tally &of_one) { work_.unit(one, where, scratch, of_one); });
            });
        }
    }
    void work_on_each(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const {
        const auto one = [&](const EliminationPlan *elimination, const MoleculeLane &lane, bool regular) {
            const MoleculeUnit alone{elimination, &lane, 1, regular, unit.large, unit.team};
            with_outcome(outcome_of(lane.molecule), tally, [&](Tally &own) {
                in_its_units(work_, alone, where, scratch, own,
                             [&](Tally &of_one) { work_.unit(alone, where, scratch, of_one); });
            });
        };
        if (unit.tree_batches && unit.count == 1)
            return with_outcome(outcome_of(unit.lanes->molecule), tally, [&](Tally &own) {
                in_its_units(work_, unit, where, scratch, own,
                             [&](Tally &of_one) { work_on_molecules(work_, unit, where, scratch, of_one); });
            });
        const MoleculeLane *lane = unit.lanes;
        for (std::int64_t i = 0; unit.tree_batches && i < unit.n_batches; ++i)
            for (int l = 0; l < unit.tree_batches[i].n_trees; ++l)
                one(unit.tree_batches[i].elimination[l], *lane++, true);
        for (std::int64_t i = 0; !unit.tree_batches && i < unit.count; ++i)
            one(unit.elimination, lane_of(unit, i), unit.regular);
    }

    OutcomeOf *outcome_of(std::int64_t molecule) const { return outcomes_ ? outcomes_ + molecule : nullptr; }

    bool is_shared(std::int64_t p) const {
        if (is_shared_molecule(plan_, p, n_threads_, work_.shares_paths())) return true;
        if (plan_.longest <= longest_lane) return false;
        const std::int64_t n = long_chain_bonds(chains_, plan_, p);
        return n > 0 && is_shared_chain(n);
    }

    // What is shared comes last, one chunk after the other.
    void run_on_threads(double *own_scratch, Tally &total) const {
        Tally *const parts = tallies(Keep::chunk_tallies, n_chunks_);
        share(n_threads_, scratch_bytes_, own_store_, n_chunks_, Team::forwards, [&](std::int64_t p, double *scratch) {
            Tally tally = empty_tally();
            if (!is_shared(p)) work_on(p, scratch, tally, nullptr);
            parts[p] = tally;
        });
        const Team team(n_threads_, scratch_bytes_);
        const LongTeam lent = team.lent();
        for (std::int64_t p = 0; p < n_chunks_; ++p) {
            if (!is_shared(p)) continue;
            const Plan::Chunk &chunk = plan_.chunks[static_cast<std::size_t>(p)];
            if (chunk.shape != linear) {
                parts[p] = empty_tally();
                work_on(p, own_scratch, parts[p], &lent);
                continue;
            }
            Lane lane;
            work_on_long_chain(chains_.unit(plan_, chunk, &lane).lanes[0], chunk.where, team,
                               store_memory(shared_store_), parts[p]);
        }
        for (std::int64_t p = 0; p < n_chunks_; ++p) add(total, parts[p]);
    }

    const Chains &chains_;
    const Plan &plan_;
    const Work &work_;
    OutcomeOf *const outcomes_;
    std::int64_t n_chunks_, scratch_bytes_;
    int n_threads_;
    std::int64_t own_store_ = 0, shared_store_ = 0;  // bytes kept between the phases of long chains
};

}  // namespace

void Team::run(std::int64_t n, Direction order, Tally &total,
               void (*call)(const void *, std::int64_t, double *, Tally &), const void *body) const {
    const auto at = [&](std::int64_t i) { return order == forwards ? i : n - 1 - i; };
    if (n_threads_ > 1) {
        Tally *const parts = tallies(Keep::block_tallies, n);
        share(n_threads_, scratch_bytes_, 0, n, order, [&](std::int64_t j, double *scratch) {
            Tally tally = empty_tally();
            call(body, j, scratch, tally);
            parts[j] = tally;
        });
        for (std::int64_t i = 0; i < n; ++i) add(total, parts[at(i)]);
        return;
    }
    for (std::int64_t i = 0; i < n; ++i) {
        Tally tally = empty_tally();
        call(body, at(i), scratch_memory(scratch_bytes_), tally);
        add(total, tally);
    }
}

void work_again(const Work &work, const Unit &unit, int where, double *scratch, Tally &tally) {
    do_bad_ones_again(work, unit, where, scratch, tally);
}

namespace {

template <int n>
void refuse_infinite_virial(const double *sum) {
    double zero = 0;
    for (int i = 0; i < n; ++i) zero += 0 * sum[i];
    if (__builtin_expect(zero == 0, 1)) return;
    Error error = make_error(Status::not_finite, "the virial overflows; choose other units");
    error.n_bad = 1;  // the rest of the call has been done
    throw error;
}

}  // namespace

void write_virial(const double *sum, double *virial) {
    refuse_infinite_virial<9>(sum);
    std::copy(sum, sum + 9, virial);
}

void write_virial(const Tally &tally, double *virial) {
    refuse_infinite_virial<6>(tally.virial);
    std::fill(virial, virial + 9, 0.0);
    add_virial(tally, virial);
}

void add_virial(const Tally &tally, double *virial) {
    constexpr int sum_of_element[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (int i = 0; i < 9; ++i) virial[i] += tally.virial[sum_of_element[i]];
}

void execute(const Chains &chains, const Plan &plan, const Work &work, Tally &tally) {
    Execution(chains, plan, work).run(tally);
}

}  // namespace holonomic
