/* An output's view where an input is wanted: INPUT(&view). */
#ifndef TESTS_INPUT_H
#define TESTS_INPUT_H

#include <holonomic.h>

#define INPUT(view) ((const hol_const_view[]){hol_view_read(view)})

#endif
