! The C interface of the library (holonomic.h), declared for Fortran and nothing more: same names, same arguments, C's
! conventions. What each function does is said in the header. Ordinary programs want the module `holonomic`.
module holonomic_c
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_int32_t, c_int64_t, c_null_ptr, c_ptr
   use holonomic_c_factors
   use holonomic_c_given
   use holonomic_c_metric
   use holonomic_c_molecules
   implicit none
   public
   private :: c_char, c_double, c_int, c_int32_t, c_int64_t, c_null_ptr, c_ptr

   ! hol_status
   integer(c_int), parameter :: HOL_OK = 0
   integer(c_int), parameter :: HOL_ERR_NULL = 1
   integer(c_int), parameter :: HOL_ERR_VALUE = 2
   integer(c_int), parameter :: HOL_ERR_INDEX = 3
   integer(c_int), parameter :: HOL_ERR_SHARED_ATOM = 4
   integer(c_int), parameter :: HOL_ERR_MEMORY = 5
   integer(c_int), parameter :: HOL_ERR_NOT_FINITE = 6
   integer(c_int), parameter :: HOL_ERR_DEGENERATE = 7
   integer(c_int), parameter :: HOL_ERR_NO_CONVERGENCE = 8
   integer(c_int), parameter :: HOL_ERR_NOT_DEFINITE = 9
   integer(c_int), parameter :: HOL_ERR_INTERNAL = 10
   integer(c_int), parameter :: HOL_ERR_LENGTHS = 11
   integer(c_int), parameter :: HOL_ERR_UNSUPPORTED = 12
   integer(c_int), parameter :: HOL_ERR_STATE = 13
   integer(c_int), parameter :: HOL_ERR_CALLBACK = 14

   ! hol_when
   integer(c_int), parameter :: HOL_NEVER = 0
   integer(c_int), parameter :: HOL_AT_START = 1
   integer(c_int), parameter :: HOL_ALWAYS = 2

   ! hol_element
   integer(c_int32_t), parameter :: HOL_DOUBLE = 0
   integer(c_int32_t), parameter :: HOL_FLOAT = 1

   ! hol_mode
   integer(c_int), parameter :: HOL_WRITE = 0
   integer(c_int), parameter :: HOL_ADD = 1

   ! hol_which_box
   integer(c_int), parameter :: HOL_BOX = 0
   integer(c_int), parameter :: HOL_REFERENCE_BOX = 1

   type, bind(c) :: hol_view
      type(c_ptr) :: x = c_null_ptr
      type(c_ptr) :: y = c_null_ptr
      type(c_ptr) :: z = c_null_ptr
      integer(c_int64_t) :: stride = 0
      integer(c_int32_t) :: element = HOL_DOUBLE
      integer(c_int32_t) :: reserved = 0
   end type

   type, bind(c) :: hol_report
      integer(c_int64_t) :: iterations = 0
      integer(c_int64_t) :: n_corrected = 0
      integer(c_int64_t) :: n_failed = 0
      integer(c_int64_t) :: molecule = 0
      integer(c_int64_t) :: bond = 0
      real(c_double) :: max_error = 0
   end type

   type, bind(c) :: hol_worst
      real(c_double) :: length = 0
      integer(c_int64_t) :: length_molecule = 0
      integer(c_int64_t) :: length_bond = 0
      real(c_double) :: rate = 0
      integer(c_int64_t) :: rate_molecule = 0
      integer(c_int64_t) :: rate_bond = 0
   end type

   ! Arguments that may be NULL are `type(c_ptr), value`: C_LOC of what is there, or C_NULL_PTR.
   interface

      ! ---------------------------------------------------------------------------------------- status and errors

      function hol_version() bind(c) result(text)
         import :: c_ptr
         type(c_ptr) :: text
      end function

      function hol_version_number() bind(c) result(number)
         import :: c_int
         integer(c_int) :: number
      end function

      function hol_status_name(status) bind(c) result(text)
         import :: c_int, c_ptr
         integer(c_int), value :: status
         type(c_ptr) :: text
      end function

      function hol_error_message() bind(c) result(text)
         import :: c_ptr
         type(c_ptr) :: text
      end function

      function hol_error_remember(status, message) bind(c) result(same)
         import :: c_char, c_int
         integer(c_int), value :: status
         character(kind=c_char), intent(in) :: message(*)
         integer(c_int) :: same
      end function

      subroutine hol_error_location(molecule, bond, atom, n_bad) bind(c)
         import :: c_ptr
         type(c_ptr), value :: molecule, bond, atom, n_bad
      end subroutine

      function hol_instruction_set() bind(c) result(text)
         import :: c_ptr
         type(c_ptr) :: text
      end function

      ! ------------------------------------------------------------------------------------------- the three levels

#define NAME hol_forces
#define TWIN hol_forces_view
#define ARGUMENTS chains, r, v, f, lambda, tension, g, mode, virial
#define POINTERS chains, r, v, f, lambda, tension, g, virial
#define OPTIONS mode
#include "c_function.inc"
#define NAME hol_solve
#define TWIN hol_solve_view
#define ARGUMENTS chains, r, rhs, lambda, g, mode, virial
#define POINTERS chains, r, rhs, lambda, g, virial
#define OPTIONS mode
#include "c_function.inc"
#define NAME hol_reactions
#define TWIN hol_reactions_view
#define ARGUMENTS chains, r, box, lambda, tension, g, mode, bond_virial, virial
#define POINTERS chains, r, lambda, tension, g, bond_virial, virial
#define OPTIONS box, mode
#include "c_function.inc"
#define NAME hol_project_velocities
#define TWIN hol_project_velocities_view
#define POINTERS chains, r, v, lambda, virial
#include "c_function.inc"
#define NAME hol_project_positions
#define TWIN hol_project_positions_view
#define ARGUMENTS chains, r_ref, r, v, dt, lambda, guess, virial, report
#define POINTERS chains, r_ref, r, v, lambda, virial, report
#define OPTIONS guess
#define REALS dt
#include "c_function.inc"
#define NAME hol_project_positions_along
#define TWIN hol_project_positions_along_view
#define ARGUMENTS chains, b, r, v, dt, lambda, guess, virial, report
#define POINTERS chains, b, r, v, lambda, virial, report
#define OPTIONS guess
#define REALS dt
#include "c_function.inc"
#define NAME hol_reference_error
#define POINTERS chains, error, molecule, bond
#include "c_function.inc"
#define NAME hol_violation
#define TWIN hol_violation_view
#define POINTERS chains, r, v, worst
#include "c_function.inc"
#define NAME hol_residuals
#define TWIN hol_residuals_view
#define POINTERS chains, r, v, length, rate
#include "c_function.inc"
#define NAME hol_impose
#define TWIN hol_impose_view
#define POINTERS chains, r, report
#include "c_function.inc"

   end interface

end module
