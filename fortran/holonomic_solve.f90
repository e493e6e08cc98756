! Multipliers of given right-hand sides: hol_solve with arrays of any layout.
module holonomic_solve
   use, intrinsic :: iso_c_binding, only: c_int, c_ptr
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_solve_view, HOL_ADD, HOL_WRITE
   use holonomic_forces, only: chain_set_forces
   use holonomic_place, only: list_of, place, tensor
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_solve

   type, extends(chain_set_forces) :: chain_set_solve
   contains
      procedure, private :: solve_rows_32, solve_rows_64, solve_parts_32, solve_parts_64
      generic :: solve => solve_rows_32, solve_rows_64, solve_parts_32, solve_parts_64
   end type

contains

   recursive subroutine solve_rows_64(self, r, rhs, lambda, g, add, virial, stat, errmsg)
      class(chain_set_solve), intent(in) :: self
      real(real64), intent(in), target :: r(:, :)
      real(real64), intent(in), contiguous, target :: rhs(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, target :: g(:, :)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r, at_g
      call at_r%rows_64(self%n_atoms(), problem, "r", r)
      call at_g%rows_64(self%n_atoms(), problem, "g", g)
      call solve_at(self, problem, at_r, rhs, lambda, at_g, add, virial, stat, errmsg)
   end subroutine

   recursive subroutine solve_rows_32(self, r, rhs, lambda, g, add, virial, stat, errmsg)
      class(chain_set_solve), intent(in) :: self
      real(real32), intent(in), target :: r(:, :)
      real(real64), intent(in), contiguous, target :: rhs(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      real(real32), intent(inout), optional, target :: g(:, :)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r, at_g
      call at_r%rows_32(self%n_atoms(), problem, "r", r)
      call at_g%rows_32(self%n_atoms(), problem, "g", g)
      call solve_at(self, problem, at_r, rhs, lambda, at_g, add, virial, stat, errmsg)
   end subroutine

   recursive subroutine solve_parts_64(self, x, y, z, rhs, lambda, gx, gy, gz, add, virial, stat, errmsg)
      class(chain_set_solve), intent(in) :: self
      real(real64), intent(in), target :: x(:), y(:)
      real(real64), intent(in), optional, target :: z(:)
      real(real64), intent(in), contiguous, target :: rhs(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, target :: gx(:), gy(:), gz(:)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r, at_g
      call at_r%parts_64(self%n_atoms(), problem, "*", x, y, z)
      call at_g%parts_64(self%n_atoms(), problem, "g*", gx, gy, gz)
      call solve_at(self, problem, at_r, rhs, lambda, at_g, add, virial, stat, errmsg)
   end subroutine

   recursive subroutine solve_parts_32(self, x, y, z, rhs, lambda, gx, gy, gz, add, virial, stat, errmsg)
      class(chain_set_solve), intent(in) :: self
      real(real32), intent(in), target :: x(:), y(:)
      real(real32), intent(in), optional, target :: z(:)
      real(real64), intent(in), contiguous, target :: rhs(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      real(real32), intent(inout), optional, target :: gx(:), gy(:), gz(:)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r, at_g
      call at_r%parts_32(self%n_atoms(), problem, "*", x, y, z)
      call at_g%parts_32(self%n_atoms(), problem, "g*", gx, gy, gz)
      call solve_at(self, problem, at_r, rhs, lambda, at_g, add, virial, stat, errmsg)
   end subroutine

   recursive subroutine solve_at(self, problem, at_r, rhs, lambda, at_g, add, virial, stat, errmsg)
      class(chain_set_solve), intent(in) :: self
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_r, at_g
      real(real64), intent(in), contiguous, target :: rhs(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(c_ptr) :: at_rhs, at_lambda
      integer(c_int) :: mode
      call problem%need_created(self%c_handle())
      mode = HOL_WRITE
      if (present(add)) mode = merge(HOL_ADD, HOL_WRITE, add)
      at_rhs = list_of(rhs, "rhs", self%n_bonds(), "bonds", problem)
      at_lambda = list_of(lambda, "lambda", self%n_bonds(), "bonds", problem)
      if (problem%none()) then
         call problem%ask(hol_solve_view(self%c_handle(), at_r%address(), at_rhs, at_lambda, at_g%address(), mode, &
                                         tensor(virial)))
         call at_g%give_back()
      end if
      call settle(problem, "solve", stat, errmsg)
   end subroutine

end module
