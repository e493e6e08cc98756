! The bare algebra: symmetric tridiagonal matrices with ones on the diagonal and -gamma beside it, and the partition
! functions. Rows are counted from 1: gamma(k) couples rows k and k + 1, so that there are size(gamma) + 1 of them.
module holonomic_tridiagonal
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: real64
   use holonomic_c, only: hol_error_location, hol_partition_function, hol_tridiagonal_inverse_band, &
                          hol_tridiagonal_inverse_entry, hol_tridiagonal_log_det, hol_tridiagonal_pivots, &
                          hol_tridiagonal_solve, HOL_ERR_DEGENERATE, HOL_ERR_INDEX, HOL_ERR_NOT_DEFINITE, &
                          HOL_ERR_NOT_FINITE, HOL_ERR_VALUE
   use holonomic_place, only: enough, list_of, number_at
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: pivots, log_det, solve, inverse_entry, inverse_band, partition_of_masses, partition_of_equal_masses

contains

   ! NULL for a matrix of one row.
   recursive type(c_ptr) function at_gamma(gamma)
      real(real64), contiguous, target :: gamma(:)
      at_gamma = c_null_ptr
      if (size(gamma) > 0) at_gamma = c_loc(gamma)
   end function

   pure recursive integer(c_int64_t) function rows(gamma)
      real(real64), intent(in) :: gamma(:)
      rows = size(gamma, kind=c_int64_t) + 1
   end function

   ! C counts rows from 0 here, having no handle that says otherwise.
   recursive subroutine ask(problem, status)
      type(failure), intent(inout) :: problem
      integer(c_int), intent(in) :: status
      integer(c_int64_t), target :: at
      if (status == HOL_ERR_NOT_DEFINITE .or. status == HOL_ERR_NOT_FINITE) then
         call hol_error_location(c_null_ptr, c_loc(at), c_null_ptr, c_null_ptr)
         if (at >= 0 .and. status == HOL_ERR_NOT_DEFINITE) &
            call problem%set(status, "the matrix is not positive definite: the pivot of row "//decimal(at + 1)// &
                             " is not above zero")
         if (at >= 0 .and. status == HOL_ERR_NOT_FINITE) &
            call problem%set(status, "gamma("//decimal(at + 1)//") is not finite")
      end if
      call problem%ask(status)
   end subroutine

   recursive subroutine pivots(gamma, omega2, stat, errmsg)
      real(real64), intent(in), contiguous, target :: gamma(:)
      real(real64), intent(inout), contiguous, target :: omega2(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      if (enough("omega2", size(omega2, kind=c_int64_t), rows(gamma), "rows", problem)) &
         call ask(problem, hol_tridiagonal_pivots(rows(gamma), at_gamma(gamma), c_loc(omega2)))
      call settle(problem, "hol_tridiagonal_pivots", stat, errmsg)
   end subroutine

   recursive subroutine log_det(gamma, value, stat, errmsg)
      real(real64), intent(in), contiguous, target :: gamma(:)
      real(real64), intent(inout), target :: value
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call ask(problem, hol_tridiagonal_log_det(rows(gamma), at_gamma(gamma), c_loc(value)))
      call settle(problem, "hol_tridiagonal_log_det", stat, errmsg)
   end subroutine

   recursive subroutine solve(gamma, b, x, stat, errmsg)
      real(real64), intent(in), contiguous, target :: gamma(:), b(:)
      real(real64), intent(inout), contiguous, target :: x(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(c_ptr) :: at_b, at_x
      at_b = list_of(b, "b", rows(gamma), "rows", problem)
      at_x = list_of(x, "x", rows(gamma), "rows", problem)
      if (problem%none()) call ask(problem, hol_tridiagonal_solve(rows(gamma), at_gamma(gamma), at_b, at_x))
      call settle(problem, "hol_tridiagonal_solve", stat, errmsg)
   end subroutine

   recursive subroutine inverse_entry(gamma, i, j, value, stat, errmsg)
      real(real64), intent(in), contiguous, target :: gamma(:)
      integer, intent(in) :: i, j
      real(real64), intent(inout), target :: value
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      if (min(i, j) < 1 .or. max(i, j) > rows(gamma)) then
         call problem%set(HOL_ERR_INDEX, "element ("//decimal(int(i, c_int64_t))//", "//decimal(int(j, c_int64_t))// &
                          ") is outside a matrix of "//decimal(rows(gamma))//" rows")
      else
         call ask(problem, hol_tridiagonal_inverse_entry(rows(gamma), at_gamma(gamma), i - 1_c_int64_t, &
                                                         j - 1_c_int64_t, c_loc(value)))
      end if
      call settle(problem, "hol_tridiagonal_inverse_entry", stat, errmsg)
   end subroutine

   ! band(0:width, rows): element (i, i + k) at band(k, i), 0 where i + k is past the last row.
   recursive subroutine inverse_band(gamma, band, stat, errmsg)
      real(real64), intent(in), contiguous, target :: gamma(:)
      real(real64), intent(inout), contiguous, target :: band(0:, :)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      if (enough("the second dimension of band", size(band, 2, c_int64_t), rows(gamma), "rows", problem)) &
         call ask(problem, hol_tridiagonal_inverse_band(rows(gamma), at_gamma(gamma), size(band, 1, c_int64_t) - 1, &
                                                        c_loc(band)))
      call settle(problem, "hol_tridiagonal_inverse_band", stat, errmsg)
   end subroutine

   recursive subroutine partition_of_masses(masses, log_he, log_rigid, log_volume, stat, errmsg)
      real(real64), intent(in), contiguous, target :: masses(:)
      real(real64), intent(inout), optional, target :: log_he, log_rigid, log_volume
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(c_int64_t), target :: bond, atom
      integer(c_int) :: status
      type(failure) :: problem
      if (size(masses) < 2) then
         call problem%set(HOL_ERR_VALUE, "a chain needs the masses of at least two atoms")
      else
         status = hol_partition_function(size(masses, kind=c_int64_t) - 1, c_loc(masses), number_at(log_he), &
                                         number_at(log_rigid), number_at(log_volume))
         if (status == HOL_ERR_VALUE .or. status == HOL_ERR_DEGENERATE) then
            call hol_error_location(c_null_ptr, c_loc(bond), c_loc(atom), c_null_ptr)
            if (atom >= 0) call problem%set(status, "the mass of atom "//decimal(atom + 1)//" is negative or not a number")
            if (bond >= 0) call problem%set(status, "bond "//decimal(bond + 1)//" joins two fixed atoms")
         end if
         call problem%ask(status)
      end if
      call settle(problem, "hol_partition_function", stat, errmsg)
   end subroutine

   recursive subroutine partition_of_equal_masses(n_bonds, log_he, log_rigid, log_volume, stat, errmsg)
      integer, intent(in) :: n_bonds
      real(real64), intent(inout), optional, target :: log_he, log_rigid, log_volume
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%ask(hol_partition_function(int(n_bonds, c_int64_t), c_null_ptr, number_at(log_he), &
                                              number_at(log_rigid), number_at(log_volume)))
      call settle(problem, "hol_partition_function", stat, errmsg)
   end subroutine

end module
