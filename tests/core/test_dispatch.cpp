// Which kernels run: the rule, and that whatever it chooses is there.
#include <cstdint>
#include <cstdio>
#include <initializer_list>

#include "core/kernel_choice.hpp"

using namespace holonomic;

namespace
{

int n_failed = 0;

void expect(bool holds, const char *what)
{
    if (holds) return;
    std::printf("not so: %s\n", what);
    ++n_failed;
}

Unit unit_of(std::int64_t count, bool large)
{
    static const Lane lane = {};
    return Unit{&lane, count, true, large};
}

}  // namespace

int main()
{
    const std::int64_t counts[] = {1, 7, 8, 1000};
    for (const std::int64_t count : counts)
        for (const bool large : {false, true}) {
            const Unit unit = unit_of(count, large);
            const Kernels &chosen = kernels(unit);
            expect(&chosen == &kernels() || (chosen.lanes == 1 && count == 1),
                   "a unit runs with the common kernels, a chain alone with those of one lane");
            expect(chosen.lanes == kernels().lanes || kernels().lanes >= 4, "the baseline's bits are of its own");
            expect(chosen.scratch_bytes(256) <= scratch_bytes(256), "there is scratch for the set that runs");
        }
    std::printf("runs here: %s\n", kernels().name);
    return n_failed > 0;
}
