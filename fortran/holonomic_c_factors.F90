! The part of the C interface about factors that are kept; use the module holonomic_c, which has all parts.
module holonomic_c_factors
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_ptr
   implicit none
   public
   private :: c_double, c_int, c_int64_t, c_ptr

   interface

      function hol_factors_create(chains, factors) bind(c) result(status)
         import :: c_int, c_ptr
         type(c_ptr), value :: chains
         type(c_ptr), intent(out) :: factors
         integer(c_int) :: status
      end function

      subroutine hol_factors_destroy(factors) bind(c)
         import :: c_ptr
         type(c_ptr), value :: factors
      end subroutine

#define NAME hol_factors_update
#define TWIN hol_factors_update_view
#define POINTERS factors, r
#include "c_function.inc"
#define NAME hol_factors_forces
#define TWIN hol_factors_forces_view
#define ARGUMENTS factors, v, f, lambda, tension, g, mode, virial
#define POINTERS factors, v, f, lambda, tension, g, virial
#define OPTIONS mode
#include "c_function.inc"

      function hol_factors_solve(factors, n_rhs, rhs, lambda, g, mode, virial) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: factors
         integer(c_int64_t), value :: n_rhs
         type(c_ptr), value :: rhs, lambda, g
         integer(c_int), value :: mode
         type(c_ptr), value :: virial
         integer(c_int) :: status
      end function

      function hol_factors_solve_view(factors, n_rhs, rhs, lambda, g, mode, virial) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: factors
         integer(c_int64_t), value :: n_rhs
         type(c_ptr), value :: rhs, lambda, g
         integer(c_int), value :: mode
         type(c_ptr), value :: virial
         integer(c_int) :: status
      end function

   end interface

end module
