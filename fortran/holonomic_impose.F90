! Positions that lie anywhere are moved onto the constraints: hol_impose with arrays of any layout.
module holonomic_impose
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_impose_view, hol_report
   use holonomic_place, only: place, report_at
   use holonomic_residuals, only: chain_set_residuals
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_impose

   type, extends(chain_set_residuals) :: chain_set_impose
   contains
      procedure, private :: impose_rows_32, impose_rows_64, impose_parts_32, impose_parts_64
      generic :: impose => impose_rows_32, impose_rows_64, impose_parts_32, impose_parts_64
   end type

contains

#define ROWS 32
#define IMPOSE impose_rows_32
#include "impose.inc"
#define ROWS 64
#define IMPOSE impose_rows_64
#include "impose.inc"
#define PARTS 32
#define IMPOSE impose_parts_32
#include "impose.inc"
#define PARTS 64
#define IMPOSE impose_parts_64
#include "impose.inc"

end module
