! A box that changes, what multipliers do, and labels in messages.
program test_motion
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use holonomic
   use checks
   implicit none
   integer, parameter :: n = 7
   real(real64), parameter :: L(3, 3) = reshape([0.1d0, 0.3d0, -0.2d0, 0.7d0, -0.4d0, 0.05d0, 0.6d0, 0.2d0, 0.25d0], [3, 3])
   ! Two chains, the second of which hangs from a fixed atom.
   real(real64), parameter :: masses(n) = [1d0, 2d0, 3d0, 0d0, 2d0, 1d0, 1d0]
   type(hol_chains) :: chains
   type(hol_worst) :: worst
   real(real64) :: r(3, n), v(3, n), before(3, n), lambda(5), tension(5), of_bonds(6, 5), virial(3, 3), g(3, n), sum_of(6)
   real(real32) :: r32(3, n), g32(3, n)
   real(real64) :: gx(n), gy(n), gz(n), d(3)
   character(200) :: message
   integer :: stat, k
   integer, parameter :: ends(2, 5) = reshape([1, 2, 2, 3, 4, 5, 5, 6, 6, 7], [2, 5])

   call random_init(.true., .true.)
   call random_number(before)
   do k = 1, n
      r(:, k) = [0.9d0*k, sin(2d0*k), cos(3d0*k)]
   end do
   before(:, 4) = 0
   call chains%create(masses)
   call chains%add(atoms=[1, 2, 3], lengths=1d0)
   call chains%add(atoms=[4, 5, 6, 7], lengths=1d0)

   call test("velocities in a box that changes")
   call chains%set_box_rate(L)
   v = before
   call chains%project_velocities(r, v, lambda, virial)
   do k = 1, 5
      d = r(:, ends(2, k)) - r(:, ends(1, k))
      call check(abs(dot_product(d, v(:, ends(2, k)) - v(:, ends(1, k)) + matmul(L, d))) < 64*eps, "rate of a bond")
   end do
   call chains%violation(r, v, worst=worst)
   call check(worst%rate < 64*eps, "the largest rate")

   call test("what multipliers do")
   call chains%reactions(r, lambda, tension, g, bond_virial=of_bonds)
   do k = 1, n
      if (masses(k) > 0) call check(all(abs(masses(k)*(v(:, k) - before(:, k)) - g(:, k)) < 256*eps), "impulse")
   end do
   call check(maxval(abs(sum(g(:, 4:), 2))) < 256*eps, "all of the impulses of a molecule, that of the fixed atom too")
   sum_of = sum(of_bonds, 2)
   call check(all(abs(sum_of - [virial(1, 1), virial(2, 1), virial(3, 1), virial(2, 2), virial(3, 2), virial(3, 3)]) &
                  < 256*eps), "virials of the bonds")
   do k = 1, 5
      d = r(:, ends(2, k)) - r(:, ends(1, k))
      call check(abs(tension(k) - 2*lambda(k)*norm2(d)) < 64*eps, "tension")
   end do
   call chains%reactions(r(1, :), r(2, :), r(3, :), lambda, gx=gx, gy=gy, gz=gz, reference=.true.)
   call check(all(same_bits(gx, g(1, :)) .and. same_bits(gz, g(3, :))), "separate arrays")
   call chains%reactions(r, lambda, g=g, add=.true.)
   call check(all(same_bits(g(2, :), 2*gy)), "added")
   r32 = real(r, real32)
   call chains%reactions(r32, lambda, g=g32)
   call check(maxval(abs(g32(1, :) - gx)) < 1e-5, "single precision")

   call test("forces in a box that changes")
   call chains%forces(r, before, g=g)
   do k = 1, 2 ! the free chain
      d = r(:, k + 1) - r(:, k)
      call check(abs(dot_product(d, g(:, k + 1)/masses(k + 1) - g(:, k)/masses(k)) &
                     + sum((before(:, k + 1) - before(:, k) + matmul(L, d))**2)) < 256*eps, "sigma''")
   end do

   call test("no rate")
   call chains%set_box_rate()
   v = before
   call chains%project_velocities(r, v)
   d = r(:, 2) - r(:, 1)
   call check(abs(dot_product(d, v(:, 2) - v(:, 1))) < 64*eps, "rate of a bond")

   call test("labels")
   v(2, 6) = ieee_value(1d0, ieee_quiet_nan)
   call chains%set_labels([101, 102, 103, 104, 105, 90210, 107])
   call chains%project_velocities(r, v, stat=stat, errmsg=message)
   call check(stat == HOL_ERR_NOT_FINITE .and. index(message, "atom 6 (label 90210)") > 0, trim(message))
   call chains%set_labels([integer(int64) ::], [55_int64, 2_int64**40])
   call chains%project_velocities(r, v, stat=stat, errmsg=message)
   call check(index(message, "molecule 2 (label 1099511627776): the velocity of atom 6 is") > 0, trim(message))
   call chains%set_labels()
   call chains%project_velocities(r, v, stat=stat, errmsg=message)
   call check(index(message, "molecule 2: the velocity of atom 6 is") > 0, trim(message))

   call test("arguments that do not fit")
   call chains%set_labels([1, 2, 3], stat=stat, errmsg=message)
   call check(stat == HOL_ERR_VALUE .and. index(message, "too few for 7 atoms") > 0, trim(message))
   call chains%reactions(r, lambda, bond_virial=of_bonds(:5, :), stat=stat, errmsg=message)
   call check(stat == HOL_ERR_VALUE .and. index(message, "6") > 0, trim(message))
   call chains%reactions(r, lambda, bond_virial=of_bonds(:, :4), stat=stat, errmsg=message)
   call check(stat == HOL_ERR_VALUE .and. index(message, "too few for 5 bonds") > 0, trim(message))
   call chains%reactions(r, lambda(:4), stat=stat, errmsg=message)
   call check(stat == HOL_ERR_VALUE .and. index(message, "lambda") > 0, trim(message))
   call chains%destroy()
   call chains%set_box_rate(L, stat=stat, errmsg=message)
   call check(stat == HOL_ERR_NULL .and. message == "set_box_rate: create has not been called", trim(message))
   call chains%set_labels(stat=stat, errmsg=message)
   call check(stat == HOL_ERR_NULL .and. message == "set_labels: create has not been called", trim(message))
   call chains%reactions(r, lambda, stat=stat, errmsg=message)
   call check(stat == HOL_ERR_NULL .and. message == "reactions: create has not been called", trim(message))
   call finish()

end program
