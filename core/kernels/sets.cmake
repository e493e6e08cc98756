# The kernels: the same sources once per instruction set, each into a namespace of its own; kernel_choice.cpp picks a set at
# run time. Only these may be compiled for more than the baseline, so that no shared inline function of theirs can end up in
# another path.

# Chains that fit into lanes: what every set has.
set(chain_kernels
    kernels/kept/chains.cpp
    kernels/memory/load.cpp
    kernels/memory/load_lists.cpp
    kernels/memory/open.cpp
    kernels/memory/outputs.cpp
    kernels/memory/stage.cpp
    kernels/newton/attempts.cpp
    kernels/newton/extent.cpp
    kernels/newton/solve.cpp
    kernels/newton/system.cpp
    kernels/verbs/forces.cpp
    kernels/verbs/metric.cpp
    kernels/verbs/positions.cpp
    kernels/verbs/table.cpp
    kernels/verbs/velocities.cpp
)
# Long chains, and molecules that are no chains.
set(other_kernels
    kernels/kept/molecules.cpp
    kernels/verbs/bodies.cpp
    kernels/verbs/molecules_forces.cpp
    kernels/verbs/molecules_batches.cpp
    kernels/verbs/molecules_linear.cpp
    kernels/verbs/molecules_metric.cpp
    kernels/verbs/molecules_network.cpp
    kernels/verbs/molecules_positions.cpp
    kernels/verbs/molecules_velocities.cpp
    kernels/verbs/positions_long.cpp
    kernels/verbs/positions_paths.cpp
    kernels/verbs/segments.cpp
    kernels/verbs/tridiagonal.cpp
)
set(extended_kernels
    kernels/extended/linear.cpp
    kernels/extended/metric.cpp
    kernels/extended/positions.cpp
)

# The kernels have vectors of their own. What gcc makes of their other loops doubles the code of these files and the time
# to compile them, and saves no instruction. Loops in stage.cpp are meant for it.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set_source_files_properties(
        kernels/memory/open.cpp
        kernels/newton/attempts.cpp
        kernels/newton/solve.cpp
        kernels/newton/system.cpp
        kernels/verbs/positions.cpp
        PROPERTIES COMPILE_OPTIONS -fno-tree-loop-vectorize)
    # Nor do copies of loops and of paths.
    set_source_files_properties(
        kernels/verbs/molecules_forces.cpp
        kernels/verbs/molecules_linear.cpp
        kernels/verbs/molecules_metric.cpp
        kernels/verbs/molecules_network.cpp
        kernels/verbs/molecules_positions.cpp
        kernels/verbs/molecules_velocities.cpp
        PROPERTIES COMPILE_OPTIONS "-fno-split-loops;-fno-split-paths")
    # Here it makes addresses in vectors, and what comes next waits for these to be in memory.
    set_source_files_properties(kernels/verbs/bodies.cpp PROPERTIES COMPILE_OPTIONS -fno-tree-vectorize)
endif()

option(HOLONOMIC_BASELINE "The kernels that every x86-64 processor runs; OFF where the library stays on this machine (scripts/demo, scripts/try)" ON)
option(HOLONOMIC_TEST_SETS "With the tests, kernels of a number of lanes that no set has, in a library for tests alone" OFF)
set(HOLONOMIC_TEST_LANES "8" CACHE STRING "Their lanes; one, two and four are installed")

# Objects of kernels in the namespace of that name.
function(holonomic_kernel_objects name lanes)
    cmake_parse_arguments(PARSE_ARGV 2 objects "" "" "SOURCES;DEFINES;FLAGS")
    set(target holonomic_kernels_${name})
    add_library(${target} OBJECT ${objects_SOURCES})
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_compile_definitions(${target} PRIVATE HOL_ISA=${name} HOL_LANES=${lanes} ${objects_DEFINES})
    target_compile_options(${target} PRIVATE ${objects_FLAGS})
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${target} PRIVATE holonomic_flags holonomic_warnings)
endfunction()

# holonomic_kernels(NAME LANES EXTENDED set [NETWORKS set] [TESTS_ONLY] [CHAINS_ONLY] [FLAGS flag...] [TUNING flag...] [NEEDS feature...])
#   NAME         of the namespace, of the object library holonomic_kernels_NAME, and for HOLONOMIC_ISA
#   LANES        doubles worked on at once
#   EXTENDED     the solver in extended precision that it uses, see below
#   NETWORKS     another set, whose networks it uses where that one is compiled
#   TESTS_ONLY   in no library but the one of tests/lanes; runs only if HOLONOMIC_ISA names it
#   CHAINS_ONLY  runs for chains that fit into lanes, beside another set
#   FLAGS        of the compiler
#   TUNING       more of them, that are its own
#   NEEDS        of the processor, as __builtin_cpu_supports() names it
set(kernel_objects)
set(test_kernel_objects)
set(kernel_sets)
set(test_kernel_sets)
set(set_names)
set(extended_solvers)
function(holonomic_kernels name lanes)
    cmake_parse_arguments(PARSE_ARGV 2 set "TESTS_ONLY;CHAINS_ONLY" "EXTENDED;NETWORKS" "FLAGS;TUNING;NEEDS")
    if((set_TESTS_ONLY AND NOT (HOLONOMIC_BUILD_TESTS AND HOLONOMIC_TEST_SETS)) OR
       (NOT set_TESTS_ONLY AND NOT name IN_LIST HOLONOMIC_INSTRUCTION_SETS AND NOT (name STREQUAL HOLONOMIC_BASELINE_SET AND (HOLONOMIC_BASELINE OR NOT HOLONOMIC_X86_64))))
        return()
    endif()
    set(sources ${chain_kernels} ${other_kernels})
    set(defines HOL_EXTENDED=${set_EXTENDED})
    set(kind "")
    if(set_CHAINS_ONLY)
        set(sources ${chain_kernels})
        list(APPEND defines HOL_CHAINS_ONLY)
    endif()
    if(set_NETWORKS IN_LIST HOLONOMIC_INSTRUCTION_SETS)
        list(REMOVE_ITEM sources kernels/verbs/molecules_network.cpp)
        list(APPEND defines HOL_NETWORKS=${set_NETWORKS})
    endif()
    if(set_TESTS_ONLY)
        list(APPEND defines HOL_TESTS_ONLY)
        set(kind test_)
    endif()
    holonomic_kernel_objects(${name} ${lanes} SOURCES ${sources} DEFINES ${defines} FLAGS ${set_FLAGS} ${set_TUNING})
    # What the tests of headers compile with.
    list(TRANSFORM defines PREPEND -D)
    set(HOLONOMIC_COMPILES_${name} -DHOL_ISA=${name} -DHOL_LANES=${lanes} ${defines} ${set_FLAGS} CACHE INTERNAL "")
    set(condition true)
    foreach(feature IN LISTS set_NEEDS)
        string(APPEND condition " && __builtin_cpu_supports(\"${feature}\")")
    endforeach()
    set(${kind}kernel_objects ${${kind}kernel_objects} $<TARGET_OBJECTS:holonomic_kernels_${name}> PARENT_SCOPE)
    set(${kind}kernel_sets "${${kind}kernel_sets} \\\n    set(${name}, (${condition}))" PARENT_SCOPE)
    set(set_names ${set_names} ${name} PARENT_SCOPE)
    set(extended_solvers ${extended_solvers} ${set_EXTENDED} PARENT_SCOPE)
endfunction()

# The sets, the one to be preferred first; kernel_choice.cpp has the measurements, and where another runs.
set(HOLONOMIC_INSTRUCTION_SETS "avx2;avx512vl;scalar" CACHE STRING "Kernels to compile beside those that every processor of this kind runs")
set(HOLONOMIC_X86_64 OFF)
set(HOLONOMIC_AARCH64 OFF)
set(HOLONOMIC_BASELINE_SET baseline)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$" AND CMAKE_SIZEOF_VOID_P EQUAL 8
   AND CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    set(HOLONOMIC_X86_64 ON)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64|ARM64)$" AND CMAKE_SIZEOF_VOID_P EQUAL 8
       AND CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    set(HOLONOMIC_AARCH64 ON)
    set(HOLONOMIC_BASELINE_SET neon)
endif()
set(avx2 -mavx2 -mfma)
set(fused)
if(HOLONOMIC_X86_64)
    set(fused ${avx2})
endif()
# gcc copies several vectors of four in halves or in pairs, unless it is told not to, and what then reads one waits for these to
# be in memory.
set(whole)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12)
    set(whole -mmove-max=256 -mstore-max=256)
endif()
# Of 32 registers of vectors gcc uses some to keep addresses in, and what is read there waits for these to come back.
set(addresses_apart)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    include(CheckCXXCompilerFlag)
    set(flag -mtune-ctrl=^inter_unit_moves_from_vec,^inter_unit_moves_to_vec)
    check_cxx_compiler_flag(${flag} HOLONOMIC_HAS_MTUNE_CTRL)
    if(HOLONOMIC_HAS_MTUNE_CTRL)
        set(addresses_apart ${flag})
    endif()
endif()
if(HOLONOMIC_X86_64)
    holonomic_kernels(avx512vl 4 EXTENDED double_double_fma NETWORKS avx2 NEEDS avx512f avx512dq avx512vl fma
        FLAGS -mavx512f -mavx512dq -mavx512vl -mfma -mprefer-vector-width=256 TUNING ${whole} ${addresses_apart})
    holonomic_kernels(avx2 4 EXTENDED double_double_fma FLAGS ${avx2} TUNING ${whole} NEEDS avx2 fma)
    # Numbers of lanes that other processors have or may have, on any that has AVX2.
    foreach(lanes IN LISTS HOLONOMIC_TEST_LANES)
        holonomic_kernels(lanes${lanes} ${lanes} TESTS_ONLY EXTENDED double_double_fma FLAGS ${avx2} -O1 -Wno-psabi
            NEEDS avx2 fma)
    endforeach()
endif()
# What every processor of this kind runs. For x86-64 processors of before 2013 size counts.
set(small)
if(HOLONOMIC_X86_64)
    set(small -Os -DHOL_SMALL=1)
endif()
if(HOLONOMIC_AARCH64)
    holonomic_kernels(neon 2 EXTENDED double_double_fma)
else()
    holonomic_kernels(baseline 2 EXTENDED double_double FLAGS ${small})
endif()
# One lane: chains that come alone, beside any of the sets above that fuse products and sums. Pairs of components stored at once
# and loaded one by one, or the other way round, would wait for each other.
if(HOLONOMIC_X86_64)
    holonomic_kernels(scalar 1 CHAINS_ONLY EXTENDED double_double_fma FLAGS ${avx2} -fno-tree-slp-vectorize NEEDS avx2 fma)
elseif(HOLONOMIC_AARCH64)
    holonomic_kernels(scalar 1 CHAINS_ONLY EXTENDED double_double_fma FLAGS -fno-tree-slp-vectorize)
endif()
set(HOLONOMIC_KERNEL_SET_NAMES ${set_names} CACHE INTERNAL "")

# The solver in extended precision, in twice the precision for sets that fuse products and sums and for those that don't; and what it
# leaves to four times the precision, for all.
holonomic_kernel_objects(quad_double 2 SOURCES ${extended_kernels} DEFINES HOL_QUAD_DOUBLE FLAGS $<$<CONFIG:Release>:-Os>)
list(APPEND kernel_objects $<TARGET_OBJECTS:holonomic_kernels_quad_double>)
if("double_double" IN_LIST extended_solvers OR HOLONOMIC_BUILD_TESTS)
    holonomic_kernel_objects(double_double 2 SOURCES ${extended_kernels} FLAGS ${small})
    list(APPEND kernel_objects $<TARGET_OBJECTS:holonomic_kernels_double_double>)
endif()
if("double_double_fma" IN_LIST extended_solvers)
    holonomic_kernel_objects(double_double_fma 2 SOURCES ${extended_kernels} FLAGS ${fused} $<$<CONFIG:Release>:-O2>)
    list(APPEND kernel_objects $<TARGET_OBJECTS:holonomic_kernels_double_double_fma>)
endif()
