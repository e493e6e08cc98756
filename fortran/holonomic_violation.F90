! How far positions and velocities are from the constraints: hol_violation with arrays of any layout.
module holonomic_violation
   use, intrinsic :: iso_c_binding, only: c_loc
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_violation_view, hol_worst
   use holonomic_check, only: chain_set_check
   use holonomic_place, only: place
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_violation

   type, extends(chain_set_check) :: chain_set_violation
   contains
      procedure, private :: violation_rows_32, violation_rows_64, violation_parts_32, violation_parts_64
      generic :: violation => violation_rows_32, violation_rows_64, violation_parts_32, violation_parts_64
   end type

contains

#define ROWS 32
#define VIOLATION violation_rows_32
#include "violation.inc"
#define ROWS 64
#define VIOLATION violation_rows_64
#include "violation.inc"
#define PARTS 32
#define VIOLATION violation_parts_32
#include "violation.inc"
#define PARTS 64
#define VIOLATION violation_parts_64
#include "violation.inc"

end module
