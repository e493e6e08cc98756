# Two interface targets: how the library's own sources are compiled, and the warnings that all sources obey.

option(HOLONOMIC_WARNINGS_AS_ERRORS "Every warning in C and C++ ends the build: what continuous integration does" OFF)

set(warnings "$<$<COMPILE_LANGUAGE:C,CXX>:-Wall;-Wextra;-Wpedantic;-Wconversion;-Wshadow>")
if(WIN32) # where long, by which kernels count within an array, has 32 bits
    set(warnings "$<$<COMPILE_LANGUAGE:C,CXX>:-Wall;-Wextra;-Wshadow>")
endif()
add_library(holonomic_warnings INTERFACE)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options(holonomic_warnings INTERFACE "${warnings}")
    set(HOLONOMIC_WARNINGS "${warnings}") # for folders whose targets do not all name it: tests, examples, benchmarks
    if(HOLONOMIC_WARNINGS_AS_ERRORS)
        # For targets that don't name holonomic_warnings, too: the whole tree, examples included.
        add_compile_options("${warnings}" "$<$<COMPILE_LANGUAGE:C,CXX>:-Werror>")
        if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU") # a guess of the optimizer's, and often wrong about vectors: shown only
            add_compile_options("$<$<COMPILE_LANGUAGE:C,CXX>:-Wno-error=maybe-uninitialized>")
        endif()
    endif()
endif()

add_library(holonomic_flags INTERFACE)
target_compile_features(holonomic_flags INTERFACE cxx_std_17)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    # Products and sums are fused only where the source says fma: the compensated arithmetic depends on knowing which
    # operations round, and results must not depend on the compiler's taste. Nothing reads errno after sqrt.
    target_compile_options(holonomic_flags INTERFACE
        $<$<COMPILE_LANGUAGE:CXX>:-fvisibility=hidden -fvisibility-inlines-hidden -ffp-contract=off -fno-math-errno>)
    # On Windows gcc takes the stack to be aligned for AVX's vectors, which it is not: the assembler makes unaligned moves of them.
    if(MINGW AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        target_compile_options(holonomic_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wa,-muse-unaligned-vector-move>)
    endif()
    # The 387 rounds when it pleases, which compensated arithmetic does not survive.
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(i[3-6]86|x86|x86_64|AMD64|amd64)$" AND CMAKE_SIZEOF_VOID_P EQUAL 4)
        target_compile_options(holonomic_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-msse2 -mfpmath=sse>)
    endif()
endif()
