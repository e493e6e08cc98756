# The Python package: target holonomic_wheel leaves a wheel with the library in the folder `python` of the build tree.
# Its library needs of a system the C library alone: the C++ library is inside, OpenMP's lies beside it.

if(NOT BUILD_SHARED_LIBS OR CMAKE_CROSSCOMPILING OR NOT UNIX OR APPLE OR CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    return()
endif()
include(find_python)
if(NOT HOLONOMIC_PYTHON)
    return()
endif()

add_library(holonomic_wheel_library SHARED EXCLUDE_FROM_ALL ${HOLONOMIC_CORE_OBJECTS} $<TARGET_OBJECTS:holonomic_capi>)
set(map ${PROJECT_SOURCE_DIR}/capi/holonomic.map)
set_target_properties(holonomic_wheel_library PROPERTIES OUTPUT_NAME holonomic LINKER_LANGUAGE CXX
    VERSION ${PROJECT_VERSION} SOVERSION ${HOLONOMIC_SOVERSION} LINK_DEPENDS ${map}
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/python/library BUILD_RPATH "$ORIGIN")
target_link_options(holonomic_wheel_library PRIVATE -Wl,--version-script=${map} -Wl,-z,nodelete -Wl,--no-undefined -s
    -static-libstdc++ -static-libgcc)
set(beside)
if(OpenMP_CXX_FOUND)
    target_link_libraries(holonomic_wheel_library PRIVATE OpenMP::OpenMP_CXX)
    foreach(library IN LISTS OpenMP_CXX_LIB_NAMES)
        if(library MATCHES "omp" AND OpenMP_${library}_LIBRARY MATCHES "\\.so")
            list(APPEND beside ${OpenMP_${library}_LIBRARY})
        endif()
    endforeach()
endif()
add_custom_target(holonomic_wheel
    COMMAND ${HOLONOMIC_PYTHON} ${PROJECT_SOURCE_DIR}/python/build_wheel.py ${PROJECT_BINARY_DIR}/python
        $<TARGET_FILE:holonomic_wheel_library> ${beside}
    DEPENDS holonomic_wheel_library)
