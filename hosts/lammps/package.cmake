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
set(package holonomic-lammps)
set(summary "rigid bonds of molecules of any shape in LAMMPS")
set(description "Fix holonomic: exact constraint forces on any number of ranks. This package
has lmp-holonomic, which takes the arguments of lmp, and holonomic-preload.so,
which gives the fix to lmp itself by LD_PRELOAD.")
set(depends)
set(recommends lammps)
include(${CMAKE_CURRENT_LIST_DIR}/../../cmake/host_package.cmake)

install(FILES debian/copyright README.md DESTINATION ${documents})
install(DIRECTORY examples DESTINATION ${documents})
install(FILES debian/holonomic-lammps.lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
    RENAME holonomic-lammps)
include(CPack)
