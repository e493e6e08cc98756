// Members that make a set of molecules one that can be copied.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>

namespace holonomic {

// Owns what is copied with it.
template <class T>
class Owned : public std::unique_ptr<T> {
public:
    Owned() = default;
    Owned(const Owned &other) : std::unique_ptr<T>(other ? new T(*other) : nullptr) {}
    Owned &operator=(const Owned &) = delete;
    Owned &operator=(std::unique_ptr<T> &&other) {
        std::unique_ptr<T>::operator=(std::move(other));
        return *this;
    }
};

// What several threads may note at once.
class Flag {
public:
    Flag() = default;
    Flag(const Flag &other) : set_(other.get()) {}
    Flag &operator=(const Flag &) = delete;
    bool get() const { return set_.load(std::memory_order_relaxed); }
    void set(bool to) { set_.store(to, std::memory_order_relaxed); }

private:
    std::atomic<bool> set_{false};
};

// Made by the first of the threads that need it, and once more after clear(). A copy makes its own.
template <class T>
class Made {
public:
    Made() = default;
    Made(const Made &) {}
    Made &operator=(const Made &) = delete;

    const T *there() const { return made_.load(std::memory_order_acquire); }
    template <class Make>
    const T &once(const Make &make) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!made_.load(std::memory_order_relaxed)) {
            owner_ = make();
            made_.store(owner_.get(), std::memory_order_release);
        }
        return *owner_;
    }
    void clear() { made_.store(nullptr); }

private:
    std::mutex mutex_;
    std::atomic<const T *> made_{nullptr};
    std::unique_ptr<T> owner_;
};

}  // namespace holonomic
