#include "soak.hpp"

#include <holonomic.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

namespace stress
{

namespace
{

using clock_type = std::chrono::steady_clock;

constexpr double seconds_of_batch = 0.5;  // in which what a child costs is lost

double seconds_since(clock_type::time_point start)
{
    return std::chrono::duration<double>(clock_type::now() - start).count();
}

/** Runs body in a child. Returns whether it ended as it should. */
template <class Body>
bool in_child(const Body &body)
{
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child < 0) {
        std::perror("stress: fork");
        std::exit(2);
    }
    if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGTERM);
        const int status = body();
        std::fflush(nullptr);
        _exit(status);
    }
    int status = 0;
    return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

struct shared_state {
    std::atomic<std::uint64_t> next;
    std::atomic<int> lost;  // children
};

void work_on(unsigned worker, const soak_options &options, const std::vector<std::string> &sets, const soak_work &work,
             clock_type::time_point start, shared_state &all)
{
    std::uint64_t groups = 1;
    do {
        const clock_type::time_point begun = clock_type::now();
        const std::uint64_t first = all.next.fetch_add(groups * group_size);
        for (std::uint64_t g = 0; g < groups && first + g * group_size < options.end; ++g)
            work.prepare(first + g * group_size);
        for (std::size_t s = 0; s < sets.size(); ++s) {
            const bool good = with_set(sets[s], [&] {
                work.check(worker, s);
                return 0;
            });
            if (good) continue;
            ++all.lost;
            for (std::uint64_t g = 0; g < groups; ++g)
                std::printf("a process ended before its time in one of these: HOLONOMIC_ISA=%s %s %llu\n",
                            sets[s].c_str(), work.repeat.c_str(),
                            static_cast<unsigned long long>(first + g * group_size));
        }
        work.clear();
        if (groups < 64 && seconds_since(begun) < seconds_of_batch) groups *= 2;
    } while (all.next < options.end && seconds_since(start) < options.seconds);
}

}  // namespace

bool with_set(const std::string &set, const std::function<int()> &body)
{
    return in_child([&] {
        setenv("HOLONOMIC_ISA", set.c_str(), 1);
        return set == hol_instruction_set() ? body() : 1;
    });
}

std::vector<std::string> sets_of_kernels()
{
    if (const char *const wanted = std::getenv("HOLONOMIC_ISA")) return {wanted};
    std::vector<std::string> sets;
    for (const char *const name : {STRESS_SETS})
        if (with_set(name, [] { return 0; })) sets.push_back(name);
    return sets;
}

void *shared_memory(std::size_t bytes)
{
    void *const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory != MAP_FAILED) return memory;
    std::perror("stress: mmap");
    std::exit(2);
}

int soak(const soak_options &options, const std::vector<std::string> &sets, const soak_work &work)
{
    const clock_type::time_point start = clock_type::now();
    shared_state &all = *new (shared_memory(sizeof(shared_state))) shared_state();
    all.next = options.first;
    std::vector<pid_t> workers;
    for (unsigned w = 0; w < options.workers; ++w) {
        std::fflush(nullptr);
        const pid_t worker = fork();
        if (worker == 0) {
            prctl(PR_SET_PDEATHSIG, SIGTERM);
            work_on(w, options, sets, work, start, all);
            std::fflush(nullptr);
            _exit(0);
        }
        if (worker > 0) workers.push_back(worker);
    }
    int lost = 0;
    double shown = 0;
    while (!workers.empty()) {
        int status = 0;
        const pid_t ended = waitpid(workers.back(), &status, WNOHANG);
        if (ended != 0) {
            lost += ended < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0;
            workers.pop_back();
            continue;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        if (seconds_since(start) - shown < 10) continue;
        shown = seconds_since(start);
        std::fprintf(stderr, "%6.0f of %.0f s: ", shown, options.seconds);
        work.progress();
    }
    return lost + all.lost;
}

}  // namespace stress
