! Positions compared with the lengths: hol_chains_check with arrays of any layout.
module holonomic_check
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_along, only: chain_set_along
   use holonomic_c, only: hol_chains_check_view
   use holonomic_place, only: box_of, place
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_check

   type, extends(chain_set_along) :: chain_set_check
   contains
      ! reference: r belongs to the box of set_reference_box.
      procedure, private :: check_rows_32, check_rows_64, check_parts_32, check_parts_64
      generic :: check => check_rows_32, check_rows_64, check_parts_32, check_parts_64
   end type

contains

#define ROWS 32
#define CHECK check_rows_32
#include "check.inc"
#define ROWS 64
#define CHECK check_rows_64
#include "check.inc"
#define PARTS 32
#define CHECK check_parts_32
#include "check.inc"
#define PARTS 64
#define CHECK check_parts_64
#include "check.inc"

end module
