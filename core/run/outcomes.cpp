#include "core/run/outcomes.hpp"

#include <algorithm>
#include <new>

#include "core/run/thread_memory.hpp"

namespace holonomic {

namespace {

struct KeptOutcomes {
    OutcomeOf *outcomes;
    const Chains *under_way, *complete;  // null: none
    std::int64_t n;
};
thread_local KeptOutcomes kept{};

}  // namespace

OutcomeOf *outcomes_under_way() { return kept.under_way ? kept.outcomes : nullptr; }

void begin_outcomes(const Chains &chains) {
    kept = KeptOutcomes{};
    const std::int64_t n = chains.n_molecules(), bytes = n * static_cast<std::int64_t>(sizeof(OutcomeOf));
    OutcomeOf *const outcomes =
        static_cast<OutcomeOf *>(thread_memory(Keep::outcomes, std::max<std::int64_t>(bytes, 1)));
    if (!outcomes) throw std::bad_alloc();
    std::fill(outcomes, outcomes + n, OutcomeOf{0, 0});
    kept = KeptOutcomes{outcomes, &chains, nullptr, n};
}

void end_outcomes(bool complete) {
    if (complete) kept.complete = kept.under_way;
    kept.under_way = nullptr;
}

const OutcomeOf *last_outcomes(const Chains &chains) {
    return kept.complete == &chains && kept.n == chains.n_molecules() ? kept.outcomes : nullptr;
}

}  // namespace holonomic
