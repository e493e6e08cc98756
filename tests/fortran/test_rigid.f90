! Rigid bodies through the module: one and many, with sites, bonds and both kinds of integers; errors name the procedure.
program test_rigid
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use checks, only: check, eps, finish, same_bits, test
   use holonomic
   implicit none
   real(real64), parameter :: co2(3, 3) = reshape([-1.16_real64, 0.0_real64, 0.0_real64, 0.0_real64, 0.0_real64, &
                                                   0.0_real64, 1.16_real64, 0.0_real64, 0.0_real64], [3, 3])

   call many_are_as_one_by_one()
   call a_bond_pulls_at_a_body()
   call lone_pairs_follow()
   call mistakes_are_named()
   call finish()

contains

   subroutine many_are_as_one_by_one()
      type(hol_chains) :: many, single
      real(real64) :: mass(9), r(3, 9), v(3, 9), g(3, 9), h(3, 9)
      integer :: b
      call test("many bodies")
      mass = [(merge(12.0_real64, 16.0_real64, mod(b, 3) == 2), b=1, 9)]
      do b = 1, 3
         r(:, 3*b - 2:3*b) = co2(:, :) + 4*b
      end do
      call random_number(v)
      call many%create(mass)
      call single%create(mass)
      call many%add_rigid_molecules(3, 3, 1, [1, 2, 3], co2)
      do b = 1, 3
         call single%add_rigid(int([3*b - 2, 3*b - 1, 3*b], int64), co2)
      end do
      call check(many%n_of_shape(HOL_SHAPE_RIGID) == 3 .and. many%n_kinds() == 1, "three of a kind")
      call check(many%degrees_of_freedom() == 15, "five freedoms each")
      call many%forces(r, v, g=g)
      call single%forces(r, v, g=h)
      call check(all(same_bits(g, h)), "as one by one")
      call many%destroy()
      call single%destroy()
   end subroutine

   subroutine a_bond_pulls_at_a_body()
      type(hol_chains) :: chains
      real(real64) :: r(3, 4), f(3, 4), tension(1)
      call test("a bond at a body")
      r = 0
      r(1, :) = [1, 2, 3, 0]
      f = 0
      f(1, 3) = 5
      call chains%create([1.0_real64, 2.0_real64, 0.0_real64, 0.0_real64])   ! a rod with a site, and a fixed atom
      call chains%add_rigid([1, 2, 3], r(:, :3), bonds=reshape([4, 1], [2, 1]), lengths=[1.0_real64])
      call chains%forces(r, f=f, tension=tension)
      call check(abs(tension(1) - 5) < 16*eps, "the tension is the force on the site")
      call chains%destroy()
   end subroutine

   subroutine lone_pairs_follow()
      type(hol_chains) :: chains
      real(real64) :: r(3, 4), from(3, 4), v(3, 4), f(3, 4), g(3, 4)

      call test("a site out of the plane")
      from = reshape([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2], [3, 4])*1.0_real64
      v = 0
      v(3, 1:3) = [0, 1, 0]     ! turns about the second axis
      v(:, 4) = 7               ! of a site: not looked at
      f = 0
      f(1, 4) = 1
      call chains%create([1.0_real64, 1.0_real64, 1.0_real64, 0.0_real64])
      call chains%add_rigid([1, 2, 3, 4], from)
      call chains%project_velocities(from, v)
      call check(all(abs(v(:, 4) - [-2, 0, 0]) < 8*eps), "its velocity")
      call chains%forces(from, f=f, g=g)
      call check(abs(sum(f(1, :) + g(1, :)) - 1) < 8*eps .and. abs(g(1, 4) + 1) < 2*eps, "the force is on the masses")
      call check(abs(sum(from(1, :)*(f(3, :) + g(3, :)) - from(3, :)*(f(1, :) + g(1, :))) + 2) < 16*eps, "and its torque")
      r = from + 0.01_real64*v
      call chains%project_positions(from, r, 0.01_real64)
      call check(abs(norm2(r(:, 4) - r(:, 1)) - 2) < 8*eps .and. abs(norm2(r(:, 4) - r(:, 2)) - sqrt(5.0_real64)) < 8*eps, &
                 "its place")
      call chains%destroy()
   end subroutine

   subroutine mistakes_are_named()
      type(hol_chains) :: chains
      integer :: stat
      character(400) :: message
      call test("mistakes")
      call chains%create([1.0_real64, 1.0_real64, 1.0_real64])
      call chains%add_rigid([1, 2], co2, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "add_rigid: places must be (3, 2)") == 1, "places")
      call chains%add_rigid([1, 2, 3], co2, sizes=[2, 2], stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "add_rigid: sizes") == 1, "sizes")
      call chains%add_rigid([1, 2, 3], co2, lengths=[1.0_real64], stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE, "lengths without bonds")
      call chains%add_rigid([1, 2, 4], co2, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_INDEX .and. index(message, "atom 4") > 0, "an atom that is not there")
      call check(chains%n_molecules() == 0, "nothing was added")
      call chains%destroy()
   end subroutine
end program
