! What is left of each constraint: hol_residuals with arrays of any layout.
module holonomic_residuals
   use, intrinsic :: iso_c_binding, only: c_ptr
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_residuals_view
   use holonomic_place, only: list_of, place
   use holonomic_status, only: failure, settle
   use holonomic_violation, only: chain_set_violation
   implicit none
   private
   public :: chain_set_residuals

   type, extends(chain_set_violation) :: chain_set_residuals
   contains
      procedure, private :: residuals_rows_32, residuals_rows_64, residuals_parts_32, residuals_parts_64
      generic :: residuals => residuals_rows_32, residuals_rows_64, residuals_parts_32, residuals_parts_64
   end type

contains

#define ROWS 32
#define RESIDUALS residuals_rows_32
#include "residuals.inc"
#define ROWS 64
#define RESIDUALS residuals_rows_64
#include "residuals.inc"
#define PARTS 32
#define RESIDUALS residuals_parts_32
#include "residuals.inc"
#define PARTS 64
#define RESIDUALS residuals_parts_64
#include "residuals.inc"

end module
