// The same as C++ sees the header.
#include "layout.c"
