# Debian packages by CPack: scripts/package configures for the prefix /usr and runs `cpack -G DEB`.
#
#   libholonomic0        both shared libraries
#   libholonomic-dev     header, static libraries, pkg-config, CMake package, Fortran modules and their sources
#   holonomic-examples   the programs of examples/
#   python3-holonomic    the Python package

install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/holonomic-examples/examples
    COMPONENT examples EXCLUDE_FROM_ALL)
install(DIRECTORY python/holonomic DESTINATION lib/python3/dist-packages
    COMPONENT python EXCLUDE_FROM_ALL FILES_MATCHING PATTERN "*.py" PATTERN py.typed PATTERN __pycache__ EXCLUDE)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The holonomic authors <holonomic@example.org>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL libraries development examples python)
set(CPACK_STRIP_FILES ON)
# A package's folders and files must not depend on the umask of whoever made it.
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "exact constraint forces of rigid bonds for molecular dynamics")
set(what "Lagrange multipliers and constraint forces of molecules of rigid bonds, to
the rounding of the coordinates, in time linear in the number of bonds. For
molecular and Brownian dynamics codes in C, C++, Fortran and Python.")

# describe(COMPONENT PACKAGE SECTION TEXT)
function(describe component package section text)
    string(TOUPPER ${component} key)
    set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${package} PARENT_SCOPE)
    set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
    set(CPACK_DEBIAN_${key}_DESCRIPTION "${what}\n.\n${text}" PARENT_SCOPE)
endfunction()
describe(libraries libholonomic${HOLONOMIC_SOVERSION} libs "This package has the shared libraries.")
describe(development libholonomic-dev libdevel
    "This package has the C header, the Fortran modules and their sources, static\nlibraries, and files for pkg-config and CMake.")
describe(examples holonomic-examples doc "This package has example programs in C and Fortran.")
describe(python python3-holonomic python "This package has the module for Python 3, and a constraint for ASE.")

set(same_version "libholonomic${HOLONOMIC_SOVERSION} (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_LIBRARIES_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${same_version}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "pkgconf | pkg-config")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "holonomic-examples, cmake, gfortran")
set(CPACK_DEBIAN_EXAMPLES_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_EXAMPLES_PACKAGE_SUGGESTS "libholonomic-dev")
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3:any (>= 3.8), python3-numpy, libholonomic${HOLONOMIC_SOVERSION} (>= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-ase")
# What Python keeps compiled comes and goes with the package.
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/python/postinst
    ${PROJECT_SOURCE_DIR}/cmake/debian/python/prerm)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
set(CPACK_DEBIAN_LIBRARIES_PACKAGE_MULTIARCH same)

# The symbols file says since which release a program needs each function: the nodes of the version script say so.
file(STRINGS capi/holonomic.map map_lines)
set(symbols "libholonomic.so.${HOLONOMIC_SOVERSION} libholonomic${HOLONOMIC_SOVERSION} #MINVER#")
foreach(line IN LISTS map_lines)
    if(line MATCHES "^HOLONOMIC_([0-9.]+)")
        set(release ${CMAKE_MATCH_1})
        list(APPEND symbol_lines " HOLONOMIC_${release}@HOLONOMIC_${release} ${release}.0")
    elseif(line MATCHES "^ *(hol_[a-z_0-9]+);")
        list(APPEND symbol_lines " ${CMAKE_MATCH_1}@HOLONOMIC_${release} ${release}.0")
    endif()
endforeach()
list(SORT symbol_lines)
string(REPLACE ";" "\n" symbol_lines "${symbol_lines}")
string(REPLACE " #MINVER#" "" symbols "${symbols}")
file(WRITE ${PROJECT_BINARY_DIR}/debian/symbols "${symbols} #MINVER#\n${symbol_lines}\n")
file(WRITE ${PROJECT_BINARY_DIR}/debian/shlibs "")
foreach(library holonomic holonomic_fortran)
    file(APPEND ${PROJECT_BINARY_DIR}/debian/shlibs
        "lib${library} ${HOLONOMIC_SOVERSION} libholonomic${HOLONOMIC_SOVERSION} (>= ${PROJECT_VERSION})\n")
endforeach()
file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARIES_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/symbols
    ${PROJECT_BINARY_DIR}/debian/shlibs ${PROJECT_BINARY_DIR}/debian/triggers)

# What every Debian package has in its folder of documents.
find_program(GZIP gzip)
configure_file(cmake/debian/changelog.in debian/changelog @ONLY)
if(GZIP)
    execute_process(COMMAND ${GZIP} -9nc ${PROJECT_BINARY_DIR}/debian/changelog
        OUTPUT_FILE ${PROJECT_BINARY_DIR}/debian/changelog.gz)
endif()
foreach(component libraries development examples python)
    string(TOUPPER ${component} key)
    set(documents ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${key}_PACKAGE_NAME})
    install(FILES cmake/debian/copyright DESTINATION ${documents} COMPONENT ${component} EXCLUDE_FROM_ALL)
    if(GZIP)
        install(FILES ${PROJECT_BINARY_DIR}/debian/changelog.gz DESTINATION ${documents} COMPONENT ${component}
            EXCLUDE_FROM_ALL)
    endif()
    set(overrides cmake/debian/${CPACK_DEBIAN_${key}_PACKAGE_NAME}.lintian-overrides)
    if(EXISTS ${PROJECT_SOURCE_DIR}/${overrides})
        install(FILES ${overrides} DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
            RENAME ${CPACK_DEBIAN_${key}_PACKAGE_NAME} COMPONENT ${component} EXCLUDE_FROM_ALL)
    endif()
endforeach()

include(CPack)
