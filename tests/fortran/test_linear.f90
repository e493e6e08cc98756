! Linear relations, and bonds whose images are told, through the module: a site of flexible atoms, atoms that are one point; errors name the procedure.
program test_linear
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use checks, only: check, eps, finish, test
   use holonomic
   implicit none

   call a_site_of_flexible_atoms()
   call mistakes_are_named()
   call images_are_told()
   call finish()

contains

   subroutine a_site_of_flexible_atoms()
      type(hol_chains) :: chains
      real(real64) :: r(3, 4), f(3, 4), g(3, 4)
      call test("a site of two flexible atoms, and a bond at it")
      r = reshape([0, 0, 0, 4, 0, 0, 1, 0, 0, 1, 2, 0], [3, 4])
      f = 0
      f(:, 3) = [1, 2, 3]
      call chains%create([1.0_real64, 2.0_real64, 0.0_real64, 1.0_real64])
      call chains%add_linear([1, 2, 3], [0.75_real64, 0.25_real64, -1.0_real64])
      call chains%forces(r, f=f, g=g)
      call check(maxval(abs(g(:, 1) - 0.75_real64*f(:, 3))) < 16*eps .and. maxval(abs(g(:, 3) + f(:, 3))) < 16*eps, &
                 "its force goes to the atoms")
      call check(chains%degrees_of_freedom() == 9, "it has no freedoms of its own")
      call chains%destroy()
      call chains%create([1.0_real64, 2.0_real64, 0.0_real64, 1.0_real64])
      call chains%add_linear_molecules(1, 3, 1, [1, 2, 3], [0.75_real64, 0.25_real64, -1.0_real64])
      call chains%forces(r, f=f, g=g)
      call check(maxval(abs(g(:, 1) - 0.75_real64*f(:, 3))) < 16*eps .and. chains%degrees_of_freedom() == 9, &
                 "as one of many copies")
      call chains%destroy()
      call chains%create([1.0_real64, 2.0_real64, 3.0_real64, 1.0_real64])
      call chains%add_linear([1_int64, 2_int64, 3_int64], [0.75_real64, 0.25_real64, -1.0_real64], &
                             bonds=reshape([3_int64, 4_int64], [2, 1]), lengths=[2.0_real64])
      call chains%forces(r, f=f, g=g)
      call check(maxval(abs(sum(g, 2))) < 64*eps, "pulls add up to nothing")
      g = f + g
      call check(maxval(abs(0.75_real64*g(:, 1) + 0.25_real64*g(:, 2)/2 - g(:, 3)/3)) < 64*eps, "accelerations obey it")
      call check(abs(g(2, 4) - g(2, 3)/3) < 64*eps, "and the bond keeps its length")
      call chains%destroy()
   end subroutine

   subroutine mistakes_are_named()
      type(hol_chains) :: chains
      integer :: stat
      character(400) :: message
      call test("mistakes")
      call chains%create([1.0_real64, 1.0_real64])
      call chains%add_linear([1, 2], [1.0_real64, 1.0_real64], stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "add_linear") > 0 .and. index(message, "add up to 0") > 0, &
                 trim(message))
      call chains%add_linear([1, 2], [1.0_real64], stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "1 coefficients were given") > 0, trim(message))
      call chains%add_linear([1, 2], [1.0_real64, -1.0_real64], bonds=reshape([1, 2], [2, 1]), stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "together") > 0, trim(message))
      call chains%destroy()
   end subroutine

   ! A bond of 7 in a box of 11, whose second atom is one box vector further on.
   subroutine images_are_told()
      type(hol_chains) :: chains
      real(real64) :: r(3, 2), f(3, 2), tension(1)
      integer :: found(3, 1), stat
      integer(int64) :: wide(3, 1)
      character(200) :: message
      call test("bonds whose images are told")
      r = reshape([9, 5, 5, 5, 5, 5], [3, 2])
      f = reshape([-2, 0, 0, 2, 0, 0], [3, 2])
      call chains%create([1.0_real64, 1.0_real64])
      call chains%set_box([11.0_real64, 11.0_real64, 11.0_real64])
      call chains%add_with_images(reshape([1, 2], [2, 1]), [7.0_real32], reshape([1, 0, 0], [3, 1]))
      call chains%forces(r, f=f, tension=tension)
      call check(abs(tension(1) - 2) <= 16*eps, "its tension")
      wide(:, 1) = [0, 0, 0]
      call chains%set_images(wide)
      r(1, 2) = 16
      call chains%forces(r, f=f, tension=tension)
      call chains%images(found)
      call check(abs(tension(1) - 2) <= 16*eps .and. all(found == 0), "where the atom has been moved")
      call chains%set_images(reshape([1, 0], [2, 1]), stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "images must be (3, 1)") > 0, trim(message))
      call chains%destroy()
   end subroutine

end program
