! Acceleration level: hol_forces with arrays of any layout.
module holonomic_forces
   use, intrinsic :: iso_c_binding, only: c_int, c_ptr
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_forces_view, HOL_ADD
   use holonomic_given, only: chain_set_given
   use holonomic_place, only: list_of, mode_of, place, tensor
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_forces

   type, extends(chain_set_given) :: chain_set_forces
   contains
      procedure, private :: forces_rows_32, forces_rows_64, forces_parts_32, forces_parts_64
      procedure, private :: add_forces_rows_32, add_forces_rows_64, add_forces_parts_32, add_forces_parts_64
      ! The constraint forces by themselves, and the same added to f in place.
      generic :: forces => forces_rows_32, forces_rows_64, forces_parts_32, forces_parts_64
      generic :: add_forces => add_forces_rows_32, add_forces_rows_64, add_forces_parts_32, add_forces_parts_64
   end type

contains

#define ROWS 32
#define FORCES forces_rows_32
#define ADD_FORCES add_forces_rows_32
#include "forces.inc"
#define ROWS 64
#define FORCES forces_rows_64
#define ADD_FORCES add_forces_rows_64
#include "forces.inc"
#define PARTS 32
#define FORCES forces_parts_32
#define ADD_FORCES add_forces_parts_32
#include "forces.inc"
#define PARTS 64
#define FORCES forces_parts_64
#define ADD_FORCES add_forces_parts_64
#include "forces.inc"

   recursive subroutine forces_at(self, procedure, problem, at_r, at_v, at_f, lambda, tension, at_g, mode, virial, stat, errmsg)
      class(chain_set_forces), intent(in) :: self
      character(*), intent(in) :: procedure
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_r, at_v, at_f, at_g
      real(real64), intent(inout), optional, contiguous, target :: lambda(:), tension(:)
      integer(c_int), intent(in) :: mode
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(c_ptr) :: at_lambda, at_tension
      call problem%need_created(self%c_handle())
      at_lambda = list_of(lambda, "lambda", self%n_bonds(), "bonds", problem)
      at_tension = list_of(tension, "tension", self%n_bonds(), "bonds", problem)
      if (problem%none()) then
         call problem%ask(hol_forces_view(self%c_handle(), at_r%address(), at_v%address(), at_f%address(), at_lambda, &
                                          at_tension, at_g%address(), mode, tensor(virial)))
         call at_g%give_back()
      end if
      call settle(problem, procedure, stat, errmsg)
   end subroutine

end module
