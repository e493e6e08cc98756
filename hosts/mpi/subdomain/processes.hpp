#ifndef HOLONOMIC_SUBDOMAIN_PROCESSES_HPP
#define HOLONOMIC_SUBDOMAIN_PROCESSES_HPP

#include <holonomic.h>

#include <algorithm>
#include <cstdint>
#include <new>
#include <string>
#include <vector>

#include "../holonomic_subdomain.h"

namespace holonomic_subdomain {

/** What ends a call, on every process. */
struct Failure {
    int status;
    std::string message;
};

/**
 * The processes of the program. What goes wrong on one of them between two sums is kept until the next sum, which all
 * take part in, and ends the call everywhere.
 */
class Processes {
public:
    Processes(int rank, int n_ranks, hol_subdomain_sum sum, void *context)
        : rank_(rank), n_ranks_(n_ranks), sum_(sum), context_(context) {}

    /** Does what concerns this process alone, unless something went wrong before. */
    template <class Function>
    void alone(Function function) {
        if (failure_.status != HOL_OK) return;
        try {
            function();
        } catch (const Failure &failure) {
            failure_ = failure;
        } catch (const std::bad_alloc &) {
            failure_ = {HOL_ERR_MEMORY, "out of memory"};
        }
    }

    /** Sums over all processes; the same bits on each. */
    void add_up(std::vector<double> &numbers) {
        numbers.resize(numbers.size() + n_ranks_, 0.0);
        double *statuses = numbers.data() + numbers.size() - n_ranks_;
        statuses[rank_] = failure_.status;
        ++n_sums, n_numbers += static_cast<std::int64_t>(numbers.size());
        if (sum_(context_, static_cast<std::int64_t>(numbers.size()), numbers.data()) != 0)
            throw Failure{HOL_ERR_CALLBACK, "the program's sum over processes failed"};
        for (int p = 0; p < n_ranks_; ++p) {
            if (statuses[p] == HOL_OK) continue;
            Failure failure = failure_;
            if (failure.status == HOL_OK)
                failure = {static_cast<int>(statuses[p]), "process " + std::to_string(p) + " failed: " +
                                                              hol_status_name(static_cast<int>(statuses[p]))};
            failure_ = {};
            throw failure;
        }
        numbers.resize(numbers.size() - n_ranks_);
    }

    /** The largest of what processes give. */
    double largest(double number) {
        std::vector<double> numbers(n_ranks_, 0.0);
        numbers[rank_] = number;
        add_up(numbers);
        return *std::max_element(numbers.begin(), numbers.end());
    }

    /** What was kept of a call that failed; a new call begins without. */
    void forget() { failure_ = {}; }

    int rank() const { return rank_; }
    int n_ranks() const { return n_ranks_; }

    std::int64_t n_sums = 0, n_numbers = 0;

private:
    int rank_, n_ranks_;
    hol_subdomain_sum sum_;
    void *context_;
    Failure failure_{HOL_OK, ""};
};

}  // namespace holonomic_subdomain

#endif
