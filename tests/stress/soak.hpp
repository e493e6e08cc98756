/**
 * @file soak.hpp
 * Cases by number through all sets of kernels of this machine. A case and its solution are made once, by a process that
 * never calls the library; for each set a child of it checks them.
 */
#ifndef STRESS_SOAK_HPP
#define STRESS_SOAK_HPP

#include <cstdint>
#include <functional>
#include <new>
#include <string>
#include <type_traits>
#include <vector>

namespace stress
{

/** Numbers that are worked on together: a group begins with each multiple of it beyond the first number. */
constexpr std::uint64_t group_size = 8;

struct soak_options {
    double seconds = 0;
    std::uint64_t first = 1;         ///< number of the first case
    unsigned workers = 1;            ///< processes
    std::uint64_t end = UINT64_MAX;  ///< number behind the last case
};

/** The sets of kernels that the library has and this machine runs, or what HOLONOMIC_ISA names. */
std::vector<std::string> sets_of_kernels();

/** Runs body in a child that has these kernels; whether it ended with 0. What it allocates and changes is lost but for
 * shared memory. */
bool with_set(const std::string &set, const std::function<int()> &body);

/** Memory that all processes share, zero at first; the program ends if there is none. */
void *shared_memory(std::size_t bytes);

/** One T per worker and set, where the checks of that worker add up. */
template <class T>
class shared_tallies
{
public:
    shared_tallies(unsigned workers, std::size_t sets)
        : sets_(sets), all_(static_cast<T *>(shared_memory(workers * sets * sizeof(T)))), workers_(workers)
    {
        static_assert(std::is_trivially_copyable<T>::value, "children write it into shared memory");
        for (std::size_t i = 0; i < workers * sets; ++i) new (all_ + i) T();
    }
    T &of(unsigned worker, std::size_t set)
    {
        return all_[worker * sets_ + set];
    }
    T of_set(std::size_t set)
    {
        T sum;
        for (unsigned w = 0; w < workers_; ++w) sum.add(of(w, set));
        return sum;
    }
    std::vector<T> of_all_sets()
    {
        std::vector<T> sums;
        for (std::size_t s = 0; s < sets_; ++s) sums.push_back(of_set(s));
        return sums;
    }

private:
    std::size_t sets_;
    T *all_;
    unsigned workers_;
};

/**
 * Runs until the time is over or all cases have been checked; each worker begins at least one group.
 *   prepare(first)        adds the cases of the group that begins with this number
 *   check(worker, set)    checks all of them, with_set()
 *   clear()               forgets them
 *   progress()            from time to time
 * Returns how many children ended before their time: by a signal, or without having checked all.
 */
struct soak_work {
    std::function<void(std::uint64_t first)> prepare;
    std::function<void(unsigned worker, std::size_t set)> check;
    std::function<void()> clear, progress;
    std::string repeat;  ///< the command by which a group is repeated; its number follows
};
int soak(const soak_options &options, const std::vector<std::string> &sets, const soak_work &work);

}  // namespace stress

#endif
