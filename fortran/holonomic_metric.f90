! Metric determinant and Fixman potential: hol_metric with arrays of any layout.
module holonomic_metric
   use, intrinsic :: iso_c_binding, only: c_int, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use holonomic_c, only: hol_metric_view, HOL_ADD, HOL_ERR_VALUE, HOL_WRITE
   use holonomic_place, only: list_of, number_at, place
   use holonomic_status, only: failure, settle
   use holonomic_outcomes, only: chain_set_outcomes
   implicit none
   private
   public :: chain_set_metric

   type, extends(chain_set_outcomes) :: chain_set_metric
   contains
      procedure, private :: metric_rows_32, metric_rows_64, metric_parts_32, metric_parts_64
      generic :: metric => metric_rows_32, metric_rows_64, metric_parts_32, metric_parts_64
   end type

contains

   recursive subroutine metric_rows_64(self, r, kt, log_det, log_det_z, energy, force, add, stat, errmsg)
      class(chain_set_metric), intent(in) :: self
      real(real64), intent(in), target :: r(:, :)
      real(real64), intent(in), optional :: kt
      real(real64), intent(inout), optional, contiguous, target :: log_det(:), log_det_z(:)
      real(real64), intent(inout), optional, target :: energy
      real(real64), intent(inout), optional, target :: force(:, :)
      logical, intent(in), optional :: add
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_force
      n_atoms = self%n_atoms()
      call at_r%rows_64(n_atoms, problem, "r", r)
      call at_force%rows_64(n_atoms, problem, "force", force)
      call metric_at(self, problem, at_r, kt, log_det, log_det_z, energy, at_force, add, stat, errmsg)
   end subroutine

   recursive subroutine metric_rows_32(self, r, kt, log_det, log_det_z, energy, force, add, stat, errmsg)
      class(chain_set_metric), intent(in) :: self
      real(real32), intent(in), target :: r(:, :)
      real(real64), intent(in), optional :: kt
      real(real64), intent(inout), optional, contiguous, target :: log_det(:), log_det_z(:)
      real(real64), intent(inout), optional, target :: energy
      real(real32), intent(inout), optional, target :: force(:, :)
      logical, intent(in), optional :: add
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_force
      n_atoms = self%n_atoms()
      call at_r%rows_32(n_atoms, problem, "r", r)
      call at_force%rows_32(n_atoms, problem, "force", force)
      call metric_at(self, problem, at_r, kt, log_det, log_det_z, energy, at_force, add, stat, errmsg)
   end subroutine

   recursive subroutine metric_parts_64(self, x, y, z, kt, log_det, log_det_z, energy, fx, fy, fz, add, stat, errmsg)
      class(chain_set_metric), intent(in) :: self
      real(real64), intent(in), target :: x(:), y(:)
      real(real64), intent(in), optional, target :: z(:)
      real(real64), intent(in), optional :: kt
      real(real64), intent(inout), optional, contiguous, target :: log_det(:), log_det_z(:)
      real(real64), intent(inout), optional, target :: energy
      real(real64), intent(inout), optional, target :: fx(:), fy(:), fz(:)
      logical, intent(in), optional :: add
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_force
      n_atoms = self%n_atoms()
      call at_r%parts_64(n_atoms, problem, "*", x, y, z)
      call at_force%parts_64(n_atoms, problem, "f*", fx, fy, fz)
      call metric_at(self, problem, at_r, kt, log_det, log_det_z, energy, at_force, add, stat, errmsg)
   end subroutine

   recursive subroutine metric_parts_32(self, x, y, z, kt, log_det, log_det_z, energy, fx, fy, fz, add, stat, errmsg)
      class(chain_set_metric), intent(in) :: self
      real(real32), intent(in), target :: x(:), y(:)
      real(real32), intent(in), optional, target :: z(:)
      real(real64), intent(in), optional :: kt
      real(real64), intent(inout), optional, contiguous, target :: log_det(:), log_det_z(:)
      real(real64), intent(inout), optional, target :: energy
      real(real32), intent(inout), optional, target :: fx(:), fy(:), fz(:)
      logical, intent(in), optional :: add
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_force
      n_atoms = self%n_atoms()
      call at_r%parts_32(n_atoms, problem, "*", x, y, z)
      call at_force%parts_32(n_atoms, problem, "f*", fx, fy, fz)
      call metric_at(self, problem, at_r, kt, log_det, log_det_z, energy, at_force, add, stat, errmsg)
   end subroutine

   recursive subroutine metric_at(self, problem, at_r, kt, log_det, log_det_z, energy, at_force, add, stat, errmsg)
      class(chain_set_metric), intent(in) :: self
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_r, at_force
      real(real64), intent(in), optional :: kt
      real(real64), intent(inout), optional, contiguous, target :: log_det(:), log_det_z(:)
      real(real64), intent(inout), optional, target :: energy
      logical, intent(in), optional :: add
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(c_ptr) :: at_log_det, at_log_det_z
      real(real64) :: thermal
      integer(c_int) :: mode
      call problem%need_created(self%c_handle())
      mode = HOL_WRITE
      if (present(add)) mode = merge(HOL_ADD, HOL_WRITE, add)
      thermal = 0
      if (present(kt)) then
         thermal = kt
      else if (present(energy) .or. at_force%given) then
         call problem%set(HOL_ERR_VALUE, "kt must be given for the energy and the force")
      end if
      at_log_det = list_of(log_det, "log_det", self%n_molecules(), "molecules", problem)
      at_log_det_z = list_of(log_det_z, "log_det_z", self%n_molecules(), "molecules", problem)
      if (problem%none()) then
         call problem%ask(hol_metric_view(self%c_handle(), at_r%address(), thermal, at_log_det, at_log_det_z, &
                                          number_at(energy), at_force%address(), mode))
         call at_force%give_back()
      end if
      call settle(problem, "metric", stat, errmsg)
   end subroutine

end module
