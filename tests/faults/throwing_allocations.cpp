#include "throwing_allocations.hpp"

#include <cstdlib>
#include <new>
#include <stdexcept>
#include <system_error>

const char *const kind_names[KINDS] = {
    "bad_alloc", "bad_array_new_length", "runtime_error", "system_error", "derived", "an int", "a pointer"};

kind thrown = BAD_ALLOC;
long left = -1;

namespace
{

struct derived : std::exception {
    const char *what() const noexcept override
    {
        return "thrown on purpose";
    }
};

[[noreturn]] void throw_it()
{
    switch (thrown) {
        case BAD_ALLOC:
            throw std::bad_alloc();
        case BAD_LENGTH:
            throw std::bad_array_new_length();
        case RUNTIME_ERROR:
            throw std::runtime_error("thrown on purpose");
        case SYSTEM_ERROR:
            throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again),
                                    "thrown on purpose");
        case DERIVED:
            throw derived();
        case AN_INT:
            throw 42;
        default:
            throw "thrown on purpose";
    }
}

}  // namespace

void *operator new(std::size_t size)
{
    if (left >= 0 && left-- == 0) throw_it();
    void *const p = std::malloc(size > 0 ? size : 1);
    if (!p) throw std::bad_alloc();
    return p;
}
void *operator new(std::size_t size, const std::nothrow_t &) noexcept  // whose only failure is NULL
{
    return std::malloc(size > 0 ? size : 1);
}
void operator delete(void *p) noexcept
{
    std::free(p);
}
void operator delete(void *p, std::size_t) noexcept
{
    std::free(p);
}
