# Installing the objects and the wrapper, and a Debian package of them: scripts/package configures for the prefix /usr and runs
# `cpack -G DEB`.
include(GNUInstallDirs)
install(TARGETS holonomic_gromacs holonomic_gromacs_d LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/holonomic)
install(PROGRAMS gmx-holonomic DESTINATION ${CMAKE_INSTALL_BINDIR})

option(HOLONOMIC_PACKAGE_DEB "Let cpack make a Debian package" OFF)
if(NOT HOLONOMIC_PACKAGE_DEB)
    return()
endif()
set(package holonomic-gromacs)
set(summary "constraints of GROMACS to the rounding, of any shape")
set(description "The wrapper gmx-holonomic runs the gmx of this distribution, unmodified,
in mixed or double precision, with exact constraints in the place of LINCS.")
set(depends)
set(recommends gromacs)
include(${CMAKE_CURRENT_LIST_DIR}/../../cmake/host_package.cmake)

install(FILES ../../cmake/debian/copyright README.md DESTINATION ${documents})
install(FILES debian/holonomic-gromacs.lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
    RENAME holonomic-gromacs)
include(CPack)
