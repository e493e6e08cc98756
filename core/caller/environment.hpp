// The caller's floating-point environment: which exceptions trap, how results are rounded, whether denormal numbers are
// taken for zero, and which exceptions there have been. The library calculates in the default one, where nothing traps:
// lanes without a molecule may divide by zero.
#pragma once

#if defined(__aarch64__)
#include <cstdint>
#else
#include <cfenv>
#endif

namespace holonomic {

#if defined(__x86_64__)

// Doubles are calculated with MXCSR, and the C library rounds what it prints as x87's control word says.
struct Environment {
    unsigned mxcsr;
    unsigned short x87;
#if defined(_WIN32)
    unsigned short x87_flags = 0;
#endif
};

#if defined(_WIN32)
// MinGW's mathematical functions calculate with x87 and leave exceptions there.
inline unsigned short x87_flags() {
    unsigned short status;
    __asm__ volatile("fnstsw %0" : "=m"(status));
    return status & 0x3f;
}
inline void set_x87_flags(unsigned short flags) {
    struct {
        unsigned short control, reserved1, status, reserved2, rest[10];
    } all;  // as fnstenv has it
    __asm__ volatile("fnstenv %0" : "=m"(all));
    all.status = static_cast<unsigned short>((all.status & ~0x3f) | flags);
    __asm__ volatile("fldenv %0" : : "m"(all));
}
#endif

// _mm_getcsr is no barrier: compilers move it. Writing takes a quarter of the time of this look.
inline void read_environment(Environment &e) {
    __asm__ volatile("stmxcsr %0\n\tfnstcw %1" : "=m"(e.mxcsr), "=m"(e.x87));
#if defined(_WIN32)
    e.x87_flags = x87_flags();
#endif
}
inline void set_flags(const Environment &to) {
#if defined(_WIN32)
    if (x87_flags() != to.x87_flags) set_x87_flags(to.x87_flags);
#endif
    __asm__ volatile("ldmxcsr %0" : : "m"(to.mxcsr) : "memory");
}
inline void set_environment(const Environment &to) {
    __asm__ volatile("fldcw %0" : : "m"(to.x87) : "memory");
    set_flags(to);
}
inline void set_default_environment() { set_environment({0x1f80, 0x37f}); }
inline bool is_default(const Environment &e) { return (e.mxcsr & ~0x3fU) == 0x1f80 && e.x87 == 0x37f; }

#elif defined(__aarch64__)

struct Environment {
    std::uint64_t control, flags;  // FPCR, FPSR
};

inline void read_environment(Environment &e) {
    __asm__ volatile("mrs %0, fpcr\n\tmrs %1, fpsr" : "=r"(e.control), "=r"(e.flags));
}
inline void set_flags(const Environment &to) { __asm__ volatile("msr fpsr, %0" : : "r"(to.flags) : "memory"); }
inline void set_environment(const Environment &to) {
    __asm__ volatile("msr fpcr, %0" : : "r"(to.control) : "memory");
    set_flags(to);
}
inline void set_default_environment() { set_environment({0, 0}); }
inline bool is_default(const Environment &e) { return e.control == 0; }

#else

using Environment = std::fenv_t;

inline void read_environment(Environment &e) { std::fegetenv(&e); }
inline void set_environment(const Environment &to) { std::fesetenv(&to); }
inline void set_default_environment() { std::fesetenv(FE_DFL_ENV); }
inline void set_flags(const Environment &to) { set_environment(to); }
inline bool is_default(const Environment &) { return false; }  // nobody can look into it

#endif

// While it lives, this thread calculates in the default environment. Then it has again what it had, the exceptions
// that there have been included, and nothing traps on the way.
class DefaultEnvironment {
public:
    DefaultEnvironment() {
        read_environment(before_);
        was_default_ = is_default(before_);
        if (__builtin_expect(!was_default_, 0)) begin();
    }
    ~DefaultEnvironment() {
        if (__builtin_expect(was_default_, 1))
            set_flags(before_);
        else
            end();
    }
    DefaultEnvironment(const DefaultEnvironment &) = delete;
    DefaultEnvironment &operator=(const DefaultEnvironment &) = delete;

private:
    friend class CallersEnvironment;
    void begin() const noexcept;
    void end() const noexcept;

    Environment before_;
    bool was_default_;
};

// While it lives, this thread has what it had before its DefaultEnvironment: threads that start meanwhile inherit that,
// and keep it for the caller.
class CallersEnvironment {
public:
    CallersEnvironment() noexcept;
    ~CallersEnvironment();
    CallersEnvironment(const CallersEnvironment &) = delete;
    CallersEnvironment &operator=(const CallersEnvironment &) = delete;

private:
    const DefaultEnvironment *const inside_;
};

// The same where long double is used. On x86-64 x87 calculates with these; to look at what exceptions it has seen, and
// to forget new ones, takes as long as a call on one bond. On Windows all calls do.
#if defined(__x86_64__) && !defined(_WIN32)
class LongDoubleEnvironment {
public:
    LongDoubleEnvironment() {
        std::fegetenv(&before_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~LongDoubleEnvironment() { std::fesetenv(&before_); }
    LongDoubleEnvironment(const LongDoubleEnvironment &) = delete;
    LongDoubleEnvironment &operator=(const LongDoubleEnvironment &) = delete;

private:
    std::fenv_t before_;
};
#else
using LongDoubleEnvironment = DefaultEnvironment;
#endif

}  // namespace holonomic
