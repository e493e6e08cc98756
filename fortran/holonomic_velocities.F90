! Velocity level: hol_project_velocities with arrays of any layout.
module holonomic_velocities
   use, intrinsic :: iso_c_binding, only: c_ptr
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_project_velocities_view
   use holonomic_place, only: list_of, place, tensor
   use holonomic_reactions, only: chain_set_reactions
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_velocities

   type, extends(chain_set_reactions) :: chain_set_velocities
   contains
      procedure, private :: velocities_rows_32, velocities_rows_64, velocities_parts_32, velocities_parts_64
      generic :: project_velocities => velocities_rows_32, velocities_rows_64, velocities_parts_32, velocities_parts_64
   end type

contains

#define ROWS 32
#define PROJECT velocities_rows_32
#include "velocities.inc"
#define ROWS 64
#define PROJECT velocities_rows_64
#include "velocities.inc"
#define PARTS 32
#define PROJECT velocities_parts_32
#include "velocities.inc"
#define PARTS 64
#define PROJECT velocities_parts_64
#include "velocities.inc"

end module
