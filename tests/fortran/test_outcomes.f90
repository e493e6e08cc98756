! A status and a number of iterations for each molecule.
program test_outcomes
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: real64
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use checks, only: check, finish, test
   use holonomic
   implicit none
   integer, parameter :: n = 5
   type(hol_chains) :: chains
   type(hol_report) :: report
   real(real64) :: r(3, 3*n), trial(3, 3*n)
   integer(c_int) :: status(n), iterations(n), short(2)
   integer :: i, stat
   character(200) :: message

   call test("outcomes")
   do i = 1, n
      r(:, 3*i - 2:3*i) = reshape([0, 0, 10*i, 1, 0, 10*i, 1, 1, 10*i], [3, 3])
   end do
   call chains%create(spread(1.0_real64, 1, 3*n))
   call chains%add(n, 2, 1, [1.0_real64, 1.0_real64])
   call chains%outcomes(status, stat=stat, errmsg=message)
   call check(stat == HOL_ERR_STATE .and. index(message, "outcomes: ") == 1, "nothing is kept at first")
   call chains%set_outcomes(.true.)
   trial = r
   trial(1, 2::3) = 1.1_real64
   trial(:, 4:6) = r(:, 4:6)
   call chains%project_positions(r, trial, 1.0_real64, report=report)
   call chains%outcomes(status, iterations)
   call check(all(status == HOL_OK), "all are good")
   call check(iterations(2) == 0 .and. maxval(iterations) == report%iterations .and. count(iterations > 0) == n - 1, &
              "iterations of each")
   r(2, 3*2) = ieee_value(1.0_real64, ieee_quiet_nan)
   r(:, 3*4) = r(:, 3*4 - 1)
   call chains%project_velocities(r, trial, stat=stat)
   call check(stat == HOL_ERR_NOT_FINITE, "the first bad one gives the status")
   call chains%outcomes(status)
   call check(all(status == [HOL_OK, HOL_ERR_NOT_FINITE, HOL_OK, HOL_ERR_DEGENERATE, HOL_OK]), "every bad one is named")
   call chains%outcomes(short, stat=stat, errmsg=message)
   call check(stat == HOL_ERR_VALUE .and. index(message, "status has 2") > 0, "a list that is too short is refused")
   call chains%set_outcomes(.false.)
   call chains%destroy()
   call finish()
end program
