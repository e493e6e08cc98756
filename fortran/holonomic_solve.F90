! Multipliers of given right-hand sides: hol_solve with arrays of any layout.
module holonomic_solve
   use, intrinsic :: iso_c_binding, only: c_ptr
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_solve_view
   use holonomic_forces, only: chain_set_forces
   use holonomic_place, only: list_of, mode_of, place, tensor
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_solve

   type, extends(chain_set_forces) :: chain_set_solve
   contains
      procedure, private :: solve_rows_32, solve_rows_64, solve_parts_32, solve_parts_64
      generic :: solve => solve_rows_32, solve_rows_64, solve_parts_32, solve_parts_64
   end type

contains

#define ROWS 32
#define SOLVE solve_rows_32
#include "solve.inc"
#define ROWS 64
#define SOLVE solve_rows_64
#include "solve.inc"
#define PARTS 32
#define SOLVE solve_parts_32
#include "solve.inc"
#define PARTS 64
#define SOLVE solve_parts_64
#include "solve.inc"

end module
