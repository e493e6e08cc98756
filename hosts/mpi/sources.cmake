# For programs that build the library within their own tree: include this after find_package(holonomic).
set(subdomain ${CMAKE_CURRENT_LIST_DIR}/subdomain)
add_library(holonomic_subdomain STATIC ${subdomain}/capi.cpp ${subdomain}/graph.cpp ${subdomain}/linear.cpp ${subdomain}/positions.cpp
    ${subdomain}/sparse_factors.cpp ${subdomain}/subdomain.cpp)
set_target_properties(holonomic_subdomain PROPERTIES POSITION_INDEPENDENT_CODE ON)
target_include_directories(holonomic_subdomain PUBLIC ${CMAKE_CURRENT_LIST_DIR})
target_link_libraries(holonomic_subdomain PUBLIC holonomic::holonomic)
