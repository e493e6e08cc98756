// Parts of one large molecule, shared among threads.
#pragma once

#include "core/kernels/isa/target.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::graph {

// Calls body(i) for i = 0 .. n - 1, on the threads that there are.
template <class Body>
HOL_INLINE void share_out(const LongTeam *team, int32_t n, const Body &body) {
    if (!team) {
        for (int32_t i = 0; i < n; ++i) body(i);
        return;
    }
    Tally unused = empty_tally();
    team->run(
        team->threads, n, unused,
        [](const void *context, int64_t i, double *, Tally &) {
            (*static_cast<const Body *>(context))(static_cast<int32_t>(i));
        },
        &body);
}

// The same of body(i, its tally), which are added in this order.
template <class Body>
HOL_INLINE void share_out(const LongTeam *team, int32_t n, Tally &total, const Body &body) {
    const auto one = [](const void *context, int64_t i, double *, Tally &part) {
        (*static_cast<const Body *>(context))(static_cast<int32_t>(i), part);
    };
    if (team) return team->run(team->threads, n, total, one, &body);
    for (int32_t i = 0; i < n; ++i) {
        Tally part = empty_tally();
        one(&body, i, nullptr, part);
        add(total, part);
    }
}

// The same of body(i, memory of the thread); `own`: of this one.
template <class Body>
HOL_INLINE void share_out(const LongTeam *team, double *own, int32_t n, const Body &body) {
    if (!team) {
        for (int32_t i = 0; i < n; ++i) body(i, own);
        return;
    }
    Tally unused = empty_tally();
    team->run(
        team->threads, n, unused,
        [](const void *context, int64_t i, double *scratch, Tally &) {
            (*static_cast<const Body *>(context))(static_cast<int32_t>(i), scratch);
        },
        &body);
}

}  // namespace holonomic::HOL_ISA::graph
