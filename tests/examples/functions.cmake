example_folder(functions)

# Each checks its own results.
file(GLOB names RELATIVE ${PROJECT_SOURCE_DIR}/examples/functions CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/examples/functions/*.c)
foreach(name IN LISTS names)
    string(REPLACE ".c" "" name ${name})
    example_test(functions.${name} functions function_${name} --)
endforeach()

# Every function that the library exports is shown by one of them.
add_test(NAME examples.functions.show_every_function COMMAND sh -c
    "for f in $(sed -n 's/^ *\\(hol_[a-z_0-9]*\\);.*/\\1/p' capi/holonomic.map); do grep -qw \"$f\" examples/functions/*.c || { echo \"no example of $f\"; missing=1; }; done; test -z \"$missing\"")
set_tests_properties(examples.functions.show_every_function PROPERTIES WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
