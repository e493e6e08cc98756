// What an elimination plan says that it occupies is what has been allocated for it.
#include <cstdio>
#include <cstdlib>
#include <new>
#include <random>
#include <vector>

#include "core/molecules/planned/elimination_plan.hpp"

namespace
{

constexpr std::size_t header = 16;  // keeps the alignment
std::size_t in_use = 0;

void *allocate(std::size_t n)
{
    char *const p = static_cast<char *>(std::malloc(n + header));
    if (!p) throw std::bad_alloc();
    *reinterpret_cast<std::size_t *>(p) = n;
    in_use += n;
    return p + header;
}

void release(void *p) noexcept
{
    if (!p) return;
    char *const start = static_cast<char *>(p) - header;
    in_use -= *reinterpret_cast<std::size_t *>(start);
    std::free(start);
}

}  // namespace

void *operator new(std::size_t n)
{
    return allocate(n);
}
void operator delete(void *p) noexcept
{
    release(p);
}
void operator delete(void *p, std::size_t) noexcept
{
    release(p);
}

namespace
{

/// Each atom is bonded to one of the `reach` before it; every `ring`th bond closes a ring of three, if there are any.
std::vector<std::int32_t> bonds_of(std::int32_t n_atoms, std::int32_t reach, std::int32_t ring)
{
    std::mt19937 random(5);
    std::vector<std::int32_t> pairs;
    for (std::int32_t i = 1; i < n_atoms; ++i) {
        const std::int32_t back = 1 + static_cast<std::int32_t>(random() % static_cast<unsigned>(reach));
        pairs.insert(pairs.end(), {i > back ? i - back : 0, i});
        if (ring > 0 && i > 2 && i % ring == 0 && pairs[pairs.size() - 2] != i - 2)
            pairs.insert(pairs.end(), {i - 2, i});
    }
    return pairs;
}

bool is_counted(const char *name, std::int32_t n_atoms, std::int32_t reach, std::int32_t ring)
{
    const std::vector<std::int32_t> pairs = bonds_of(n_atoms, reach, ring);
    const std::size_t before = in_use;
    const auto s =
        holonomic::make_elimination_plan(n_atoms, static_cast<std::int32_t>(pairs.size() / 2), pairs.data(), nullptr);
    const std::size_t allocated = in_use - before, said = holonomic::bytes_of(*s);
    if (said == allocated) return true;
    std::printf("%s: %zu bytes are allocated, %zu are said to be\n", name, allocated, said);
    return false;
}

}  // namespace

int main()
{
    bool good = is_counted("a small tree", 20, 3, 0);
    good = is_counted("a small graph", 20, 1, 4) && good;
    good = is_counted("a large tree", 5000, 6, 0) && good;
    good = is_counted("a large tree of arms", 5000, 1, 0) && good;
    good = is_counted("a large graph", 5000, 3, 7) && good;
    return good ? 0 : 1;
}
