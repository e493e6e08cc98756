! Acceleration level: hol_forces with arrays of any layout.
module holonomic_forces
   use, intrinsic :: iso_c_binding, only: c_int, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use holonomic_c, only: hol_forces_view, HOL_ADD, HOL_WRITE
   use holonomic_single, only: chain_set_single
   use holonomic_place, only: list_of, place, tensor
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_forces

   type, extends(chain_set_single) :: chain_set_forces
   contains
      procedure, private :: forces_rows_32, forces_rows_64, forces_parts_32, forces_parts_64
      procedure, private :: add_forces_rows_32, add_forces_rows_64, add_forces_parts_32, add_forces_parts_64
      ! The constraint forces by themselves, and the same added to f in place.
      generic :: forces => forces_rows_32, forces_rows_64, forces_parts_32, forces_parts_64
      generic :: add_forces => add_forces_rows_32, add_forces_rows_64, add_forces_parts_32, add_forces_parts_64
   end type

contains

   recursive subroutine forces_rows_64(self, r, v, f, lambda, tension, g, add, virial, stat, errmsg)
      class(chain_set_forces), intent(in) :: self
      real(real64), intent(in), target :: r(:, :)
      real(real64), intent(in), optional, target :: v(:, :), f(:, :)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:), tension(:)
      real(real64), intent(inout), optional, target :: g(:, :)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v, at_f, at_g
      n_atoms = self%n_atoms()
      call at_r%rows_64(n_atoms, problem, "r", r)
      call at_v%rows_64(n_atoms, problem, "v", v)
      call at_f%rows_64(n_atoms, problem, "f", f)
      call at_g%rows_64(n_atoms, problem, "g", g)
      call forces_at(self, "forces", problem, at_r, at_v, at_f, lambda, tension, at_g, add, virial, stat, errmsg)
   end subroutine

   recursive subroutine forces_rows_32(self, r, v, f, lambda, tension, g, add, virial, stat, errmsg)
      class(chain_set_forces), intent(in) :: self
      real(real32), intent(in), target :: r(:, :)
      real(real32), intent(in), optional, target :: v(:, :), f(:, :)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:), tension(:)
      real(real32), intent(inout), optional, target :: g(:, :)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v, at_f, at_g
      n_atoms = self%n_atoms()
      call at_r%rows_32(n_atoms, problem, "r", r)
      call at_v%rows_32(n_atoms, problem, "v", v)
      call at_f%rows_32(n_atoms, problem, "f", f)
      call at_g%rows_32(n_atoms, problem, "g", g)
      call forces_at(self, "forces", problem, at_r, at_v, at_f, lambda, tension, at_g, add, virial, stat, errmsg)
   end subroutine

   recursive subroutine forces_parts_64(self, x, y, z, vx, vy, vz, fx, fy, fz, lambda, tension, gx, gy, gz, add, &
                                        virial, stat, errmsg)
      class(chain_set_forces), intent(in) :: self
      real(real64), intent(in), target :: x(:), y(:)
      real(real64), intent(in), optional, target :: z(:), vx(:), vy(:), vz(:), fx(:), fy(:), fz(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:), tension(:)
      real(real64), intent(inout), optional, target :: gx(:), gy(:), gz(:)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v, at_f, at_g
      n_atoms = self%n_atoms()
      call at_r%parts_64(n_atoms, problem, "*", x, y, z)
      call at_v%parts_64(n_atoms, problem, "v*", vx, vy, vz)
      call at_f%parts_64(n_atoms, problem, "f*", fx, fy, fz)
      call at_g%parts_64(n_atoms, problem, "g*", gx, gy, gz)
      call forces_at(self, "forces", problem, at_r, at_v, at_f, lambda, tension, at_g, add, virial, stat, errmsg)
   end subroutine

   recursive subroutine forces_parts_32(self, x, y, z, vx, vy, vz, fx, fy, fz, lambda, tension, gx, gy, gz, add, &
                                        virial, stat, errmsg)
      class(chain_set_forces), intent(in) :: self
      real(real32), intent(in), target :: x(:), y(:)
      real(real32), intent(in), optional, target :: z(:), vx(:), vy(:), vz(:), fx(:), fy(:), fz(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:), tension(:)
      real(real32), intent(inout), optional, target :: gx(:), gy(:), gz(:)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v, at_f, at_g
      n_atoms = self%n_atoms()
      call at_r%parts_32(n_atoms, problem, "*", x, y, z)
      call at_v%parts_32(n_atoms, problem, "v*", vx, vy, vz)
      call at_f%parts_32(n_atoms, problem, "f*", fx, fy, fz)
      call at_g%parts_32(n_atoms, problem, "g*", gx, gy, gz)
      call forces_at(self, "forces", problem, at_r, at_v, at_f, lambda, tension, at_g, add, virial, stat, errmsg)
   end subroutine

   recursive subroutine add_forces_rows_64(self, r, v, f, lambda, tension, virial, stat, errmsg)
      class(chain_set_forces), intent(in) :: self
      real(real64), intent(in), target :: r(:, :)
      real(real64), intent(in), optional, target :: v(:, :)
      real(real64), intent(inout), target :: f(:, :)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:), tension(:)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v, at_f
      n_atoms = self%n_atoms()
      call at_r%rows_64(n_atoms, problem, "r", r)
      call at_v%rows_64(n_atoms, problem, "v", v)
      call at_f%rows_64(n_atoms, problem, "f", f)
      call forces_at(self, "add_forces", problem, at_r, at_v, at_f, lambda, tension, at_f, .true., virial, &
                     stat, errmsg)
   end subroutine

   recursive subroutine add_forces_rows_32(self, r, v, f, lambda, tension, virial, stat, errmsg)
      class(chain_set_forces), intent(in) :: self
      real(real32), intent(in), target :: r(:, :)
      real(real32), intent(in), optional, target :: v(:, :)
      real(real32), intent(inout), target :: f(:, :)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:), tension(:)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v, at_f
      n_atoms = self%n_atoms()
      call at_r%rows_32(n_atoms, problem, "r", r)
      call at_v%rows_32(n_atoms, problem, "v", v)
      call at_f%rows_32(n_atoms, problem, "f", f)
      call forces_at(self, "add_forces", problem, at_r, at_v, at_f, lambda, tension, at_f, .true., virial, &
                     stat, errmsg)
   end subroutine

   recursive subroutine add_forces_parts_64(self, x, y, z, vx, vy, vz, fx, fy, fz, lambda, tension, virial, &
                                            stat, errmsg)
      class(chain_set_forces), intent(in) :: self
      real(real64), intent(in), target :: x(:), y(:)
      real(real64), intent(in), optional, target :: z(:), vx(:), vy(:), vz(:)
      real(real64), intent(inout), target :: fx(:), fy(:)
      real(real64), intent(inout), optional, target :: fz(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:), tension(:)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v, at_f
      n_atoms = self%n_atoms()
      call at_r%parts_64(n_atoms, problem, "*", x, y, z)
      call at_v%parts_64(n_atoms, problem, "v*", vx, vy, vz)
      call at_f%parts_64(n_atoms, problem, "f*", fx, fy, fz)
      call forces_at(self, "add_forces", problem, at_r, at_v, at_f, lambda, tension, at_f, .true., virial, &
                     stat, errmsg)
   end subroutine

   recursive subroutine add_forces_parts_32(self, x, y, z, vx, vy, vz, fx, fy, fz, lambda, tension, virial, &
                                            stat, errmsg)
      class(chain_set_forces), intent(in) :: self
      real(real32), intent(in), target :: x(:), y(:)
      real(real32), intent(in), optional, target :: z(:), vx(:), vy(:), vz(:)
      real(real32), intent(inout), target :: fx(:), fy(:)
      real(real32), intent(inout), optional, target :: fz(:)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:), tension(:)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_v, at_f
      n_atoms = self%n_atoms()
      call at_r%parts_32(n_atoms, problem, "*", x, y, z)
      call at_v%parts_32(n_atoms, problem, "v*", vx, vy, vz)
      call at_f%parts_32(n_atoms, problem, "f*", fx, fy, fz)
      call forces_at(self, "add_forces", problem, at_r, at_v, at_f, lambda, tension, at_f, .true., virial, &
                     stat, errmsg)
   end subroutine

   recursive subroutine forces_at(self, procedure, problem, at_r, at_v, at_f, lambda, tension, at_g, add, virial, &
                                  stat, errmsg)
      class(chain_set_forces), intent(in) :: self
      character(*), intent(in) :: procedure
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_r, at_v, at_f, at_g
      real(real64), intent(inout), optional, contiguous, target :: lambda(:), tension(:)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, target :: virial(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(c_ptr) :: at_lambda, at_tension
      integer(c_int) :: mode
      call problem%need_created(self%c_handle())
      mode = HOL_WRITE
      if (present(add)) mode = merge(HOL_ADD, HOL_WRITE, add)
      at_lambda = c_null_ptr
      if (present(lambda)) at_lambda = list_of(lambda, "lambda", self%n_bonds(), "bonds", problem)
      at_tension = c_null_ptr
      if (present(tension)) at_tension = list_of(tension, "tension", self%n_bonds(), "bonds", problem)
      if (problem%none()) then
         call problem%ask(hol_forces_view(self%c_handle(), at_r%address(), at_v%address(), at_f%address(), at_lambda, &
                                          at_tension, at_g%address(), mode, tensor(virial)))
         call at_g%give_back()
      end if
      call settle(problem, procedure, stat, errmsg)
   end subroutine

end module
