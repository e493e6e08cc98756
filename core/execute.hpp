// Runs a kernel over all chains, on as many threads as the work is worth.
#ifndef HOLONOMIC_EXECUTE_HPP
#define HOLONOMIC_EXECUTE_HPP

#include "chains.hpp"
#include "dispatch.hpp"

namespace holonomic {

// The sums of a call. Pieces are added in their order, whatever thread worked on them.
Tally empty_tally();
void add(Tally &total, const Tally &piece);

// Memory of the calling thread that stays until the thread ends; nullptr if there is none to be had. Aligned to 64.
double *thread_scratch(std::int64_t bytes);

// Calls work(unit, scratch, tally) for every piece of the plan. Throws std::bad_alloc before any work is done.
class Work {
public:
    virtual void operator()(const Unit &unit, double *scratch, Tally &tally) const = 0;

protected:
    ~Work() = default;
};
Tally execute(const Chains &chains, const Work &work);

template <class Call>
Tally execute(const Chains &chains, void (*kernel)(const Call &, const Unit &, double *, Tally &), const Call &call) {
    struct KernelWork final : Work {
        void (*kernel)(const Call &, const Unit &, double *, Tally &);
        const Call &call;
        KernelWork(void (*k)(const Call &, const Unit &, double *, Tally &), const Call &c) : kernel(k), call(c) {}
        void operator()(const Unit &unit, double *scratch, Tally &tally) const override {
            kernel(call, unit, scratch, tally);
        }
    };
    return execute(chains, KernelWork(kernel, call));
}

}  // namespace holonomic
#endif
