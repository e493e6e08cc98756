# A Python with numpy: HOLONOMIC_PYTHON, or empty if there is none.
#
#   python_has(RESULT MODULE)    whether it has a module, too

if(NOT HOLONOMIC_PYTHON)
    foreach(name python3 /usr/bin/python3)
        execute_process(COMMAND ${name} -c "import ctypes, numpy, sys; print(sys.executable)"
            RESULT_VARIABLE failed OUTPUT_VARIABLE found ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
        if("${failed}" STREQUAL "0" AND NOT HOLONOMIC_PYTHON)
            set(HOLONOMIC_PYTHON "${found}" CACHE FILEPATH "A Python with numpy, for the tests of the Python package")
        endif()
    endforeach()
endif()

function(python_has result module)
    execute_process(COMMAND ${HOLONOMIC_PYTHON} -c "import ${module}" RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
    if("${failed}" STREQUAL "0")
        set(${result} ON PARENT_SCOPE)
    else()
        set(${result} OFF PARENT_SCOPE)
    endif()
endfunction()
