example_folder(c)

# --------------------------------------------------------------------------------------------------------- shortest
example_test(shortest c shortest --
    "tensions:" 1 = 30
    "tensions:" 2 = 20
    "tensions:" 3 = 10)
add_test(NAME examples.shortest_is_short COMMAND sh -c "test $(wc -l < \"$1\") -le 20" sh
    ${PROJECT_SOURCE_DIR}/examples/c/shortest.c)

# The same by holonomic.hpp, in ten lines beside those that include.
example_test(shortest_cpp c shortest_cpp --
    "tensions:" 1 = 30
    "tensions:" 2 = 20
    "tensions:" 3 = 10)
add_test(NAME examples.shortest_cpp_is_short COMMAND sh -c "test $(grep -c -v -e '^#' -e '^$' \"$1\") -le 10" sh
    ${PROJECT_SOURCE_DIR}/examples/c/shortest.cpp)

# --------------------------------------------------------------------------------------------------------- tensions
example_test(tensions c tensions ${PROJECT_SOURCE_DIR}/examples/c/rotor.txt --
    "     0" 1 = 1
    "     0" 2 = 35
    "     1" 2 = 34
    "     2" 2 = 30
    "     3" 2 = 21
    "constraint virial:" 1 = -120)
example_refuses(tensions.refuses_a_missing_file c "tensions: nowhere.txt: cannot be opened" tensions nowhere.txt)
example_refuses(tensions.refuses_no_file c "usage: tensions FILE" tensions)
# tensions_refuses(NAME MESSAGE LINE ...): a file of these lines
function(tensions_refuses name message)
    set(file ${CMAKE_CURRENT_BINARY_DIR}/${name}.txt)
    string(REPLACE ";" "\n" text "${ARGN}")
    file(WRITE ${file} "${text}\n")
    example_refuses(tensions.refuses_${name} c "${message}" tensions ${file})
endfunction()
tensions_refuses(one_atom "at least two atoms" "1 0 0 0 0 0 0 0 0 0")
tensions_refuses(too_few_numbers "line 2: expected ten numbers" "1 0 0 0 0 0 0 0 0 0" "1 0 0 1 0 0 0")
tensions_refuses(too_many_numbers "line 1: more than ten numbers" "1 0 0 0 0 0 0 0 0 0 1" "1 0 0 1 0 0 0 0 0 0")
tensions_refuses(a_word "line 2: this is not a number" "# two atoms" "1 0 0 zero 0 0 0 0 0 0")
tensions_refuses(a_negative_mass "[Aa]tom 1" "1 0 0 0 0 0 0 0 0 0" "-1 0 0 1 0 0 0 0 0 0")
tensions_refuses(a_bond_of_length_zero "bond 0" "1 0 0 0 0 0 0 0 0 0" "1 0 0 0 0 0 0 0 0 0")
tensions_refuses(a_number_that_is_not_finite "molecule 0" "1 0 0 0 0 0 0 0 0 0" "1 0 0 1 0 0 nan 0 0 0")

# With the Makefile, as by hand.
add_test(NAME examples.c.makefile COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/make_with_pkg_config.sh
    ${prefix} ${PROJECT_SOURCE_DIR}/examples/c ${CMAKE_CURRENT_BINARY_DIR}/c_makefile)
set_tests_properties(examples.c.makefile PROPERTIES FIXTURES_REQUIRED installed ENVIRONMENT "CC=${CMAKE_C_COMPILER}")
