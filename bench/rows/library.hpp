/**
 * One copy of the library, loaded while the program runs: two builds of it side by side, each with its own state.
 */
#ifndef BENCH_ROWS_LIBRARY_HPP
#define BENCH_ROWS_LIBRARY_HPP

#include <holonomic.h>

#include <string>

namespace rows {

#define ROWS_FUNCTIONS(function)                                                                                       \
    function(hol_error_message) function(hol_instruction_set) function(hol_chains_create) function(hol_chains_destroy) \
        function(hol_chains_add) function(hol_chains_add_block) function(hol_chains_add_bonds)                         \
            function(hol_chains_add_molecules) function(hol_chains_set_box) function(hol_chains_set_tolerance)         \
                function(hol_chains_n_bonds) function(hol_forces) function(hol_forces_view)                            \
                    function(hol_project_velocities) function(hol_project_velocities_view)                             \
                        function(hol_project_positions) function(hol_project_positions_view) function(hol_metric)      \
                            function(hol_metric_view) function(hol_solve) function(hol_reactions)                      \
                                function(hol_violation)

/// Those that libraries before 0.3 do not have: nullptr there.
#define ROWS_LATER_FUNCTIONS(function)                                                      \
    function(hol_factors_create) function(hol_factors_destroy) function(hol_factors_update) \
        function(hol_factors_forces) function(hol_factors_solve)

/// The functions of the header by their names.
struct Library {
#define ROWS_DECLARE(name) decltype(&::name) name = nullptr;
    ROWS_FUNCTIONS(ROWS_DECLARE)
    ROWS_LATER_FUNCTIONS(ROWS_DECLARE)
#undef ROWS_DECLARE

    /// Two files with the same content must be two files: one that is loaded already is not loaded again.
    explicit Library(const std::string &file);
    /// Throws with the library's message unless the status is HOL_OK.
    void check(int status) const;
};

}  // namespace rows

#endif
