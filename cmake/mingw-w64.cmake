# For Windows on x86-64 processors, by MinGW-w64 (Debian: g++-mingw-w64-x86-64-posix, gfortran-mingw-w64-x86-64-posix):
#
#   cmake -S . -B build/windows -DCMAKE_TOOLCHAIN_FILE=cmake/mingw-w64.cmake
#
# What it makes needs no other DLL than those of Windows: the compilers' run-time libraries are inside. Wine runs the tests, if it is
# there. docs/windows.md.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(target x86_64-w64-mingw32)

# Those with POSIX threads, where a distribution has others, too: OpenMP wants them.
foreach(language IN ITEMS C:gcc CXX:g++ Fortran:gfortran)
    string(REGEX REPLACE ":.*" "" name ${language})
    string(REGEX REPLACE ".*:" "" program ${language})
    find_program(MINGW_${name} NAMES ${target}-${program}-posix ${target}-${program})
    if(MINGW_${name})
        set(CMAKE_${name}_COMPILER ${MINGW_${name}})
    endif()
endforeach()
# FindOpenMP would take the import library, by its full name.
if(MINGW_CXX AND NOT OpenMP_gomp_LIBRARY)
    execute_process(COMMAND ${MINGW_CXX} -print-file-name=libgomp.a OUTPUT_VARIABLE gomp OUTPUT_STRIP_TRAILING_WHITESPACE)
    set(OpenMP_gomp_LIBRARY ${gomp} CACHE FILEPATH "OpenMP's library, static")
endif()
find_program(WINE NAMES wine64 wine PATHS /usr/lib/wine)
if(WINE)
    set(CMAKE_CROSSCOMPILING_EMULATOR ${WINE})
endif()

set(CMAKE_FIND_ROOT_PATH /usr/${target})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
set(CMAKE_SHARED_LINKER_FLAGS_INIT -static)
