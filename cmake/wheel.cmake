# The library for wheels: target holonomic_wheel leaves it in the folder python/libraries of the build tree, from which setup.py
# packs it. It needs of a system the C library and gcc's unwinder, which all have: the C++ library is inside, OpenMP's lies beside
# it. An unwinder inside, and what of the C++ library nobody calls, would want a younger C library than the rest does.

if(NOT BUILD_SHARED_LIBS OR NOT UNIX OR APPLE OR CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    return()
endif()

add_library(holonomic_wheel_library SHARED EXCLUDE_FROM_ALL ${HOLONOMIC_CORE_OBJECTS} $<TARGET_OBJECTS:holonomic_capi>)
set(map ${PROJECT_SOURCE_DIR}/capi/holonomic.map)
set_target_properties(holonomic_wheel_library PROPERTIES OUTPUT_NAME holonomic LINKER_LANGUAGE CXX
    VERSION ${PROJECT_VERSION} SOVERSION ${HOLONOMIC_SOVERSION} LINK_DEPENDS ${map}
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/python/linked BUILD_RPATH "$ORIGIN")
target_link_options(holonomic_wheel_library PRIVATE -Wl,--version-script=${map} -Wl,-z,nodelete -Wl,--no-undefined -s
    -static-libstdc++ -Wl,--gc-sections)
# Under the names by which the loader asks for them: a wheel has no links.
set(libraries ${PROJECT_BINARY_DIR}/python/libraries)
set(copies COMMAND ${CMAKE_COMMAND} -E copy $<TARGET_FILE:holonomic_wheel_library>
    ${libraries}/$<TARGET_SONAME_FILE_NAME:holonomic_wheel_library>)
if(OpenMP_CXX_FOUND)
    target_link_libraries(holonomic_wheel_library PRIVATE OpenMP::OpenMP_CXX)
    foreach(library IN LISTS OpenMP_CXX_LIB_NAMES)
        if(library MATCHES "omp" AND OpenMP_${library}_LIBRARY MATCHES "\\.so")
            get_filename_component(file ${OpenMP_${library}_LIBRARY} REALPATH)
            get_filename_component(name ${file} NAME)
            string(REGEX REPLACE "(\\.so\\.[0-9]+)[.0-9]*$" "\\1" name ${name})
            list(APPEND copies COMMAND ${CMAKE_COMMAND} -E copy ${file} ${libraries}/${name})
        endif()
    endforeach()
endif()
add_custom_target(holonomic_wheel COMMAND ${CMAKE_COMMAND} -E make_directory ${libraries} ${copies}
    DEPENDS holonomic_wheel_library)
