! Positions that lie anywhere are moved onto the constraints: hol_impose with arrays of any layout.
module holonomic_impose
   use, intrinsic :: iso_c_binding, only: c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_impose_view, hol_report
   use holonomic_place, only: place
   use holonomic_residuals, only: chain_set_residuals
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_impose

   type, extends(chain_set_residuals) :: chain_set_impose
   contains
      procedure, private :: impose_rows_32, impose_rows_64, impose_parts_32, impose_parts_64
      generic :: impose => impose_rows_32, impose_rows_64, impose_parts_32, impose_parts_64
   end type

contains

   recursive subroutine impose_rows_64(self, r, report, stat, errmsg)
      class(chain_set_impose), intent(in) :: self
      real(real64), intent(inout), target :: r(:, :)
      type(hol_report), intent(inout), optional :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r
      call at_r%rows_64(self%n_atoms(), problem, "r", r)
      call impose_at(self, problem, at_r, report, stat, errmsg)
   end subroutine

   recursive subroutine impose_rows_32(self, r, report, stat, errmsg)
      class(chain_set_impose), intent(in) :: self
      real(real32), intent(inout), target :: r(:, :)
      type(hol_report), intent(inout), optional :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r
      call at_r%rows_32(self%n_atoms(), problem, "r", r)
      call impose_at(self, problem, at_r, report, stat, errmsg)
   end subroutine

   recursive subroutine impose_parts_64(self, x, y, z, report, stat, errmsg)
      class(chain_set_impose), intent(in) :: self
      real(real64), intent(inout), target :: x(:), y(:)
      real(real64), intent(inout), optional, target :: z(:)
      type(hol_report), intent(inout), optional :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r
      call at_r%parts_64(self%n_atoms(), problem, "*", x, y, z)
      call impose_at(self, problem, at_r, report, stat, errmsg)
   end subroutine

   recursive subroutine impose_parts_32(self, x, y, z, report, stat, errmsg)
      class(chain_set_impose), intent(in) :: self
      real(real32), intent(inout), target :: x(:), y(:)
      real(real32), intent(inout), optional, target :: z(:)
      type(hol_report), intent(inout), optional :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(place), target :: at_r
      call at_r%parts_32(self%n_atoms(), problem, "*", x, y, z)
      call impose_at(self, problem, at_r, report, stat, errmsg)
   end subroutine

   recursive subroutine impose_at(self, problem, at_r, report, stat, errmsg)
      class(chain_set_impose), intent(in) :: self
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_r
      type(hol_report), intent(inout), optional, target :: report
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(c_ptr) :: to_report
      call problem%need_created(self%c_handle())
      to_report = c_null_ptr
      if (present(report)) to_report = c_loc(report)
      if (problem%none()) then
         call problem%ask(hol_impose_view(self%c_handle(), at_r%address(), to_report))
         call at_r%give_back()
      end if
      call settle(problem, "impose", stat, errmsg)
   end subroutine

end module
