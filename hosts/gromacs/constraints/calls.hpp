// Which functions a loaded library calls by way of the dynamic linker. Ubuntu links libraries with
// -Bsymbolic-functions: their own functions are then called directly, and nothing that is loaded before can take their
// place.
#pragma once
#include <link.h>

#include <set>
#include <string>

namespace holonomic {

std::set<std::string> names_called_through_linker(const dl_phdr_info &library);

}  // namespace holonomic
