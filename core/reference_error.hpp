// Of the last reference that a call with a handle has compared with the lengths, by whichever thread.
#pragma once

#include <mutex>

#include "core/check.hpp"

namespace holonomic {

class ReferenceError {
public:
    void set(const WorstLength &found) {
        const std::lock_guard<std::mutex> lock(mutex_);
        found_ = found;
        known_ = true;
    }
    bool get(WorstLength *found) {
        const std::lock_guard<std::mutex> lock(mutex_);
        *found = found_;
        return known_;
    }

private:
    std::mutex mutex_;
    WorstLength found_{0, -1, -1};
    bool known_ = false;
};

}  // namespace holonomic
