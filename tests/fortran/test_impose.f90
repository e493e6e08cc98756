! Crude positions are moved onto the constraints, and what is left of each bond, in every form of arrays.
program test_impose
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use checks, only: check, finish, same_bits, test
   use holonomic
   implicit none
   integer, parameter :: n = 9
   type(hol_chains) :: chains
   type(hol_report) :: report
   real(real64) :: start(3, n), r(3, n), v(3, n), x(n), y(n), z(n), a(n - 1), length(n - 1), rate(n - 1), d(3, n - 1), short(2)
   real(real32) :: single(3, n)
   integer :: i, stat
   character(200) :: message

   call test("impose and residuals")
   call random_init(.true., .true.)
   call random_number(start)
   call random_number(v)
   start = 4*start
   a = [(1 + 0.1_real64*i, i=1, n - 1)]
   call chains%create([(real(i, real64), i=1, n)])
   call chains%add([(i, i=1, n)], a)

   r = start
   call chains%impose(r, report)
   d = r(:, 2:) - r(:, :n - 1)
   call check(maxval(abs(norm2(d, dim=1)/a - 1)) < 1e-14_real64, "lengths after impose")
   call check(report%n_corrected == 1 .and. report%iterations > 1, "the report of impose")
   call check(maxval(abs(matmul(r - start, [(real(i, real64), i=1, n)]))) < 1e-12_real64, "the centre of mass stays")
   x = start(1, :)
   y = start(2, :)
   z = start(3, :)
   call chains%impose(x, y, z)
   call check(all(same_bits(transpose(reshape([x, y, z], [n, 3])), r)), "separate arrays are the same")
   single = real(start, real32)
   call chains%impose(single)
   call check(maxval(abs(single - r)) < 1e-5_real64, "singles are nearly the same")

   call chains%residuals(start, v, length, rate)
   d = start(:, 2:) - start(:, :n - 1)
   call check(maxval(abs(length - (sum(d*d, dim=1)/a**2 - 1))) < 1e-13_real64, "residuals of lengths")
   call check(maxval(abs(rate - sum(d*(v(:, 2:) - v(:, :n - 1)), dim=1))) < 1e-13_real64, "residuals of rates")
   call chains%residuals(r, length=length)
   call check(maxval(abs(length)) < 1e-14_real64, "residuals after impose")
   call chains%residuals(r, length=short, stat=stat, errmsg=message)
   call check(stat == HOL_ERR_VALUE .and. index(message, "length has 2") > 0, "a list that is too short is refused")
   r = spread(r(:, 1), 2, n)
   call chains%impose(r, stat=stat, errmsg=message)
   call check(stat == HOL_ERR_DEGENERATE .and. index(message, "impose: ") == 1, "atoms on each other are refused")
   call chains%destroy()
   call finish()
end program
