! The reference cases, through every layout of the arrays and both kinds of index lists.
program test_oracle
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use checks, only: check, eps, finish, same_bits, test
   use holonomic, only: hol_chains
   use oracle_case, only: read_names, read_reference, reference
   implicit none
   character(512) :: folder
   character(128), allocatable :: names(:)
   integer :: i

   call get_command_argument(1, folder)
   names = read_names(trim(folder))
   call test("the reference cases")
   call check(size(names) >= 26, "INDEX lists 26 cases or more")
   do i = 1, size(names)
      call references_are_met(trim(folder)//"/"//trim(names(i)))
   end do
   deallocate (names)
   call finish()

contains

   subroutine references_are_met(path)
      character(*), intent(in) :: path
      type(reference) :: c
      type(hol_chains) :: chains
      real(real64), allocatable :: lambda(:), tension(:), g(:, :), lambda_again(:), gx(:), gy(:), gz(:), length(:)
      real(real64) :: virial(3, 3), bound
      integer :: n, i

      call read_reference(path, c)
      call test(c%name)
      n = c%n_bonds
      allocate (length(n))
      length = norm2(c%r(:, 2:) - c%r(:, :n), dim=1)
      allocate (lambda(n), tension(n), lambda_again(n), g(3, n + 1), gx(n + 1), gy(n + 1), gz(n + 1))

      call chains%create(c%mass)
      call chains%add([(i, i=1, n + 1)], length)
      call chains%forces(c%r, c%v, c%f, lambda, tension, g, virial=virial)
      bound = (16 + sqrt(real(n, real64)))*eps
      call check(all(abs(lambda - c%lambda) <= bound*c%lambda_scale), "multipliers within the bound")
      call check(all(abs(g - c%g) <= bound*spread(c%g_scale, 1, 3)), "forces within the bound")
      call check(all(abs(virial - c%virial) <= bound*sum(2*c%lambda_scale*length**2)), "virial within the bound")
      ! Two roundings in the length and two in the product.
      call check(all(abs(tension - 2*lambda*length) <= 4*eps*abs(tension)), "tension is 2 lambda |d|")

      call chains%forces(c%r(1, :), c%r(2, :), c%r(3, :), c%v(1, :), c%v(2, :), c%v(3, :), c%f(1, :), c%f(2, :), &
                         c%f(3, :), lambda_again, gx=gx, gy=gy, gz=gz)
      call check(all(same_bits(lambda_again, lambda)), "separate arrays give the same multipliers")
      call check(all(same_bits(gx, g(1, :))) .and. all(same_bits(gy, g(2, :))) .and. all(same_bits(gz, g(3, :))), &
                 "separate arrays give the same forces")
      call chains%destroy()

      call chains%create(c%mass)
      call chains%add([(int(i, int64), i=1, n + 1)], length)
      call chains%forces(c%r, c%v, c%f, lambda_again)
      call check(all(same_bits(lambda_again, lambda)), "an index list of 64 bits gives the same")
      call chains%destroy()
   end subroutine

end program
