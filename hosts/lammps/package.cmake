# SPDX-License-Identifier: GPL-2.0-only
# Installing the fix, and a Debian package of it: scripts/package configures for the prefix /usr and runs `cpack -G DEB`.
include(GNUInstallDirs)
set(private ${CMAKE_INSTALL_LIBDIR}/holonomic)
install(TARGETS lmp_holonomic RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS holonomic_preload LIBRARY DESTINATION ${private})

option(HOLONOMIC_PACKAGE_DEB "Let cpack make a Debian package" OFF)
if(NOT HOLONOMIC_PACKAGE_DEB)
    return()
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME holonomic-lammps)
set(CPACK_PACKAGE_VERSION ${holonomic_VERSION})
set(CPACK_PACKAGE_CONTACT "The holonomic authors <holonomic@example.org>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "rigid bonds of molecules of any shape in LAMMPS")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "Fix holonomic: exact constraint forces on any number of ranks. This package
has lmp-holonomic, which takes the arguments of lmp, and holonomic-preload.so,
which gives the fix to lmp itself by LD_PRELOAD.")
# The library's package is not installed where this one is made; all else is asked of the files.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
get_target_property(library holonomic::holonomic IMPORTED_LOCATION_RELEASE)
get_filename_component(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${library} DIRECTORY)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libholonomic0 (>= ${holonomic_VERSION})")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "lammps")

set(documents ${CMAKE_INSTALL_DATADIR}/doc/holonomic-lammps)
install(FILES debian/copyright README.md DESTINATION ${documents})
install(DIRECTORY examples DESTINATION ${documents})
install(FILES debian/holonomic-lammps.lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
    RENAME holonomic-lammps)
set(PROJECT_VERSION ${holonomic_VERSION})
configure_file(../../cmake/debian/changelog.in changelog @ONLY)
find_program(GZIP gzip)
if(GZIP)
    execute_process(COMMAND ${GZIP} -9nc ${PROJECT_BINARY_DIR}/changelog OUTPUT_FILE ${PROJECT_BINARY_DIR}/changelog.gz)
    install(FILES ${PROJECT_BINARY_DIR}/changelog.gz DESTINATION ${documents})
endif()
include(CPack)
