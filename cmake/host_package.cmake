# What the Debian packages of hosts have in common: scripts/package configures each for the prefix /usr and runs `cpack -G
# DEB`. Beforehand `package`, `summary`, `description`, `depends` and `recommends` say what is its own; afterwards it
# installs into ${documents} and includes CPack.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME ${package})
set(CPACK_PACKAGE_VERSION ${holonomic_VERSION})
set(CPACK_PACKAGE_CONTACT "The holonomic authors <holonomic@example.org>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${summary}")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "${description}")
# The library's package is not installed where this one is made; all else is asked of the files.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
get_target_property(library holonomic::holonomic IMPORTED_LOCATION_RELEASE)
get_filename_component(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${library} DIRECTORY)
list(APPEND depends "libholonomic0 (>= ${holonomic_VERSION})")
list(JOIN depends ", " CPACK_DEBIAN_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "${recommends}")

set(documents ${CMAKE_INSTALL_DATADIR}/doc/${package})
set(PROJECT_VERSION ${holonomic_VERSION})
configure_file(${CMAKE_CURRENT_LIST_DIR}/debian/changelog.in changelog @ONLY)
find_program(GZIP gzip)
if(GZIP)
    execute_process(COMMAND ${GZIP} -9nc ${PROJECT_BINARY_DIR}/changelog OUTPUT_FILE ${PROJECT_BINARY_DIR}/changelog.gz)
    install(FILES ${PROJECT_BINARY_DIR}/changelog.gz DESTINATION ${documents})
endif()
