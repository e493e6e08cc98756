! Compiled with -ffpe-trap=invalid,zero,overflow, as old codes are: all procedures come back, with good data and with bad,
! and what traps is what trapped before.
program test_traps
   use, intrinsic :: ieee_arithmetic, only: ieee_get_halting_mode, ieee_divide_by_zero, ieee_get_rounding_mode, &
      ieee_invalid, ieee_nearest, ieee_overflow, ieee_quiet_nan, ieee_round_type, ieee_set_rounding_mode, ieee_up, &
      ieee_value, operator(==)
   use, intrinsic :: iso_fortran_env, only: real64
   use checks, only: check, finish, same_bits, test
   use holonomic
   implicit none

   integer, parameter :: sheet(2, 12) = reshape([1, 2, 2, 3, 4, 5, 5, 6, 7, 8, 8, 9, 1, 4, 4, 7, 2, 5, 5, 8, 3, 6, 6, 9], [2, 12])
   integer, parameter :: star(2, 8) = reshape([1, 2, 1, 3, 1, 4, 1, 5, 1, 6, 1, 7, 1, 8, 1, 9], [2, 8])
   integer, parameter :: ring(2, 9) = reshape([1, 2, 2, 3, 3, 4, 4, 5, 5, 1, 1, 6, 6, 7, 7, 8, 6, 9], [2, 9])
   integer, parameter :: waters(2, 9) = reshape([1, 2, 2, 3, 3, 1, 4, 5, 5, 6, 6, 4, 7, 8, 8, 9, 9, 7], [2, 9])
   integer, parameter :: trees(2, 7) = reshape([1, 2, 1, 3, 1, 4, 5, 6, 5, 7, 5, 8, 8, 9], [2, 7])
   integer :: i

   call random_init(.true., .true.)
   call molecules("a chain", reshape([(i, i + 1, i=1, 8)], [2, 8]))
   call molecules("a sheet", sheet)
   call molecules("a star", star)
   call molecules("a ring with tails", ring)
   call molecules("waters", waters)
   call molecules("unlike trees", trees)
   call bodies()
   call rounding()
   call finish()

contains

   subroutine still_traps()
      logical :: invalid, zero, overflow
      call ieee_get_halting_mode(ieee_invalid, invalid)
      call ieee_get_halting_mode(ieee_divide_by_zero, zero)
      call ieee_get_halting_mode(ieee_overflow, overflow)
      call check(invalid .and. zero .and. overflow, "what trapped traps")
   end subroutine

   function scattered() result(r)
      real(real64) :: r(3, 9)
      integer :: atom
      call random_number(r)
      do atom = 1, 9
         r(:, atom) = r(:, atom) + 2*[mod(atom, 3), mod(atom/3, 3), 0]
      end do
   end function

   subroutine molecules(name, bonds)
      character(*), intent(in) :: name
      integer, intent(in) :: bonds(:, :)
      type(hol_chains) :: chains
      type(hol_report) :: report
      real(real64) :: r(3, 9), v(3, 9), f(3, 9), g(3, 9), moved(3, 9), a(size(bonds, 2)), lambda(size(bonds, 2))
      real(real64) :: box(3, 3), dt(3), length(size(bonds, 2)), rate(size(bonds, 2)), bad(3, 9)
      integer :: stat, k
      call test(name)
      r = scattered()
      call random_number(v)
      call random_number(f)
      a = norm2(r(:, bonds(2, :)) - r(:, bonds(1, :)), dim=1)
      box = 0
      box(1, 1) = 40
      box(2, 2) = 40   ! a slab
      call chains%create([(real(1 + mod(i, 3), real64), i=1, 9)])
      call chains%set_box(box)
      call chains%add(bonds=bonds, lengths=a)
      call chains%forces(r, v, f, lambda=lambda, g=g)
      call chains%solve(r, a, lambda)
      call chains%project_velocities(r, v)
      moved = r + 0.002_real64*v
      call chains%project_positions(r, moved, 0.002_real64, v)
      call chains%residuals(moved, v, length, rate)
      call check(maxval(abs(norm2(moved(:, bonds(2, :)) - moved(:, bonds(1, :)), dim=1)/a - 1)) < 1e-14_real64, "lengths")
      moved = r + 0.02_real64*f
      call chains%impose(moved, report)
      call check(report%n_failed == 0, "impose")
      call chains%metric(r, 1.0_real64, force=g)
      dt = [-1.0_real64, 0.0_real64, 1e-200_real64]
      do k = 1, 3
         call chains%project_positions(r, moved, dt(k), stat=stat)
         call check(stat == HOL_ERR_VALUE, "a dt that is none")
      end do
      bad = r
      bad(2, :) = ieee_value(1.0_real64, ieee_quiet_nan)
      call chains%forces(bad, g=g, stat=stat)
      call check(stat == HOL_ERR_NOT_FINITE, "positions that are no numbers")
      call still_traps()
      call chains%destroy()
   end subroutine

   subroutine bodies()
      type(hol_chains) :: chains
      real(real64) :: r(3, 9), f(3, 9), g(3, 9), rod(3, 3)
      integer :: b
      call test("rods")
      rod = 0
      rod(1, :) = [-1, 0, 1]
      do b = 1, 3
         r(:, 3*b - 2:3*b) = rod + 4*b
      end do
      call random_number(f)
      call chains%create([(1.0_real64, b=1, 9)])
      call chains%add_rigid_molecules(3, 3, 1, [1, 2, 3], rod)
      call chains%forces(r, f=f, g=g)
      call chains%project_velocities(r, f)
      call check(maxval(abs(f(1, [1, 4, 7]) - f(1, [3, 6, 9]))) < 1e-14_real64, "rods do not stretch")
      call still_traps()
      call chains%destroy()
   end subroutine

   ! The same bits as with the rounding that is the default.
   subroutine rounding()
      type(hol_chains) :: chains
      type(ieee_round_type) :: found
      real(real64) :: r(3, 9), f(3, 9), g(3, 9), h(3, 9)
      call test("rounding upward")
      r = scattered()
      call chains%create([(1.0_real64, i=1, 9)])
      call chains%add([(i, i=1, 9)], [(1.0_real64, i=1, 8)])
      call random_number(f)
      call chains%forces(r, f=f, g=g)
      call ieee_set_rounding_mode(ieee_up)
      call chains%forces(r, f=f, g=h)
      call ieee_get_rounding_mode(found)
      call ieee_set_rounding_mode(ieee_nearest)
      call check(found == ieee_up, "the rounding stays")
      call check(all(same_bits(g, h)), "the same bits")
      call chains%destroy()
   end subroutine

end program
