! Tridiagonal algebra, partition functions and mass points: closed forms, and what happens to wrong arguments.
program test_tridiagonal
   use, intrinsic :: iso_fortran_env, only: real64
   use checks, only: check, eps, finish, same_bits, test
   use holonomic
   implicit none

   call straight_chain_in_closed_form()
   call tridiagonal_refuses()
   call partition_functions()
   call mass_points()
   call finish()

contains

   ! gamma = 1/2: det = (N+1)/2^N, inverse 2 i (N+1-j)/(N+1) for i <= j.
   subroutine straight_chain_in_closed_form()
      integer, parameter :: n = 40
      real(real64) :: gamma(n - 1), omega2(n), value, band(0:1, n), b(n), x(n)
      integer :: k
      call test("a straight chain in closed form")
      gamma = 0.5_real64
      call hol_tridiagonal_pivots(gamma, omega2)
      call check(all(abs(omega2 - [((k + 1)/(2.0_real64*k), k=1, n)]) <= 8*eps), "pivots")
      call hol_tridiagonal_log_det(gamma, value)
      call check(abs(value - (log(n + 1.0_real64) - n*log(2.0_real64))) <= 16*eps*abs(value), "ln det")
      call hol_tridiagonal_inverse_entry(gamma, 3, 30, value)
      call check(abs(value - 2*3*(n + 1 - 30)/real(n + 1, real64)) <= 128*eps*abs(value), "an element of the inverse")
      call hol_tridiagonal_inverse_band(gamma, band)
      call check(all(abs(band(0, :) - [(2*k*(n + 1 - k)/real(n + 1, real64), k=1, n)]) <= 16*eps*band(0, :)), "its diagonal")
      call check(all(abs(band(1, :n - 1) - [(2*k*(n - k)/real(n + 1, real64), k=1, n - 1)]) <= 16*eps*band(1, :n - 1)) &
                 .and. same_bits(band(1, n), 0.0_real64), "and the one beside it")
      b = [(real(k, real64), k=1, n)]
      call hol_tridiagonal_solve(gamma, b, x)
      b(2:n) = b(2:n) + 0.5_real64*x(:n - 1)
      b(:n - 1) = b(:n - 1) + 0.5_real64*x(2:)
      call check(maxval(abs(x - b)) <= 8*eps*maxval(abs(x)), "a solution")
      call hol_tridiagonal_log_det([real(real64) ::], value)
      call check(same_bits(value, 0.0_real64), "one row")
   end subroutine

   subroutine tridiagonal_refuses()
      real(real64) :: omega2(3), value, zero
      integer :: stat
      character(100) :: message
      call test("wrong arguments of the tridiagonal algebra")
      omega2 = -7
      value = -7
      zero = 0
      call hol_tridiagonal_pivots([0.9_real64, 0.9_real64], omega2, stat, message)
      call check(stat == HOL_ERR_NOT_DEFINITE .and. index(message, "row 3") > 0, "the row is told, counted from 1")
      call hol_tridiagonal_log_det([0.1_real64, zero/zero], value, stat, message)
      call check(stat == HOL_ERR_NOT_FINITE .and. index(message, "gamma(2)") > 0, "the element is told, counted from 1")
      call hol_tridiagonal_pivots([0.1_real64, 0.1_real64, 0.1_real64], omega2, stat, message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "omega2") > 0, "omega2 too small")
      call hol_tridiagonal_solve([0.1_real64], omega2(:1), omega2, stat)
      call check(stat == HOL_ERR_VALUE, "b too small")
      call hol_tridiagonal_inverse_entry([0.1_real64], 0, 1, value, stat, message)
      call check(stat == HOL_ERR_INDEX .and. index(message, "(0, 1)") > 0, "there is no row 0")
      call hol_tridiagonal_inverse_entry([0.1_real64], 1, 3, value, stat)
      call check(stat == HOL_ERR_INDEX, "there is no row 3")
      call check(all(same_bits(omega2, -7.0_real64)) .and. same_bits(value, -7.0_real64), "nothing was written")
   end subroutine

   ! The rigid trimer: x = 1/4 for equal masses, and the means over gamma in 0 .. 1/2 of (1 - gamma^2)^(-+1/2).
   subroutine partition_functions()
      real(real64) :: he, rigid, again, volume, expected
      integer :: stat
      character(100) :: message
      call test("partition functions")
      call hol_partition_function([1.0_real64, 1.0_real64, 1.0_real64], he, rigid, volume)
      expected = log(2*asin(0.5_real64))
      call check(abs(he - expected) <= 1e-13_real64, "He of the trimer is 2 arcsin(1/2)")
      expected = log(asin(0.5_real64) + 0.5_real64*sqrt(0.75_real64))
      call check(abs(rigid - expected) <= 1e-13_real64, "its rigid counterpart")
      call check(abs(volume - log(0.5_real64)) <= 4*eps, "its volume")
      call hol_partition_function(2, again)
      call check(abs(again - he) <= 1e-13_real64, "equal masses by the number of bonds")
      again = -7
      call hol_partition_function([1.0_real64, -1.0_real64], again, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "atom 2") > 0, "a negative mass")
      call hol_partition_function([1.0_real64, 0.0_real64, 0.0_real64], again, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_DEGENERATE .and. index(message, "bond 2") > 0, "two fixed neighbours")
      call hol_partition_function([1.0_real64], again, stat=stat)
      call check(stat == HOL_ERR_VALUE, "one atom")
      call hol_partition_function(3, stat=stat)
      call check(stat == HOL_ERR_NULL, "nothing asked")
      call check(same_bits(again, -7.0_real64), "nothing was written")
   end subroutine

   ! A rod of moment 2 and mass 2: two points of mass 1 at a distance of 1 from the centre.
   subroutine mass_points()
      real(real64) :: inertia(3, 3), masses(4), places(3, 4)
      integer :: n, stat
      character(200) :: message
      call test("mass points of an inertia tensor")
      inertia = 0
      inertia(2, 2) = 2
      inertia(3, 3) = 2
      masses = -7
      call hol_equimomental_points(2.0_real64, inertia, n, masses, places, centre=[5.0_real64, 6.0_real64, 7.0_real64])
      call check(n == 2 .and. all(abs(masses(:2) - 1) <= eps) .and. same_bits(masses(3), -7.0_real64), "two points")
      call check(abs(abs(places(1, 1) - 5) - 1) <= 8*eps .and. abs(places(1, 1) + places(1, 2) - 10) <= 16*eps .and. &
                 all(abs(places(2, :2) - 6) <= 8*eps), "on the axis, about the centre")
      inertia(2, 2) = 1
      call hol_equimomental_points(2.0_real64, inertia, n, masses, places, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. n == 0 .and. index(message, "sum of the others") > 0, "no such body")
   end subroutine

end program
