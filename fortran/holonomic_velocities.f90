! Velocity level: hol_project_velocities with arrays of any layout.
module holonomic_velocities
   use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
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

   recursive subroutine velocities_rows_64(self, r, v, lambda, virial, stat, errmsg)
      class(chain_set_velocities), intent(in) :: self
      real(real64), intent(in), target :: r(:, :)
      real(real64), intent(inout), target :: v(:, :)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v
      n_atoms = self%n_atoms()
      call at_r%rows_64(n_atoms, problem, "r", r)
      call at_v%rows_64(n_atoms, problem, "v", v)
      call project_at(self, problem, at_r, at_v, lambda, virial, stat, errmsg)
   end subroutine

   recursive subroutine velocities_rows_32(self, r, v, lambda, virial, stat, errmsg)
      class(chain_set_velocities), intent(in) :: self
      real(real32), intent(in), target :: r(:, :)
      real(real32), intent(inout), target :: v(:, :)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v
      n_atoms = self%n_atoms()
      call at_r%rows_32(n_atoms, problem, "r", r)
      call at_v%rows_32(n_atoms, problem, "v", v)
      call project_at(self, problem, at_r, at_v, lambda, virial, stat, errmsg)
   end subroutine

   recursive subroutine velocities_parts_64(self, x, y, z, vx, vy, vz, lambda, virial, stat, errmsg)
      class(chain_set_velocities), intent(in) :: self
      real(real64), intent(in), target :: x(:), y(:)
      real(real64), intent(in), optional, target :: z(:)
      real(real64), intent(inout), target :: vx(:), vy(:)
      real(real64), intent(inout), optional, target :: vz(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v
      n_atoms = self%n_atoms()
      call at_r%parts_64(n_atoms, problem, "*", x, y, z)
      call at_v%parts_64(n_atoms, problem, "v*", vx, vy, vz)
      call project_at(self, problem, at_r, at_v, lambda, virial, stat, errmsg)
   end subroutine

   recursive subroutine velocities_parts_32(self, x, y, z, vx, vy, vz, lambda, virial, stat, errmsg)
      class(chain_set_velocities), intent(in) :: self
      real(real32), intent(in), target :: x(:), y(:)
      real(real32), intent(in), optional, target :: z(:)
      real(real32), intent(inout), target :: vx(:), vy(:)
      real(real32), intent(inout), optional, target :: vz(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v
      n_atoms = self%n_atoms()
      call at_r%parts_32(n_atoms, problem, "*", x, y, z)
      call at_v%parts_32(n_atoms, problem, "v*", vx, vy, vz)
      call project_at(self, problem, at_r, at_v, lambda, virial, stat, errmsg)
   end subroutine

   recursive subroutine project_at(self, problem, at_r, at_v, lambda, virial, stat, errmsg)
      class(chain_set_velocities), intent(in) :: self
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_r, at_v
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(c_ptr) :: at_lambda
      call problem%need_created(self%c_handle())
      at_lambda = c_null_ptr
      if (present(lambda)) at_lambda = list_of(lambda, "lambda", self%n_bonds(), "bonds", problem)
      if (problem%none()) then
         call problem%ask(hol_project_velocities_view(self%c_handle(), at_r%address(), at_v%address(), at_lambda, &
                                                      tensor(virial)))
         call at_v%give_back()
      end if
      call settle(problem, "project_velocities", stat, errmsg)
   end subroutine

end module
