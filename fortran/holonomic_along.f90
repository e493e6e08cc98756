! Position level along given bond vectors: hol_project_positions_along with arrays of any layout.
module holonomic_along
   use, intrinsic :: iso_c_binding, only: c_int, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use holonomic_c, only: hol_project_positions_along_view, hol_reference_error, hol_report
   use holonomic_place, only: list_of, place, tensor
   use holonomic_positions, only: chain_set_positions
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_along

   type, extends(chain_set_positions) :: chain_set_along
   contains
      procedure, private :: along_rows_32, along_rows_64, along_parts_32, along_parts_64
      procedure, private :: along_rows_32_short, along_parts_32_short   ! dt of single precision, too
      generic :: project_positions_along => along_rows_32, along_rows_64, along_parts_32, along_parts_64, &
         along_rows_32_short, along_parts_32_short
      procedure :: reference_error
   end type

contains

   ! The largest |b.b - a^2| / a^2 of the last reference that a call has compared with the lengths, and where.
   subroutine reference_error(self, error, molecule, bond, stat, errmsg)
      class(chain_set_along), intent(in) :: self
      real(real64), intent(inout), target :: error
      integer(int64), intent(inout), optional :: molecule, bond
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64), target :: place_of(2)
      call problem%need_created(self%c_handle())
      if (problem%none()) call problem%ask(hol_reference_error(self%c_handle(), c_loc(error), c_loc(place_of(1)), &
                                                               c_loc(place_of(2))))
      if (problem%none() .and. present(molecule)) molecule = place_of(1)
      if (problem%none() .and. present(bond)) bond = place_of(2)
      call settle(problem, "reference_error", stat, errmsg)
   end subroutine

   recursive subroutine along_rows_64(self, b, r, dt, v, lambda, guess, virial, report, stat, errmsg)
      class(chain_set_along), intent(in) :: self
      real(real64), intent(in), target :: b(:, :)
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
      type(place), target :: at_b, at_r, at_v
      n_atoms = self%n_atoms()
      call at_b%rows_64(self%n_bonds(), problem, "b", b, "bonds")
      call at_r%rows_64(n_atoms, problem, "r", r)
      call at_v%rows_64(n_atoms, problem, "v", v)
      call project_at(self, problem, at_b, at_r, dt, at_v, lambda, guess, virial, report, stat, errmsg)
   end subroutine

   recursive subroutine along_rows_32(self, b, r, dt, v, lambda, guess, virial, report, stat, errmsg)
      class(chain_set_along), intent(in) :: self
      real(real32), intent(in), target :: b(:, :)
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
      type(place), target :: at_b, at_r, at_v
      n_atoms = self%n_atoms()
      call at_b%rows_32(self%n_bonds(), problem, "b", b, "bonds")
      call at_r%rows_32(n_atoms, problem, "r", r)
      call at_v%rows_32(n_atoms, problem, "v", v)
      call project_at(self, problem, at_b, at_r, dt, at_v, lambda, guess, virial, report, stat, errmsg)
   end subroutine

   recursive subroutine along_parts_64(self, bx, by, bz, x, y, z, dt, vx, vy, vz, lambda, guess, &
                                           virial, report, stat, errmsg)
      class(chain_set_along), intent(in) :: self
      real(real64), intent(in), target :: bx(:), by(:)
      real(real64), intent(in), optional, target :: bz(:)
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
      type(place), target :: at_b, at_r, at_v
      n_atoms = self%n_atoms()
      call at_b%parts_64(self%n_bonds(), problem, "b*", bx, by, bz, "bonds")
      call at_r%parts_64(n_atoms, problem, "*", x, y, z)
      call at_v%parts_64(n_atoms, problem, "v*", vx, vy, vz)
      call project_at(self, problem, at_b, at_r, dt, at_v, lambda, guess, virial, report, stat, errmsg)
   end subroutine

   recursive subroutine along_parts_32(self, bx, by, bz, x, y, z, dt, vx, vy, vz, lambda, guess, &
                                           virial, report, stat, errmsg)
      class(chain_set_along), intent(in) :: self
      real(real32), intent(in), target :: bx(:), by(:)
      real(real32), intent(in), optional, target :: bz(:)
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
      type(place), target :: at_b, at_r, at_v
      n_atoms = self%n_atoms()
      call at_b%parts_32(self%n_bonds(), problem, "b*", bx, by, bz, "bonds")
      call at_r%parts_32(n_atoms, problem, "*", x, y, z)
      call at_v%parts_32(n_atoms, problem, "v*", vx, vy, vz)
      call project_at(self, problem, at_b, at_r, dt, at_v, lambda, guess, virial, report, stat, errmsg)
   end subroutine

   recursive subroutine along_rows_32_short(self, b, r, dt, v, lambda, guess, virial, report, stat, errmsg)
      class(chain_set_along), intent(in) :: self
      real(real32), intent(in), target :: b(:, :)
      real(real32), intent(inout), target :: r(:, :)
      real(real32), intent(in) :: dt
      real(real32), intent(inout), optional, target :: v(:, :)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      logical, intent(in), optional :: guess
      real(real64), intent(inout), optional, target :: virial(3, 3)
      type(hol_report), intent(inout), optional, target :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%project_positions_along(b, r, real(dt, real64), v, lambda, guess, virial, report, stat, errmsg)
   end subroutine

   recursive subroutine along_parts_32_short(self, bx, by, bz, x, y, z, dt, vx, vy, vz, lambda, guess, &
                                                 virial, report, stat, errmsg)
      class(chain_set_along), intent(in) :: self
      real(real32), intent(in), target :: bx(:), by(:)
      real(real32), intent(in), optional, target :: bz(:)
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
      call self%project_positions_along(bx, by, bz, x, y, z, real(dt, real64), vx, vy, vz, lambda, guess, virial, &
                                  report, stat, errmsg)
   end subroutine

   recursive subroutine project_at(self, problem, at_b, at_r, dt, at_v, lambda, guess, virial, report, stat, errmsg)
      class(chain_set_along), intent(in) :: self
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_b, at_r, at_v
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
         call problem%ask(hol_project_positions_along_view(self%c_handle(), at_b%address(), at_r%address(), &
                                                     at_v%address(), dt, at_lambda, has_guess, tensor(virial), &
                                                     at_report))
         call at_r%give_back()
         call at_v%give_back()
      end if
      call settle(problem, "project_positions_along", stat, errmsg)
   end subroutine

end module
