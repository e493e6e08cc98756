#include "core/rigid/run.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <new>

#include "core/kernel_choice.hpp"
#include "core/rigid/blocks.hpp"
#include "core/rigid/parts.hpp"
#include "core/run/bond_words.hpp"
#include "core/run/execute.hpp"
#include "core/run/outcomes.hpp"
#include "core/run/thread_memory.hpp"
#include "core/run/threads.hpp"

namespace holonomic::rigid {

namespace {

// Molecules whose sums are added together, whatever the number of threads; and rows that a thread is worth.
constexpr std::int64_t chunk_size = 64, rows_per_thread = 512;
// Positions, velocities, forces and results of so many atoms fill a second-level cache.
constexpr std::int64_t atoms_in_cache = 16384;

void add(RunResult &total, const RunResult &part) {
    if (part.tally.n_bad > 0 && total.tally.n_bad == 0) total.first_outcome = part.first_outcome;
    holonomic::add(total.tally, part.tally);
}

// Why a molecule is bad, until its status is known.
std::int32_t noted(Outcome why) { return bad_outcome - static_cast<std::int32_t>(why); }
Outcome why(std::int32_t noted) { return static_cast<Outcome>(bad_outcome - noted); }

class MoleculeChunk {
public:
    MoleculeChunk(const Chains &chains, const BodyWork &work, char *memory, OutcomeOf *outcomes)
        : chains_(chains), bodies_(*chains.bodies()), work_(work), memory_(memory), outcomes_(outcomes) {}

    RunResult run(std::int64_t first) {
        found_ = {empty_tally(), Outcome::good};
        const std::int64_t end = std::min(first + chunk_size, bodies_.n_molecules());
        for (std::int64_t m = first; m < end; ++m) {
            if (!bodies_.is_active(m)) continue;
            const MoleculeKind &kind = bodies_.kind(m);
            if (!kind.is_lone_body || !work_.takes_blocks(!kind.bonds.empty())) {
                molecule(m);
                continue;
            }
            m = side_by_side(m, end) - 1;
        }
        return found_;
    }

private:
    MoleculeView view(std::int64_t m) const {
        return {bodies_.atoms(m), bodies_.bonds(m), chains_.n_chains() + m, chains_.images()};
    }

    OutcomeOf *outcome_of(std::int64_t m) const { return outcomes_ ? outcomes_ + chains_.n_chains() + m : nullptr; }

    void molecule(std::int64_t m) {
        const System system(bodies_.kind(m), bodies_.body_kinds(), memory_);
        Outcome outcome = Outcome::good;
        with_outcome(outcome_of(m), found_.tally, [&](Tally &tally) {
            outcome = bodies_.kind(m).is_ordinary ? work_.molecule(system, view(m), tally) : Outcome::not_finite;
            if (outcome == Outcome::good) return;
            if (tally.n_bad == 0) found_.first_outcome = outcome;
            note_bad(chains_.n_chains() + m, tally);
        });
        if (outcomes_ && outcome != Outcome::good) outcome_of(m)->status = noted(outcome);
    }

    // Bodies from number `first` on as long as they are alike; returns the first one that is not.
    std::int64_t side_by_side(std::int64_t first, std::int64_t end) {
        static_assert(chunk_size <= most_in_unit && most_in_unit % most_lanes == 0);
        const std::int32_t number = bodies_.kind_number(first);
        if (kind_ != number) {
            kind_ = number;
            const MoleculeKind &kind = bodies_.kind(first);
            body_kind_ = kind_of(bodies_.body(kind.parts[0]), kind);
        }
        BodyUnit unit;
        unit.kind = &body_kind_;
        std::int64_t molecules[chunk_size], next = first;
        int count = 0;
        bool consecutive = true;
        const bool all_active = bodies_.all_active();
        for (; next < end && bodies_.kind_number(next) == number; ++next) {
            if (!all_active && !bodies_.is_active(next)) continue;
            molecules[count] = next;
            unit.atoms[count] = bodies_.atoms(next);
            unit.first[count] = 3 * unit.atoms[count][0];
            ++count;
            consecutive &= bodies_.is_consecutive(next);
        }
        unit.count = count;
        unit.consecutive = consecutive;
        unit.large = consecutive && chains_.n_atoms() > atoms_in_cache;
        for (; count % most_lanes != 0; ++count) {
            unit.atoms[count] = unit.atoms[0];
            unit.first[count] = unit.first[0];
        }
        BodyResult results[chunk_size];
        const std::uint64_t done =
            work_.bodies(unit, reinterpret_cast<double *>(memory_ + bodies_.scratch_bytes()), results);
        const std::uint64_t all = unit.count < chunk_size ? (std::uint64_t{1} << unit.count) - 1 : ~std::uint64_t{0};
        if (done == all && !work_.has_results() && !outcomes_) return next;
        for (int l = 0; l < unit.count; ++l) {
            if (!(done >> l & 1)) {
                molecule(molecules[l]);
                continue;
            }
            with_outcome(outcome_of(molecules[l]), found_.tally, [&](Tally &tally) {
                if (work_.has_results()) work_.done(results[l], chains_.n_chains() + molecules[l], tally);
            });
        }
        return next;
    }

    const Chains &chains_;
    const Bodies &bodies_;
    const BodyWork &work_;
    char *const memory_;
    OutcomeOf *const outcomes_;
    RunResult found_;
    BodyKind body_kind_;
    std::int32_t kind_ = -1;
};

}  // namespace

namespace {

struct RunMemory {
    std::int64_t bytes, n_blocks;
    char *scratch;
    RunResult *parts;
};

RunMemory memory_of(const Chains &chains, std::int64_t least = 0) {
    const Bodies &bodies = *chains.bodies();
    RunMemory m;
    m.bytes = std::max(bodies.scratch_bytes() + bodies.block_bytes(), least);
    m.n_blocks = (bodies.n_molecules() + chunk_size - 1) / chunk_size;
    m.scratch = static_cast<char *>(thread_memory(Keep::rigid, m.bytes));
    m.parts = static_cast<RunResult *>(
        thread_memory(Keep::chunk_tallies, m.n_blocks * static_cast<std::int64_t>(sizeof(RunResult))));
    if (!m.scratch || !m.parts) throw std::bad_alloc();
    return m;
}

}  // namespace

template <class Each>
void Parts::for_each_fixed(const Each &each) const {
    const Bodies &bodies = *chains_.bodies();
    for (std::int64_t m = 0; !bodies.fixed_atoms().empty() && m < bodies.n_molecules(); ++m) {
        if (!bodies.is_active(m)) continue;
        const MoleculeKind &s = bodies.kind(m);
        for (std::int32_t i = s.n_movable; i < s.n_atoms; ++i) each(bodies.atoms(m)[i]);
    }
}

Parts::Parts(const Chains &chains) : chains_(chains) {
    std::int64_t n = 0;
    for_each_fixed([&](std::int64_t) { ++n; });
    before_ = reinterpret_cast<double *>(memory_of(chains, 3 * n * static_cast<std::int64_t>(sizeof(double))).scratch);
}

void Parts::clear_fixed(const AtomArray &g) {
    const double none[3] = {0, 0, 0};
    double *next = before_;
    for_each_fixed([&](std::int64_t atom) { read_atom(g, atom, next), next += 3; });
    for_each_fixed([&](std::int64_t atom) { write_atom(g, atom, none); });
    cleared_ = g;
}

Parts::~Parts() {
    if (!cleared_.x || ended_) return;
    const double *next = before_;
    for_each_fixed([&](std::int64_t atom) { write_atom(cleared_, atom, next), next += 3; });
}

RunResult run(const Chains &chains, const BodyWork &work) {
    const Bodies &bodies = *chains.bodies();
    const RunMemory all = memory_of(chains);
    const std::int64_t n_blocks = all.n_blocks;
    char *const own = all.scratch;
    RunResult *const parts = all.parts;
    OutcomeOf *const outcomes = outcomes_under_way();
    const int n_threads = static_cast<int>(std::min(std::min<std::int64_t>(chains.n_threads, n_blocks),
                                                    std::max<std::int64_t>(bodies.work() / rows_per_thread, 1)));
    const auto run_all = [&] {
        MoleculeChunk one(chains, work, own, outcomes);
        for (std::int64_t j = 0; j < n_blocks; ++j) parts[j] = one.run(j * chunk_size);
    };
    if (n_threads <= 1 || work.is_in_order) {
        run_all();
    } else {
        std::atomic<std::int64_t> next{0};
        // A thread that gets no memory leaves its share to the others; the calling thread has its own.
        on_threads(n_threads, [&](int) {
            char *const memory = static_cast<char *>(thread_memory(Keep::rigid, all.bytes));
            MoleculeChunk one(chains, work, memory, outcomes);
            for (std::int64_t j; memory && (j = next.fetch_add(1)) < n_blocks;) parts[j] = one.run(j * chunk_size);
        });
    }
    RunResult total{empty_tally(), Outcome::good};
    for (std::int64_t j = 0; j < n_blocks; ++j) add(total, parts[j]);
    return total;
}

namespace {

Error error_of_first(const Chains &chains, const RunResult &found, std::initializer_list<NamedArray> arrays) {
    const Bodies &bodies = *chains.bodies();
    const std::int64_t m = found.tally.first_bad - chains.n_chains();
    const MoleculeKind &kind = bodies.kind(m);
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
    for (const NamedArray &one : arrays) {
        if (!one.array->x) continue;
        for (std::int32_t i = 0; i < kind.n_atoms; ++i) {
            double x[3];
            read_atom(*one.array, atoms[i], x);
            if (std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2])) continue;
            return finish(make_error(Status::not_finite, "%s: the %s of atom %s is not finite%s", name, one.what,
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
                           name, static_cast<int>(kind.parts.size()), chains.name_of_atom(atoms[0]).text, others),
                -1);
        case Outcome::no_convergence:
        case Outcome::stretched:
            return finish(
                make_error(
                    Status::no_convergence,
                    "%s, with %d bodies, the first of atom %s: nothing along the reference brings bodies and bonds "
                    "back from the positions to be projected; %s: %s%s",
                    name, static_cast<int>(kind.parts.size()), chains.name_of_atom(atoms[0]).text,
                    box_in_words(chains.box), too_long_a_step, others),
                -1);
        default:
            return finish(make_error(Status::not_finite, "%s: the numbers overflow or underflow; choose other units%s",
                                     name, others),
                          -1);
    }
}

// That of a value per bond of the first bad molecule that is not finite; else `otherwise`.
Error error_of_values(const Chains &chains, const NamedValues &given, const Error &otherwise) {
    const std::int64_t molecule = otherwise.chain - chains.n_chains();
    const MoleculeKind &s = chains.bodies()->kind(molecule);
    for (std::size_t k = 0; k < s.bonds.size(); ++k) {
        if (std::isfinite(given.values[chains.bodies()->bonds(molecule)[k]])) continue;
        Error error = make_error(Status::not_finite, "molecule %s: the %s of bond %lld is not finite",
                                 chains.name_of_rigid(otherwise.chain, chains.bodies()->atoms(molecule)[0]).text,
                                 given.what, static_cast<long long>(k) + chains.base);
        error.chain = otherwise.chain;
        error.bond = static_cast<std::int64_t>(k);
        error.n_bad = otherwise.n_bad;
        error.base = otherwise.base;
        return error;
    }
    return otherwise;
}

}  // namespace

void throw_if_bad(const Chains &chains, const RunResult &found, std::initializer_list<NamedArray> arrays,
                  const NamedValues *values) {
    if (found.tally.n_bad == 0) return;
    OutcomeOf *const outcomes = outcomes_under_way();
    for (std::int64_t m = chains.n_chains(); outcomes && m < chains.n_molecules(); ++m) {
        if (outcomes[m].status >= 0) continue;
        RunResult alone{found.tally, why(outcomes[m].status)};
        alone.tally.first_bad = m;
        outcomes[m].status = static_cast<std::int32_t>(error_of_first(chains, alone, arrays).status);
    }
    const Error error = error_of_first(chains, found, arrays);
    throw values ? error_of_values(chains, *values, error) : error;
}

Tally run_all(const Chains &chains, const BodyWork &work, std::initializer_list<NamedArray> arrays, double *virial,
              const NamedValues *values) {
    const RunResult found = run(chains, work);
    throw_if_bad(chains, found, arrays, values);
    if (virial) add_virial(found.tally, virial);
    return found.tally;
}

}  // namespace holonomic::rigid
