// The report of a call, as the caller has it.
#ifndef HOLONOMIC_CAPI_REPORT_HPP
#define HOLONOMIC_CAPI_REPORT_HPP

#include "core/positions.hpp"
#include "holonomic.h"

namespace holonomic {

// Written once there is one, also if the call fails then.
class ReportTo {
public:
    explicit ReportTo(hol_report *to) : to_(to) { found.made = false; }
    ~ReportTo() {
        if (!to_ || !found.made) return;
        *to_ = {found.iterations, found.n_corrected, found.n_failed, found.chain, found.bond, found.max_error};
    }
    ReportTo(const ReportTo &) = delete;
    ReportTo &operator=(const ReportTo &) = delete;
    Report *wanted() { return to_ ? &found : nullptr; }

    Report found;

private:
    hol_report *const to_;
};

}  // namespace holonomic
#endif
