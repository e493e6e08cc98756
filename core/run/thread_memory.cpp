#include "core/run/thread_memory.hpp"

#include <cstdlib>

#if defined(_WIN32)
#include <malloc.h>
#else
#include <pthread.h>
#endif
#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "core/kernels/call.hpp"

namespace holonomic {

namespace {

// What is kept of a chain of a million bonds is gone through as a whole: fewer pages to look up.
constexpr std::int64_t large_page = 2097152;

struct Allocation {
    void *data;
    std::int64_t bytes;
};

struct Allocations {
    Allocation of[static_cast<int>(Keep::last)];
    bool kept;  // whether the end of the thread will free them
};

// Windows has an allocation of its own for what is aligned, and another one to give it back.
#if defined(_WIN32)
void *aligned(std::size_t alignment, std::size_t bytes) { return _aligned_malloc(bytes, alignment); }
void give_back(void *data) { _aligned_free(data); }
#else
void *aligned(std::size_t alignment, std::size_t bytes) { return std::aligned_alloc(alignment, bytes); }
void give_back(void *data) { std::free(data); }
#endif

void release(void *p) {
    Allocations &allocations = *static_cast<Allocations *>(p);
    for (Allocation &allocation : allocations.of) {
        give_back(allocation.data);
        allocation = Allocation{nullptr, 0};
    }
    allocations.kept = false;
}

#if defined(_WIN32)

struct OwnedAllocations : Allocations {
    OwnedAllocations() : Allocations{} {}
    ~OwnedAllocations() { release(this); }
};
thread_local OwnedAllocations allocations_of_this_thread;

bool keep(Allocations &) { return true; }

#else

// Not an object with a destructor: to register one, the run-time library allocates, and ends the process if it can't.
thread_local Allocations allocations_of_this_thread;

struct Key {
    pthread_key_t key;
    bool made;
    Key() : made(pthread_key_create(&key, release) == 0) {}
};

// Has the end of the thread free its allocations. The library stays loaded (-z nodelete), so that `release` is still
// there.
bool keep(Allocations &allocations) {
    static const Key end_of_thread;
    return end_of_thread.made && pthread_setspecific(end_of_thread.key, &allocations) == 0;
}

#endif

// Apart from the look, which every call takes.
[[gnu::noinline]] void *grow(Allocations &allocations, Allocation &allocation, std::int64_t bytes) noexcept {
    if (!allocations.kept) {
        if (!keep(allocations)) return nullptr;
        allocations.kept = true;
    }
    give_back(allocation.data);
    allocation = Allocation{nullptr, 0};
    const bool large = bytes >= 4 * large_page;
    const std::size_t alignment = large ? static_cast<std::size_t>(large_page) : sizeof(double) * most_lanes;
    const std::size_t rounded = (static_cast<std::size_t>(bytes) + alignment - 1) / alignment * alignment;
    allocation.data = aligned(alignment, rounded);
#ifdef MADV_HUGEPAGE
    if (large && allocation.data) static_cast<void>(madvise(allocation.data, rounded, MADV_HUGEPAGE));  // a wish
#endif
    if (allocation.data) allocation.bytes = static_cast<std::int64_t>(rounded);
    return allocation.data;
}

}  // namespace

void *thread_memory(Keep what, std::int64_t bytes) noexcept {
    Allocations &allocations = allocations_of_this_thread;
    Allocation &allocation = allocations.of[static_cast<int>(what)];
    return bytes <= allocation.bytes ? allocation.data : grow(allocations, allocation, bytes);
}

}  // namespace holonomic
