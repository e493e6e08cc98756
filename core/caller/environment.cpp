#include "core/caller/environment.hpp"

namespace holonomic {

namespace {

thread_local const DefaultEnvironment *inside = nullptr;  // that of this thread, if the caller's is another one

}  // namespace

void DefaultEnvironment::begin() const noexcept {
    inside = this;
    set_default_environment();
}

void DefaultEnvironment::end() const noexcept {
    if (inside == this) inside = nullptr;
    set_environment(before_);
}

CallersEnvironment::CallersEnvironment() noexcept : inside_(inside) {
    if (inside_) set_environment(inside_->before_);
}

CallersEnvironment::~CallersEnvironment() {
    if (!inside_) return;
    inside = inside_;
    set_default_environment();
}

}  // namespace holonomic
