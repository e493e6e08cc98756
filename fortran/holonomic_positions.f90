! Position level: hol_project_positions with arrays of any layout.
module holonomic_positions
   use, intrinsic :: iso_c_binding, only: c_int, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use holonomic_c, only: hol_project_positions_view, hol_report
   use holonomic_place, only: list_of, place, tensor
   use holonomic_status, only: failure, settle
   use holonomic_velocities, only: chain_set_velocities
   implicit none
   private
   public :: chain_set_positions

   type, extends(chain_set_velocities) :: chain_set_positions
   contains
      procedure, private :: positions_rows_32, positions_rows_64, positions_parts_32, positions_parts_64
      procedure, private :: positions_rows_32_short, positions_parts_32_short   ! dt of single precision, too
      generic :: project_positions => positions_rows_32, positions_rows_64, positions_parts_32, positions_parts_64, &
         positions_rows_32_short, positions_parts_32_short
   end type

contains

   recursive subroutine positions_rows_64(self, r_ref, r, dt, v, lambda, guess, virial, report, stat, errmsg)
      class(chain_set_positions), intent(in) :: self
      real(real64), intent(in), target :: r_ref(:, :)
      real(real64), intent(inout), target :: r(:, :)
      real(real64), intent(in) :: dt
      real(real64), intent(inout), optional, target :: v(:, :)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      logical, intent(in), optional :: guess
      real(real64), intent(inout), optional, target :: virial(3, 3)
      type(hol_report), intent(inout), optional, target :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_ref, at_r, at_v
      n_atoms = self%n_atoms()
      call at_ref%rows_64(n_atoms, problem, "r_ref", r_ref)
      call at_r%rows_64(n_atoms, problem, "r", r)
      call at_v%rows_64(n_atoms, problem, "v", v)
      call project_at(self, problem, at_ref, at_r, dt, at_v, lambda, guess, virial, report, stat, errmsg)
   end subroutine

   recursive subroutine positions_rows_32(self, r_ref, r, dt, v, lambda, guess, virial, report, stat, errmsg)
      class(chain_set_positions), intent(in) :: self
      real(real32), intent(in), target :: r_ref(:, :)
      real(real32), intent(inout), target :: r(:, :)
      real(real64), intent(in) :: dt
      real(real32), intent(inout), optional, target :: v(:, :)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      logical, intent(in), optional :: guess
      real(real64), intent(inout), optional, target :: virial(3, 3)
      type(hol_report), intent(inout), optional, target :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_ref, at_r, at_v
      n_atoms = self%n_atoms()
      call at_ref%rows_32(n_atoms, problem, "r_ref", r_ref)
      call at_r%rows_32(n_atoms, problem, "r", r)
      call at_v%rows_32(n_atoms, problem, "v", v)
      call project_at(self, problem, at_ref, at_r, dt, at_v, lambda, guess, virial, report, stat, errmsg)
   end subroutine

   recursive subroutine positions_parts_64(self, x_ref, y_ref, z_ref, x, y, z, dt, vx, vy, vz, lambda, guess, &
                                           virial, report, stat, errmsg)
      class(chain_set_positions), intent(in) :: self
      real(real64), intent(in), target :: x_ref(:), y_ref(:)
      real(real64), intent(in), optional, target :: z_ref(:)
      real(real64), intent(inout), target :: x(:), y(:)
      real(real64), intent(inout), optional, target :: z(:)
      real(real64), intent(in) :: dt
      real(real64), intent(inout), optional, target :: vx(:), vy(:), vz(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      logical, intent(in), optional :: guess
      real(real64), intent(inout), optional, target :: virial(3, 3)
      type(hol_report), intent(inout), optional, target :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_ref, at_r, at_v
      n_atoms = self%n_atoms()
      call at_ref%parts_64(n_atoms, problem, "*_ref", x_ref, y_ref, z_ref)
      call at_r%parts_64(n_atoms, problem, "*", x, y, z)
      call at_v%parts_64(n_atoms, problem, "v*", vx, vy, vz)
      call project_at(self, problem, at_ref, at_r, dt, at_v, lambda, guess, virial, report, stat, errmsg)
   end subroutine

   recursive subroutine positions_parts_32(self, x_ref, y_ref, z_ref, x, y, z, dt, vx, vy, vz, lambda, guess, &
                                           virial, report, stat, errmsg)
      class(chain_set_positions), intent(in) :: self
      real(real32), intent(in), target :: x_ref(:), y_ref(:)
      real(real32), intent(in), optional, target :: z_ref(:)
      real(real32), intent(inout), target :: x(:), y(:)
      real(real32), intent(inout), optional, target :: z(:)
      real(real64), intent(in) :: dt
      real(real32), intent(inout), optional, target :: vx(:), vy(:), vz(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      logical, intent(in), optional :: guess
      real(real64), intent(inout), optional, target :: virial(3, 3)
      type(hol_report), intent(inout), optional, target :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_ref, at_r, at_v
      n_atoms = self%n_atoms()
      call at_ref%parts_32(n_atoms, problem, "*_ref", x_ref, y_ref, z_ref)
      call at_r%parts_32(n_atoms, problem, "*", x, y, z)
      call at_v%parts_32(n_atoms, problem, "v*", vx, vy, vz)
      call project_at(self, problem, at_ref, at_r, dt, at_v, lambda, guess, virial, report, stat, errmsg)
   end subroutine

   recursive subroutine positions_rows_32_short(self, r_ref, r, dt, v, lambda, guess, virial, report, stat, errmsg)
      class(chain_set_positions), intent(in) :: self
      real(real32), intent(in), target :: r_ref(:, :)
      real(real32), intent(inout), target :: r(:, :)
      real(real32), intent(in) :: dt
      real(real32), intent(inout), optional, target :: v(:, :)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      logical, intent(in), optional :: guess
      real(real64), intent(inout), optional, target :: virial(3, 3)
      type(hol_report), intent(inout), optional, target :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%project_positions(r_ref, r, real(dt, real64), v, lambda, guess, virial, report, stat, errmsg)
   end subroutine

   recursive subroutine positions_parts_32_short(self, x_ref, y_ref, z_ref, x, y, z, dt, vx, vy, vz, lambda, guess, &
                                                 virial, report, stat, errmsg)
      class(chain_set_positions), intent(in) :: self
      real(real32), intent(in), target :: x_ref(:), y_ref(:)
      real(real32), intent(in), optional, target :: z_ref(:)
      real(real32), intent(inout), target :: x(:), y(:)
      real(real32), intent(inout), optional, target :: z(:)
      real(real32), intent(in) :: dt
      real(real32), intent(inout), optional, target :: vx(:), vy(:), vz(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      logical, intent(in), optional :: guess
      real(real64), intent(inout), optional, target :: virial(3, 3)
      type(hol_report), intent(inout), optional, target :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%project_positions(x_ref, y_ref, z_ref, x, y, z, real(dt, real64), vx, vy, vz, lambda, guess, virial, &
                                  report, stat, errmsg)
   end subroutine

   recursive subroutine project_at(self, problem, at_ref, at_r, dt, at_v, lambda, guess, virial, report, stat, errmsg)
      class(chain_set_positions), intent(in) :: self
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_ref, at_r, at_v
      real(real64), intent(in) :: dt
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      logical, intent(in), optional :: guess
      real(real64), intent(inout), optional, target :: virial(3, 3)
      type(hol_report), intent(inout), optional, target :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(c_ptr) :: at_lambda, at_report
      integer(c_int) :: has_guess
      call problem%need_created(self%c_handle())
      has_guess = 0
      if (present(guess)) has_guess = merge(1_c_int, 0_c_int, guess)
      at_lambda = c_null_ptr
      if (present(lambda)) at_lambda = list_of(lambda, "lambda", self%n_bonds(), "bonds", problem)
      at_report = c_null_ptr
      if (present(report)) at_report = c_loc(report)
      if (problem%none()) then
         call problem%ask(hol_project_positions_view(self%c_handle(), at_ref%address(), at_r%address(), &
                                                     at_v%address(), dt, at_lambda, has_guess, tensor(virial), &
                                                     at_report))
         call at_r%give_back()
         call at_v%give_back()
      end if
      call settle(problem, "project_positions", stat, errmsg)
   end subroutine

end module
