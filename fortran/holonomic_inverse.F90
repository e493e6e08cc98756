! The inverse of the matrix Z of one molecule. Bonds are counted from 1. As with type(hol_chains), the variable that was
! created owns what it has until its destroy, and copies don't.
module holonomic_inverse
   use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   use holonomic_c, only: hol_chains_n_atoms, hol_inverse_band, hol_inverse_condition, hol_inverse_create_view, &
                          hol_inverse_destroy, hol_inverse_entry, hol_inverse_error_bound_view, hol_inverse_matrix, &
                          hol_inverse_n_bonds, hol_inverse_row, HOL_ERR_NULL, HOL_ERR_VALUE, HOL_UNIT_DIAGONAL
   use holonomic_chains, only: hol_chains
   use holonomic_ownership, only: ownership
   use holonomic_place, only: enough, list_of, number_at, place
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: hol_inverse

   type :: hol_inverse
      private
      type(c_ptr) :: handle = c_null_ptr
      type(ownership) :: owner
      integer(c_int64_t) :: n_atoms = 0   ! of the arrays v and f of error_bound
   contains
      procedure, private :: create_rows_32_32, create_rows_32_64, create_rows_64_32, create_rows_64_64, create_parts_32_32, &
         create_parts_32_64, create_parts_64_32, create_parts_64_64
      generic :: create => create_rows_32_32, create_rows_32_64, create_rows_64_32, create_rows_64_64, create_parts_32_32, &
         create_parts_32_64, create_parts_64_32, create_parts_64_64
      procedure :: adopt, destroy, n_bonds, band, matrix, condition
      ! scaling: HOL_UNIT_DIAGONAL, the default, or HOL_PHYSICAL.
      procedure, private :: entry_32, entry_64, row_32, row_64
      generic :: entry => entry_32, entry_64
      generic :: row => row_32, row_64
      procedure, private :: bound_at_rest, bound_rows_32, bound_rows_64, bound_parts_32, bound_parts_64
      generic :: error_bound => bound_at_rest, bound_rows_32, bound_rows_64, bound_parts_32, bound_parts_64
   end type

contains

#define ROWS 32
#define IP int32
#define CREATE create_rows_32_32
#include "inverse.inc"
#define ROWS 32
#define IP int64
#define CREATE create_rows_32_64
#include "inverse.inc"
#define ROWS 64
#define IP int32
#define CREATE create_rows_64_32
#include "inverse.inc"
#define ROWS 64
#define IP int64
#define CREATE create_rows_64_64
#include "inverse.inc"
#define PARTS 32
#define IP int32
#define CREATE create_parts_32_32
#include "inverse.inc"
#define PARTS 32
#define IP int64
#define CREATE create_parts_32_64
#include "inverse.inc"
#define PARTS 64
#define IP int32
#define CREATE create_parts_64_32
#include "inverse.inc"
#define PARTS 64
#define IP int64
#define CREATE create_parts_64_64
#include "inverse.inc"

   subroutine create_at(self, problem, chains, molecule, at_r, stat, errmsg)
      class(hol_inverse), intent(inout) :: self
      type(failure), intent(inout) :: problem
      class(hol_chains), intent(in) :: chains
      integer(c_int64_t), intent(in) :: molecule
      type(place), intent(in), target :: at_r
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      if (.not. c_associated(chains%c_handle())) &
         call problem%set(HOL_ERR_NULL, "create has not been called for the set of molecules")
      if (c_associated(self%handle)) call problem%set(HOL_ERR_VALUE, "this inverse has been created already; " &
                                                      //"destroy it first")
      if (problem%none()) then
         call problem%ask(hol_inverse_create_view(chains%c_handle(), molecule, at_r%address(), self%handle))
         if (problem%none()) call self%owner%take()
         self%n_atoms = hol_chains_n_atoms(chains%c_handle())
      end if
      call settle(problem, "create", stat, errmsg)
   end subroutine

   impure elemental subroutine destroy(self)
      class(hol_inverse), intent(inout) :: self
      if (self%owner%is_here()) call hol_inverse_destroy(self%handle)
      self%handle = c_null_ptr
      call self%owner%drop()
   end subroutine

   ! Owns the inverse from now on. For a copy whose owner is gone without `destroy`.
   impure elemental subroutine adopt(self)
      class(hol_inverse), intent(inout) :: self
      if (c_associated(self%handle)) call self%owner%take()
   end subroutine

   pure recursive integer(int64) function n_bonds(self)
      class(hol_inverse), intent(in) :: self
      n_bonds = hol_inverse_n_bonds(self%handle)
   end function

   pure recursive integer(c_int) function chosen(scaling)
      integer(c_int), intent(in), optional :: scaling
      chosen = HOL_UNIT_DIAGONAL
      if (present(scaling)) chosen = scaling
   end function

#define INTEGERS 32
#include "inverse_entry.inc"
#define INTEGERS 64
#include "inverse_entry.inc"

   ! band(0:width, n_bonds): element (i, i + k) at band(k, i), 0 where i + k is past the last bond.
   recursive subroutine band(self, values, scaling, stat, errmsg)
      class(hol_inverse), intent(in) :: self
      real(real64), intent(inout), contiguous, target :: values(0:, :)
      integer(c_int), intent(in), optional :: scaling
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%handle)
      if (enough("the second dimension of values", size(values, 2, c_int64_t), self%n_bonds(), "bonds", problem)) &
         call problem%ask(hol_inverse_band(self%handle, chosen(scaling), size(values, 1, c_int64_t) - 1, c_loc(values)))
      call settle(problem, "band", stat, errmsg)
   end subroutine

   recursive subroutine matrix(self, values, scaling, stat, errmsg)
      class(hol_inverse), intent(in) :: self
      real(real64), intent(inout), contiguous, target :: values(:, :)
      integer(c_int), intent(in), optional :: scaling
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%handle)
      if (any(shape(values, c_int64_t) /= self%n_bonds())) then
         call problem%set(HOL_ERR_VALUE, "values must be of "//decimal(self%n_bonds())//" rows and columns")
      else
         call problem%ask(hol_inverse_matrix(self%handle, chosen(scaling), c_loc(values)))
      end if
      call settle(problem, "matrix", stat, errmsg)
   end subroutine

   recursive subroutine condition(self, value, stat, errmsg)
      class(hol_inverse), intent(in) :: self
      real(real64), intent(inout), target :: value
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%handle)
      call problem%ask(hol_inverse_condition(self%handle, c_loc(value)))
      call settle(problem, "condition", stat, errmsg)
   end subroutine

   ! Without velocities and applied forces.
   recursive subroutine bound_at_rest(self, lambda, bound, relative, stat, errmsg)
      class(hol_inverse), intent(in) :: self
      real(real64), intent(in), contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, contiguous, target :: bound(:)
      real(real64), intent(inout), optional, target :: relative
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: none
      call bound_at(self, problem, lambda, none, none, bound, relative, stat, errmsg)
   end subroutine

#define ROWS 32
#include "inverse_bound.inc"
#define ROWS 64
#include "inverse_bound.inc"
#define PARTS 32
#include "inverse_bound.inc"
#define PARTS 64
#include "inverse_bound.inc"

   recursive subroutine bound_at(self, problem, lambda, at_v, at_f, bound, relative, stat, errmsg)
      class(hol_inverse), intent(in) :: self
      type(failure), intent(inout) :: problem
      real(real64), intent(in), contiguous, target :: lambda(:)
      type(place), intent(in), target :: at_v, at_f
      real(real64), intent(inout), optional, contiguous, target :: bound(:)
      real(real64), intent(inout), optional, target :: relative
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(c_ptr) :: at_lambda, at_bound
      call problem%need_created(self%handle)
      at_lambda = list_of(lambda, "lambda", self%n_bonds(), "bonds", problem)
      at_bound = list_of(bound, "bound", self%n_bonds(), "bonds", problem)
      if (problem%none()) call problem%ask(hol_inverse_error_bound_view(self%handle, at_v%address(), at_f%address(), &
                                                                        at_lambda, at_bound, number_at(relative)))
      call settle(problem, "error_bound", stat, errmsg)
   end subroutine

end module
