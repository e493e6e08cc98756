! Out of memory as Fortran sees it: every allocation of a call fails in turn, and stat says so; outputs stay as they were.
program test_memory
   use, intrinsic :: iso_c_binding, only: c_long
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use checks, only: check, finish, same_bits, test
   use holonomic
   implicit none
   integer, parameter :: n = 30
   real(real64) :: mass(n), length(n - 1), r(3, n), f(3, n)
   integer(int64) :: atoms(n)
   integer :: i

   interface
      ! tests/faults/failing_allocations.h: all allocations of the process go through there.
      subroutine fail_after(good) bind(c)
         import :: c_long
         integer(c_long), value :: good
      end subroutine
      subroutine fail_no_more() bind(c)
      end subroutine
   end interface

   mass = 1.5_real64
   length = 1
   atoms = [(int(i, int64), i=1, n)]
   do i = 1, n
      r(:, i) = real([(i + 2)/3, (i + 1)/3, i/3], real64)
      f(:, i) = real([mod(7*i, 5), mod(3*i, 4), 1], real64)
   end do
   call creation_and_adding()
   call forces()
   call molecules()
   call finish()

contains

   subroutine creation_and_adding()
      type(hol_chains) :: chains
      character(200) :: words
      integer :: good, stat
      call test("a handle is made or not made")
      do good = 0, 1000
         words = ""
         call fail_after(int(good, c_long))
         call chains%create(mass, stat=stat, errmsg=words)
         call fail_no_more()
         if (stat == HOL_OK) exit
         call check(stat == HOL_ERR_MEMORY, "create: stat is HOL_ERR_MEMORY")
         call check(index(words, "memory") > 0, "create: errmsg says so")
      end do
      call check(good > 0 .and. stat == HOL_OK, "create fails before it succeeds")
      do good = 0, 1000
         words = ""
         call fail_after(int(good, c_long))
         call chains%add(atoms, length, stat=stat, errmsg=words)
         call fail_no_more()
         if (stat == HOL_OK) exit
         call check(stat == HOL_ERR_MEMORY, "add: stat is HOL_ERR_MEMORY")
      end do
      call check(good > 0 .and. stat == HOL_OK, "add fails before it succeeds")
      call chains%destroy()
   end subroutine

   subroutine forces()
      type(hol_chains) :: chains
      real(real64) :: g(3, n), lambda(n - 1)
      character(200) :: words
      integer :: good, stat
      call test("forces are complete or untouched")
      call chains%create(mass)
      call chains%add(atoms, length)
      do good = 0, 1000
         words = ""
         g = -7
         lambda = -7
         call fail_after(int(good, c_long))
         call chains%forces(r, f=f, g=g, lambda=lambda, stat=stat, errmsg=words)
         call fail_no_more()
         if (stat == HOL_OK) exit
         call check(stat == HOL_ERR_MEMORY, "forces: stat is HOL_ERR_MEMORY")
         call check(index(words, "memory") > 0, "forces: errmsg says so")
         call check(all(same_bits(g, -7.0_real64)) .and. all(same_bits(lambda, -7.0_real64)), "nothing was written")
      end do
      call check(good > 0 .and. stat == HOL_OK, "forces fail before they succeed")
      call check(all(g > -7), "and are written then")
      call chains%destroy()
   end subroutine

   ! A comb: a tooth at every third atom.
   subroutine molecules()
      type(hol_chains) :: set
      integer(int64) :: bonds(2, n - 1)
      real(real64) :: g(3, n), lambda(n - 1), rhs(n - 1)
      character(200) :: words
      integer :: good, stat
      call test("bonds are added or not added")
      bonds = reshape([(merge(atoms(max(1, i - 2)), atoms(i - 1), mod(i, 3) == 1), atoms(i), i=2, n)], [2, n - 1])
      rhs = 1
      call set%create(mass)
      do good = 0, 1000
         words = ""
         call fail_after(int(good, c_long))
         call set%add(bonds, length, stat=stat, errmsg=words)
         call fail_no_more()
         if (stat == HOL_OK) exit
         call check(stat == HOL_ERR_MEMORY .and. set%n_bonds() == 0, "add: stat is HOL_ERR_MEMORY, nothing is added")
         call check(words == "add: out of memory", "add: errmsg says so")
      end do
      call check(good > 0 .and. stat == HOL_OK .and. set%n_of_shape(HOL_SHAPE_TREE) == 1, "add fails before it succeeds")
      call test("right-hand sides")
      do good = 0, 1000
         words = ""
         g = -7
         lambda = -7
         call fail_after(int(good, c_long))
         call set%solve(r, rhs, lambda, g, stat=stat, errmsg=words)
         call fail_no_more()
         if (stat == HOL_OK) exit
         call check(stat == HOL_ERR_MEMORY .and. words == "solve: out of memory", "solve: out of memory")
         call check(all(same_bits(g, -7.0_real64)) .and. all(same_bits(lambda, -7.0_real64)), "nothing was written")
      end do
      call check(stat == HOL_OK .and. all(lambda > -7), "solve succeeds with enough of it")
      call set%destroy()
   end subroutine

end program
