# Installing the plugin, and a Debian package of it: scripts/package configures for the prefix /usr and runs `cpack -G DEB`.
include(GNUInstallDirs)
set(python share/holonomic-openmm)
option(HOLONOMIC_PACKAGE_DEB "Let cpack make a Debian package" OFF)
if(HOLONOMIC_PACKAGE_DEB)
    set(python lib/python3/dist-packages)
endif()
install(TARGETS openmm_holonomic DESTINATION ${CMAKE_INSTALL_LIBDIR}/openmm/plugins)
foreach(platform opencl cuda hip)
    if(TARGET openmm_holonomic_${platform})
        install(TARGETS openmm_holonomic_${platform} DESTINATION ${CMAKE_INSTALL_LIBDIR}/openmm/plugins)
    endif()
endforeach()
install(FILES HolonomicConstraints.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES holonomic_openmm.py DESTINATION ${python})
if(NOT HOLONOMIC_PACKAGE_DEB)
    return()
endif()

set(package holonomic-openmm)
if(TARGET openmm_holonomic_opencl) # the platform's own library is in the same folder
    set_target_properties(openmm_holonomic_opencl PROPERTIES INSTALL_RPATH "$ORIGIN")
endif()
set(summary "constraints of OpenMM to the rounding, of any shape")
set(description "Plugin for the platforms CPU, Reference and OpenCL of OpenMM: it takes the
place of SETTLE and CCMA for Systems to which its Force was added. With a
module for Python, holonomic_openmm, and a header for C++.")
set(depends "python3:any (>= 3.8)")
set(recommends "libopenmm-plugins, python3-simtk")
include(${CMAKE_CURRENT_LIST_DIR}/../../cmake/host_package.cmake)
# What Python keeps compiled goes with the package.
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_SOURCE_DIR}/debian/postinst ${CMAKE_CURRENT_SOURCE_DIR}/debian/prerm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)

install(FILES ../../cmake/debian/copyright README.md DESTINATION ${documents})
install(FILES examples/peptide.py examples/beside.py DESTINATION ${documents}/examples)
include(CPack)
