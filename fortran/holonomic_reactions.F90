! What given multipliers do: hol_reactions with arrays of any layout.
module holonomic_reactions
   use, intrinsic :: iso_c_binding, only: c_int64_t, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_reactions_view, HOL_ERR_VALUE
   use holonomic_place, only: box_of, enough, list_of, mode_of, place, tensor
   use holonomic_solve, only: chain_set_solve
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: chain_set_reactions

   type, extends(chain_set_solve) :: chain_set_reactions
   contains
      procedure, private :: reactions_rows_32, reactions_rows_64, reactions_parts_32, reactions_parts_64
      ! bond_virial (6, n_bonds): xx xy xz yy yz zz. reference: the positions belong to the box of set_reference_box.
      generic :: reactions => reactions_rows_32, reactions_rows_64, reactions_parts_32, reactions_parts_64
   end type

contains

#define ROWS 32
#define REACTIONS reactions_rows_32
#include "reactions.inc"
#define ROWS 64
#define REACTIONS reactions_rows_64
#include "reactions.inc"
#define PARTS 32
#define REACTIONS reactions_parts_32
#include "reactions.inc"
#define PARTS 64
#define REACTIONS reactions_parts_64
#include "reactions.inc"

   recursive type(c_ptr) function sixes_at(bond_virial, n_bonds, problem)
      real(real64), optional, contiguous, target :: bond_virial(:, :)
      integer(c_int64_t), intent(in) :: n_bonds
      type(failure), intent(inout) :: problem
      sixes_at = c_null_ptr
      if (.not. present(bond_virial)) return
      if (size(bond_virial, 1) /= 6) then
         call problem%set(HOL_ERR_VALUE, "bond_virial has "//decimal(size(bond_virial, 1, kind=c_int64_t))// &
                          " rows; it must have 6")
      else if (enough("bond_virial", size(bond_virial, 2, kind=c_int64_t), n_bonds, "bonds", problem)) then
         sixes_at = c_loc(bond_virial)
      end if
   end function

end module
