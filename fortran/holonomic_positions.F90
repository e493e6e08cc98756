! Position level: hol_project_positions with arrays of any layout.
module holonomic_positions
   use, intrinsic :: iso_c_binding, only: c_ptr
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_project_positions_view, hol_report
   use holonomic_place, only: flag_of, list_of, place, report_at, tensor
   use holonomic_status, only: failure, settle
   use holonomic_velocities, only: chain_set_velocities
   implicit none
   private
   public :: chain_set_positions

   type, extends(chain_set_velocities) :: chain_set_positions
   contains
      procedure, private :: positions_rows_32, positions_rows_64, positions_parts_32, positions_parts_64
      procedure, private :: positions_rows_32_short, positions_parts_32_short   ! dt of single precision, too
      generic :: project_positions => positions_rows_32, positions_rows_64, positions_parts_32, positions_parts_64, &
         positions_rows_32_short, positions_parts_32_short
   end type

contains

#define ROWS 32
#define TIME real64
#define PROJECT positions_rows_32
#include "positions.inc"
#define ROWS 64
#define TIME real64
#define PROJECT positions_rows_64
#include "positions.inc"
#define PARTS 32
#define TIME real64
#define PROJECT positions_parts_32
#include "positions.inc"
#define PARTS 64
#define TIME real64
#define PROJECT positions_parts_64
#include "positions.inc"
#define ROWS 32
#define TIME real32
#define PROJECT positions_rows_32_short
#include "positions.inc"
#define PARTS 32
#define TIME real32
#define PROJECT positions_parts_32_short
#include "positions.inc"

end module
