# The manual: holonomic(3), and a page for each function and type of the header, written by awk.

set(pages ${PROJECT_BINARY_DIR}/man3)
file(REMOVE_RECURSE ${pages})
file(MAKE_DIRECTORY ${pages})
configure_file(docs/reference/holonomic.3.in ${pages}/holonomic.3 @ONLY)
find_program(AWK NAMES awk mawk gawk)
if(AWK)
    set(header ${PROJECT_SOURCE_DIR}/capi/holonomic.h)
    set(writer ${PROJECT_SOURCE_DIR}/docs/reference/manual.awk)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${header} ${writer})
    execute_process(COMMAND ${AWK} -v folder=${pages} -v version=${PROJECT_VERSION} -f ${writer} ${header} ${header}
        RESULT_VARIABLE failed)
    if(NOT "${failed}" STREQUAL "0")
        message(FATAL_ERROR "awk could not write the manual out of ${header}")
    endif()
endif()
find_program(GZIP gzip)
if(HOLONOMIC_PACKAGE_DEB AND GZIP) # as Debian has its manuals
    file(GLOB written ${pages}/*.3)
    execute_process(COMMAND ${GZIP} -9n ${written})
endif()
install(DIRECTORY ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT development)
