// Plans for kernels of an accelerator.
#include <algorithm>

#include "boundary.hpp"
#include "core/device/plan.hpp"

using holonomic::guarded;
using holonomic::make_error;
using holonomic::need;
using holonomic::Status;
using holonomic::device::Precision;

struct hol_device_plan {
    holonomic::device::KernelPlan plan;
};

namespace {

constexpr bool same(Precision precision, hol_device_precision code) {
    return static_cast<int>(precision) == static_cast<int>(code);
}
static_assert(same(Precision::single, HOL_DEVICE_SINGLE) && same(Precision::mixed, HOL_DEVICE_MIXED) &&
                  same(Precision::full, HOL_DEVICE_DOUBLE),
              "core/device/precision.hpp and the public header disagree");

struct Bytes {
    const void *data;
    std::int64_t size;
};

template <class Element>
Bytes bytes_of(const std::vector<Element> &array) {
    return {array.data(), static_cast<std::int64_t>(array.size() * sizeof(Element))};
}

Bytes bytes_of(const holonomic::device::KernelPlan &plan, hol_device_array which) {
    switch (which) {
        case HOL_DEVICE_INTEGERS:
            return bytes_of(plan.integers);
        case HOL_DEVICE_NUMBERS:
            return bytes_of(plan.numbers);
        case HOL_DEVICE_SCRATCH:
            return {nullptr, plan.scratch_bytes};
        case HOL_DEVICE_FAILURES:
            return bytes_of(plan.failures);
    }
    throw make_error(Status::value, "which is %d; it must be an hol_device_array", static_cast<int>(which));
}

}  // namespace

int hol_device_plan_create(const hol_chains *chains, hol_device_precision precision, int64_t max_entries,
                           hol_device_plan **plan) {
    if (plan) *plan = nullptr;
    return guarded(__func__, chains, [&] {
        need(plan, "plan");
        if (precision != HOL_DEVICE_SINGLE && precision != HOL_DEVICE_MIXED && precision != HOL_DEVICE_DOUBLE)
            throw make_error(Status::value,
                             "precision is %d; it must be HOL_DEVICE_SINGLE, HOL_DEVICE_MIXED or HOL_DEVICE_DOUBLE",
                             static_cast<int>(precision));
        *plan = new hol_device_plan{
            holonomic::device::make_plan(chains->chains, static_cast<Precision>(precision), max_entries)};
    });
}

void hol_device_plan_destroy(hol_device_plan *plan) { delete plan; }

const char *hol_device_plan_source(const hol_device_plan *plan) { return plan ? plan->plan.source.c_str() : nullptr; }

int hol_device_plan_array(const hol_device_plan *plan, hol_device_array which, const void **data, int64_t *bytes) {
    return guarded(__func__, [&] {
        need(plan, "plan");
        need(data, "data");
        need(bytes, "bytes");
        const Bytes array = bytes_of(plan->plan, which);
        *data = array.data;
        *bytes = array.size;
    });
}

int64_t hol_device_plan_n_launches(const hol_device_plan *plan) {
    return plan ? static_cast<std::int64_t>(plan->plan.launches.size()) : 0;
}

int hol_device_plan_launch(const hol_device_plan *plan, int64_t launch, const char **positions, const char **velocities,
                           int64_t *n_groups, int64_t *group_size) {
    return guarded(__func__, [&] {
        need(plan, "plan");
        const std::int64_t n = hol_device_plan_n_launches(plan);
        if (launch < 0 || launch >= n)
            throw make_error(Status::value, "launch is %lld; the plan has %lld, counted from 0",
                             static_cast<long long>(launch), static_cast<long long>(n));
        const holonomic::device::Launch &its = plan->plan.launches[static_cast<std::size_t>(launch)];
        if (positions) *positions = its.positions.c_str();
        if (velocities) *velocities = its.velocities.c_str();
        if (n_groups) *n_groups = its.n_groups;
        if (group_size) *group_size = its.group_size;
    });
}

int64_t hol_device_plan_n_left(const hol_device_plan *plan) {
    return plan ? static_cast<std::int64_t>(plan->plan.left.size()) : 0;
}

int hol_device_plan_left(const hol_device_plan *plan, int64_t *molecules) {
    return guarded(__func__, [&] {
        need(plan, "plan");
        need(hol_device_plan_n_left(plan), molecules, "molecules");
        std::copy(plan->plan.left.begin(), plan->plan.left.end(), molecules);
    });
}
