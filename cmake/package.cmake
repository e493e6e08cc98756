# How an installed library is found: pkg-config files and a CMake package.

include(CMakePackageConfigHelpers)
include(private_libraries)

set(cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/holonomic)
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# ------------------------------------------------------------------------------------------------------------ files
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT licence)

include(pages)
include(manual)

install(EXPORT holonomic-targets NAMESPACE holonomic:: DESTINATION ${cmake_dir} COMPONENT development)
if(HOLONOMIC_BUILD_FORTRAN)
    install(EXPORT holonomic-fortran-targets NAMESPACE holonomic:: DESTINATION ${cmake_dir} COMPONENT development)
endif()

# ---------------------------------------------------------------------------------------------------- static linking
holonomic_private_libraries(private_names private_flags)
if(TARGET holonomic_static)
    # By name, so that projects in C or Fortran alone need not enable C++ to link it.
    target_link_libraries(holonomic_static INTERFACE "$<INSTALL_INTERFACE:${private_names}>")
endif()
if(BUILD_SHARED_LIBS)
    set(PC_LIBS)
    set(PC_LIBS_PRIVATE " ${private_flags}")
else()
    # There is nothing but the static library, so that whoever links it needs them.
    set(PC_LIBS " ${private_flags}")
    set(PC_LIBS_PRIVATE)
endif()

# In a program that is static throughout, libgfortran calls those thread functions of which it finds any, and has only
# weak references to them: once OpenMP's library brings some in, all must be there, or the program crashes as it ends.
# (gfortran -static -fopenmp has this defect on its own.)
set(PC_FORTRAN_LIBS_PRIVATE)
if(HOLONOMIC_BUILD_FORTRAN AND OpenMP_CXX_FOUND AND CMAKE_Fortran_COMPILER_ID STREQUAL "GNU" AND NOT APPLE)
    foreach(name IN ITEMS create join self cond_broadcast cond_destroy cond_init cond_wait getspecific setspecific
            key_create key_delete mutex_destroy mutex_init mutex_lock mutex_trylock mutex_unlock)
        string(APPEND PC_FORTRAN_LIBS_PRIVATE " -Wl,-u,pthread_${name}")
    endforeach()
endif()

# -------------------------------------------------------------------------------------------------------- pkg-config
# A folder for a .pc file: below its prefix if it is, so that an installed tree may be moved.
function(pkgconfig_folder out folder)
    if(IS_ABSOLUTE "${folder}")
        set(${out} "${folder}" PARENT_SCOPE)
    else()
        set(${out} "\${prefix}/${folder}" PARENT_SCOPE)
    endif()
endfunction()

get_filename_component(full_pkgconfig_dir ${pkgconfig_dir} ABSOLUTE BASE_DIR ${CMAKE_INSTALL_PREFIX})
file(RELATIVE_PATH PC_UP ${full_pkgconfig_dir} ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" PC_UP "${PC_UP}")
pkgconfig_folder(PC_LIBDIR "${CMAKE_INSTALL_LIBDIR}")
pkgconfig_folder(PC_INCLUDEDIR "${CMAKE_INSTALL_INCLUDEDIR}")
pkgconfig_folder(PC_FSRCDIR "${HOLONOMIC_FORTRAN_SOURCE_DIR}")
set(pc_files holonomic)
set(PC_FMODDIR_LINE)
if(HOLONOMIC_BUILD_FORTRAN)
    list(APPEND pc_files holonomic-fortran)
    pkgconfig_folder(PC_FMODDIR "${HOLONOMIC_FORTRAN_MODULE_DIR}")
    set(PC_FMODDIR_LINE "\nfmoddir=${PC_FMODDIR}")
endif()

# The loader finds a library below /usr by itself. From any other prefix a program needs to be told where its library is:
# most have never been heard of by the loader, and it hears of /usr/local only by ldconfig, on some systems never. Which
# prefix it is turns out when the library is installed, so that there are two sets of files to choose from.
set(PC_RPATH)
foreach(name IN LISTS pc_files)
    configure_file(cmake/${name}.pc.in pkgconfig/found_by_the_loader/${name}.pc @ONLY)
endforeach()
if(BUILD_SHARED_LIBS)
    set(PC_RPATH " -Wl,-rpath,\${libdir}")
endif()
foreach(name IN LISTS pc_files)
    configure_file(cmake/${name}.pc.in pkgconfig/elsewhere/${name}.pc @ONLY)
endforeach()
set(full_pkgconfig ${pkgconfig_dir})
if(NOT IS_ABSOLUTE ${pkgconfig_dir})
    set(full_pkgconfig "\${CMAKE_INSTALL_PREFIX}/${pkgconfig_dir}")
endif()
install(CODE "
    set(kind elsewhere)
    if(CMAKE_INSTALL_PREFIX MATCHES \"^/*(usr)?/*$\")
        set(kind found_by_the_loader)
    endif()
    foreach(name IN ITEMS ${pc_files})
        file(INSTALL DESTINATION \"${full_pkgconfig}\" TYPE FILE FILES
            \"${CMAKE_CURRENT_BINARY_DIR}/pkgconfig/\${kind}/\${name}.pc\")
    endforeach()" COMPONENT development)

# ----------------------------------------------------------------------------------------------------- CMake package
configure_package_config_file(cmake/holonomic-config.cmake.in holonomic-config.cmake
    INSTALL_DESTINATION ${cmake_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(holonomic-config-version.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/holonomic-config.cmake
    ${CMAKE_CURRENT_BINARY_DIR}/holonomic-config-version.cmake DESTINATION ${cmake_dir} COMPONENT development)
