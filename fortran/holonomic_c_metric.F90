! The part of the C interface about the metric determinant, the inverse, tridiagonal algebra, mass points and partition functions; use
! the module holonomic_c, which has all parts.
module holonomic_c_metric
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_ptr
   implicit none
   public
   private :: c_double, c_int, c_int64_t, c_ptr

   ! hol_scaling
   integer(c_int), parameter :: HOL_UNIT_DIAGONAL = 0
   integer(c_int), parameter :: HOL_PHYSICAL = 1

   interface

#define NAME hol_metric
#define TWIN hol_metric_view
#define ARGUMENTS chains, r, kT, log_det, log_det_z, energy, force, mode
#define POINTERS chains, r, log_det, log_det_z, energy, force
#define OPTIONS mode
#define REALS kT
#include "c_function.inc"

      ! -------------------------------------------------------------------------------------------- inverse of Z

      function hol_inverse_create(chains, molecule, r, inverse) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: molecule
         type(c_ptr), value :: r
         type(c_ptr), intent(out) :: inverse
         integer(c_int) :: status
      end function

      function hol_inverse_create_view(chains, molecule, r, inverse) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: molecule
         type(c_ptr), value :: r
         type(c_ptr), intent(out) :: inverse
         integer(c_int) :: status
      end function

      subroutine hol_inverse_destroy(inverse) bind(c)
         import :: c_ptr
         type(c_ptr), value :: inverse
      end subroutine

      pure function hol_inverse_n_bonds(inverse) bind(c) result(n)
         import :: c_int64_t, c_ptr
         type(c_ptr), value :: inverse
         integer(c_int64_t) :: n
      end function

      function hol_inverse_entry(inverse, scaling, i, j, value) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: inverse
         integer(c_int), value :: scaling
         integer(c_int64_t), value :: i, j
         type(c_ptr), value :: value
         integer(c_int) :: status
      end function

      function hol_inverse_row(inverse, scaling, i, row) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: inverse
         integer(c_int), value :: scaling
         integer(c_int64_t), value :: i
         type(c_ptr), value :: row
         integer(c_int) :: status
      end function

      function hol_inverse_band(inverse, scaling, width, band) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: inverse
         integer(c_int), value :: scaling
         integer(c_int64_t), value :: width
         type(c_ptr), value :: band
         integer(c_int) :: status
      end function

#define NAME hol_inverse_matrix
#define ARGUMENTS inverse, scaling, matrix
#define POINTERS inverse, matrix
#define OPTIONS scaling
#include "c_function.inc"
#define NAME hol_inverse_condition
#define POINTERS inverse, condition
#include "c_function.inc"
#define NAME hol_inverse_error_bound
#define TWIN hol_inverse_error_bound_view
#define POINTERS inverse, v, f, lambda, bound, relative
#include "c_function.inc"

      ! ------------------------------------------------------------------------------- the bare tridiagonal algebra

      function hol_tridiagonal_pivots(n, gamma, omega2) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         integer(c_int64_t), value :: n
         type(c_ptr), value :: gamma, omega2
         integer(c_int) :: status
      end function

      function hol_tridiagonal_log_det(n, gamma, log_det) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         integer(c_int64_t), value :: n
         type(c_ptr), value :: gamma, log_det
         integer(c_int) :: status
      end function

      function hol_tridiagonal_solve(n, gamma, b, x) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         integer(c_int64_t), value :: n
         type(c_ptr), value :: gamma, b, x
         integer(c_int) :: status
      end function

      function hol_tridiagonal_inverse_entry(n, gamma, i, j, value) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         integer(c_int64_t), value :: n
         type(c_ptr), value :: gamma
         integer(c_int64_t), value :: i, j
         type(c_ptr), value :: value
         integer(c_int) :: status
      end function

      function hol_tridiagonal_inverse_band(n, gamma, width, band) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         integer(c_int64_t), value :: n
         type(c_ptr), value :: gamma
         integer(c_int64_t), value :: width
         type(c_ptr), value :: band
         integer(c_int) :: status
      end function

      ! ------------------------------------------------------------------------------------------ equimomental points

      function hol_equimomental_points(mass, centre, inertia, n_points, masses, places) bind(c) result(status)
         import :: c_double, c_int, c_ptr
         real(c_double), value :: mass
         type(c_ptr), value :: centre, inertia, n_points, masses, places
         integer(c_int) :: status
      end function

      ! ----------------------------------------------------------------------------------------- partition functions

      function hol_partition_function(n_bonds, masses, log_he, log_rigid, log_volume) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         integer(c_int64_t), value :: n_bonds
         type(c_ptr), value :: masses, log_he, log_rigid, log_volume
         integer(c_int) :: status
      end function

   end interface

end module
