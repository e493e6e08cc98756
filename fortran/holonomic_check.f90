! Positions compared with the lengths: hol_chains_check with arrays of any layout.
module holonomic_check
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_along, only: chain_set_along
   use holonomic_c, only: hol_chains_check_view, HOL_BOX, HOL_REFERENCE_BOX
   use holonomic_place, only: place
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_check

   type, extends(chain_set_along) :: chain_set_check
   contains
      procedure, private :: check_rows_32, check_rows_64, check_parts_32, check_parts_64
      generic :: check => check_rows_32, check_rows_64, check_parts_32, check_parts_64
   end type

contains

   recursive subroutine check_rows_64(self, r, reference, stat, errmsg)
      class(chain_set_check), intent(in) :: self
      real(real64), intent(in), target :: r(:, :)
      logical, intent(in), optional :: reference
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r
      call at_r%rows_64(self%n_atoms(), problem, "r", r)
      call check_at(self, problem, at_r, reference, stat, errmsg)
   end subroutine

   recursive subroutine check_rows_32(self, r, reference, stat, errmsg)
      class(chain_set_check), intent(in) :: self
      real(real32), intent(in), target :: r(:, :)
      logical, intent(in), optional :: reference
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r
      call at_r%rows_32(self%n_atoms(), problem, "r", r)
      call check_at(self, problem, at_r, reference, stat, errmsg)
   end subroutine

   recursive subroutine check_parts_64(self, x, y, z, reference, stat, errmsg)
      class(chain_set_check), intent(in) :: self
      real(real64), intent(in), target :: x(:), y(:)
      real(real64), intent(in), optional, target :: z(:)
      logical, intent(in), optional :: reference
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r
      call at_r%parts_64(self%n_atoms(), problem, "*", x, y, z)
      call check_at(self, problem, at_r, reference, stat, errmsg)
   end subroutine

   recursive subroutine check_parts_32(self, x, y, z, reference, stat, errmsg)
      class(chain_set_check), intent(in) :: self
      real(real32), intent(in), target :: x(:), y(:)
      real(real32), intent(in), optional, target :: z(:)
      logical, intent(in), optional :: reference
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r
      call at_r%parts_32(self%n_atoms(), problem, "*", x, y, z)
      call check_at(self, problem, at_r, reference, stat, errmsg)
   end subroutine

   ! reference: r belongs to the box of set_reference_box.
   recursive subroutine check_at(self, problem, at_r, reference, stat, errmsg)
      class(chain_set_check), intent(in) :: self
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_r
      logical, intent(in), optional :: reference
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(kind(HOL_BOX)) :: box
      call problem%need_created(self%c_handle())
      box = HOL_BOX
      if (present(reference)) box = merge(HOL_REFERENCE_BOX, HOL_BOX, reference)
      if (problem%none()) call problem%ask(hol_chains_check_view(self%c_handle(), at_r%address(), box))
      call settle(problem, "check", stat, errmsg)
   end subroutine

end module
