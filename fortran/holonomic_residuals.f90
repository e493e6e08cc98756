! What is left of each constraint: hol_residuals with arrays of any layout.
module holonomic_residuals
   use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_residuals_view
   use holonomic_place, only: list_of, place
   use holonomic_status, only: failure, settle
   use holonomic_violation, only: chain_set_violation
   implicit none
   private
   public :: chain_set_residuals

   type, extends(chain_set_violation) :: chain_set_residuals
   contains
      procedure, private :: residuals_rows_32, residuals_rows_64, residuals_parts_32, residuals_parts_64
      generic :: residuals => residuals_rows_32, residuals_rows_64, residuals_parts_32, residuals_parts_64
   end type

contains

   recursive subroutine residuals_rows_64(self, r, v, length, rate, stat, errmsg)
      class(chain_set_residuals), intent(in) :: self
      real(real64), intent(in), target :: r(:, :)
      real(real64), intent(in), optional, target :: v(:, :)
      real(real64), intent(inout), optional, contiguous, target :: length(:), rate(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r, at_v
      call at_r%rows_64(self%n_atoms(), problem, "r", r)
      call at_v%rows_64(self%n_atoms(), problem, "v", v)
      call residuals_at(self, problem, at_r, at_v, length, rate, stat, errmsg)
   end subroutine

   recursive subroutine residuals_rows_32(self, r, v, length, rate, stat, errmsg)
      class(chain_set_residuals), intent(in) :: self
      real(real32), intent(in), target :: r(:, :)
      real(real32), intent(in), optional, target :: v(:, :)
      real(real64), intent(inout), optional, contiguous, target :: length(:), rate(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r, at_v
      call at_r%rows_32(self%n_atoms(), problem, "r", r)
      call at_v%rows_32(self%n_atoms(), problem, "v", v)
      call residuals_at(self, problem, at_r, at_v, length, rate, stat, errmsg)
   end subroutine

   recursive subroutine residuals_parts_64(self, x, y, z, vx, vy, vz, length, rate, stat, errmsg)
      class(chain_set_residuals), intent(in) :: self
      real(real64), intent(in), target :: x(:), y(:)
      real(real64), intent(in), optional, target :: z(:), vx(:), vy(:), vz(:)
      real(real64), intent(inout), optional, contiguous, target :: length(:), rate(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r, at_v
      call at_r%parts_64(self%n_atoms(), problem, "*", x, y, z)
      call at_v%parts_64(self%n_atoms(), problem, "v*", vx, vy, vz)
      call residuals_at(self, problem, at_r, at_v, length, rate, stat, errmsg)
   end subroutine

   recursive subroutine residuals_parts_32(self, x, y, z, vx, vy, vz, length, rate, stat, errmsg)
      class(chain_set_residuals), intent(in) :: self
      real(real32), intent(in), target :: x(:), y(:)
      real(real32), intent(in), optional, target :: z(:), vx(:), vy(:), vz(:)
      real(real64), intent(inout), optional, contiguous, target :: length(:), rate(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r, at_v
      call at_r%parts_32(self%n_atoms(), problem, "*", x, y, z)
      call at_v%parts_32(self%n_atoms(), problem, "v*", vx, vy, vz)
      call residuals_at(self, problem, at_r, at_v, length, rate, stat, errmsg)
   end subroutine

   recursive subroutine residuals_at(self, problem, at_r, at_v, length, rate, stat, errmsg)
      class(chain_set_residuals), intent(in) :: self
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_r, at_v
      real(real64), intent(inout), optional, contiguous, target :: length(:), rate(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(c_ptr) :: to_length, to_rate
      call problem%need_created(self%c_handle())
      to_length = c_null_ptr
      to_rate = c_null_ptr
      if (present(length)) to_length = list_of(length, "length", self%n_bonds(), "bonds", problem)
      if (present(rate)) to_rate = list_of(rate, "rate", self%n_bonds(), "bonds", problem)
      if (problem%none()) &
         call problem%ask(hol_residuals_view(self%c_handle(), at_r%address(), at_v%address(), to_length, to_rate))
      call settle(problem, "residuals", stat, errmsg)
   end subroutine

end module
