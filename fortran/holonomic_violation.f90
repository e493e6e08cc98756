! How far positions and velocities are from the constraints: hol_violation with arrays of any layout.
module holonomic_violation
   use, intrinsic :: iso_c_binding, only: c_loc
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use holonomic_c, only: hol_violation_view, hol_worst
   use holonomic_check, only: chain_set_check
   use holonomic_place, only: place
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_violation

   type, extends(chain_set_check) :: chain_set_violation
   contains
      procedure, private :: violation_rows_32, violation_rows_64, violation_parts_32, violation_parts_64
      generic :: violation => violation_rows_32, violation_rows_64, violation_parts_32, violation_parts_64
   end type

contains

   recursive subroutine violation_rows_64(self, r, v, worst, stat, errmsg)
      class(chain_set_violation), intent(in) :: self
      real(real64), intent(in), target :: r(:, :)
      real(real64), intent(in), optional, target :: v(:, :)
      type(hol_worst), intent(inout) :: worst
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v
      n_atoms = self%n_atoms()
      call at_r%rows_64(n_atoms, problem, "r", r)
      call at_v%rows_64(n_atoms, problem, "v", v)
      call violation_at(self, problem, at_r, at_v, worst, stat, errmsg)
   end subroutine

   recursive subroutine violation_rows_32(self, r, v, worst, stat, errmsg)
      class(chain_set_violation), intent(in) :: self
      real(real32), intent(in), target :: r(:, :)
      real(real32), intent(in), optional, target :: v(:, :)
      type(hol_worst), intent(inout) :: worst
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v
      n_atoms = self%n_atoms()
      call at_r%rows_32(n_atoms, problem, "r", r)
      call at_v%rows_32(n_atoms, problem, "v", v)
      call violation_at(self, problem, at_r, at_v, worst, stat, errmsg)
   end subroutine

   recursive subroutine violation_parts_64(self, x, y, z, vx, vy, vz, worst, stat, errmsg)
      class(chain_set_violation), intent(in) :: self
      real(real64), intent(in), target :: x(:), y(:)
      real(real64), intent(in), optional, target :: z(:), vx(:), vy(:), vz(:)
      type(hol_worst), intent(inout) :: worst
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v
      n_atoms = self%n_atoms()
      call at_r%parts_64(n_atoms, problem, "*", x, y, z)
      call at_v%parts_64(n_atoms, problem, "v*", vx, vy, vz)
      call violation_at(self, problem, at_r, at_v, worst, stat, errmsg)
   end subroutine

   recursive subroutine violation_parts_32(self, x, y, z, vx, vy, vz, worst, stat, errmsg)
      class(chain_set_violation), intent(in) :: self
      real(real32), intent(in), target :: x(:), y(:)
      real(real32), intent(in), optional, target :: z(:), vx(:), vy(:), vz(:)
      type(hol_worst), intent(inout) :: worst
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v
      n_atoms = self%n_atoms()
      call at_r%parts_32(n_atoms, problem, "*", x, y, z)
      call at_v%parts_32(n_atoms, problem, "v*", vx, vy, vz)
      call violation_at(self, problem, at_r, at_v, worst, stat, errmsg)
   end subroutine

   recursive subroutine violation_at(self, problem, at_r, at_v, worst, stat, errmsg)
      class(chain_set_violation), intent(in) :: self
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_r, at_v
      type(hol_worst), intent(inout), target :: worst
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call problem%need_created(self%c_handle())
      if (problem%none()) &
         call problem%ask(hol_violation_view(self%c_handle(), at_r%address(), at_v%address(), c_loc(worst)))
      call settle(problem, "violation", stat, errmsg)
   end subroutine

end module
