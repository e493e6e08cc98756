// The one place where C++ ends: whatever is thrown below it comes out as a status with a message. The wrapper of the C
// functions is given each kind of exception here; test_exceptions.cpp does the same to the functions themselves.
#include "capi/boundary.hpp"

#include <cstdio>
#include <cstring>
#include <future>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>

namespace
{

int failures = 0;

void expect(bool right, const char *what)
{
    if (right) return;
    std::printf("%s: status message \"%s\"\n", what, hol_error_message());
    ++failures;
}

struct Derived : std::exception {
    const char *what() const noexcept override
    {
        return "derived from std::exception";
    }
};

struct Unrelated {
    std::string text = "no std::exception";
};

template <class Thrown>
void comes_out_as(const char *name, int status, const char *words, Thrown thrown)
{
    const int got = holonomic::guarded("hol_test", [&] { throw thrown; });
    expect(got == status && std::strstr(hol_error_message(), words), name);
    expect(std::strncmp(hol_error_message(), "hol_test: ", 10) == 0, "the name of the function");
    std::int64_t chain = 7, bond = 7, atom = 7, bad = 7;
    hol_error_location(&chain, &bond, &atom, &bad);
    expect(chain == -1 && bond == -1 && atom == -1 && bad == 0, "a location left over from an earlier error");
}

void every_kind_has_a_status_and_a_message()
{
    comes_out_as("bad_alloc", HOL_ERR_MEMORY, "out of memory", std::bad_alloc());
    comes_out_as("bad_array_new_length", HOL_ERR_MEMORY, "out of memory", std::bad_array_new_length());
    comes_out_as("runtime_error", HOL_ERR_INTERNAL, "something at run time",
                 std::runtime_error("something at run time"));
    comes_out_as("length_error", HOL_ERR_INTERNAL, "too long", std::length_error("too long"));
    comes_out_as("derived", HOL_ERR_INTERNAL, "derived from std::exception", Derived());
    comes_out_as("system_error", HOL_ERR_INTERNAL, "no thread",
                 std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again), "no thread"));
    comes_out_as("future_error", HOL_ERR_INTERNAL, "internal error",
                 std::future_error(std::future_errc::broken_promise));
    comes_out_as("an int", HOL_ERR_INTERNAL, "internal error", 42);
    comes_out_as("text", HOL_ERR_INTERNAL, "internal error", static_cast<const char *>("text"));
    comes_out_as("a null pointer", HOL_ERR_INTERNAL, "internal error", nullptr);
    comes_out_as("an unrelated class", HOL_ERR_INTERNAL, "internal error", Unrelated());
    comes_out_as("the library's own", HOL_ERR_VALUE, "dt is -1",
                 holonomic::make_error(holonomic::Status::value, "dt is %d", -1));
}

void messages_are_cut_to_their_room()
{
    const std::string text = std::string(10000, 'x') + "%s%n";
    const int got = holonomic::guarded("hol_test", [&] { throw std::runtime_error(text); });
    const std::size_t length = std::strlen(hol_error_message());
    expect(got == HOL_ERR_INTERNAL && length > 100 && length < 690, "a message of 10,000 characters");
    holonomic::guarded("hol_test", [] { throw std::runtime_error("%s%s%n"); });
    expect(std::strstr(hol_error_message(), "%s%s%n"), "a message that looks like a format");
}

// A thread's exception is that thread's error and nobody else's.
void each_thread_keeps_its_own_message()
{
    holonomic::guarded("hol_test", [] { throw std::runtime_error("here"); });
    std::string there;
    std::thread([&] {
        holonomic::guarded("hol_test", [] { throw std::runtime_error("over there"); });
        there = hol_error_message();
    }).join();
    expect(there.find("over there") != std::string::npos, "another thread's message");
    expect(std::strstr(hol_error_message(), "here") && !std::strstr(hol_error_message(), "there"),
           "this thread's message");
}

void success_throws_nothing_and_keeps_the_last_message()
{
    holonomic::guarded("hol_test", [] { throw std::runtime_error("kept"); });
    expect(holonomic::guarded("hol_test", [] {}) == HOL_OK && std::strstr(hol_error_message(), "kept"), "a success");
}

}  // namespace

int main()
{
    every_kind_has_a_status_and_a_message();
    messages_are_cut_to_their_room();
    each_thread_keeps_its_own_message();
    success_throws_nothing_and_keeps_the_last_message();
    if (failures == 0) std::puts("every kind of exception ends at the boundary");
    return failures != 0;
}
