! Metric determinant and inverse: the reference cases, identities, and what happens to wrong arguments.
program test_metric
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use checks, only: check, eps, finish, same_bits, test
   use holonomic
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
   call layouts_of_the_metric()
   call metric_refuses()
   call parts_of_the_inverse_agree()
   call multipliers_are_within_their_bounds()
   call inverse_refuses()
   call copies_of_an_inverse_do_not_own()
   deallocate (names)
   call finish()

contains

   subroutine references_are_met(path)
      character(*), intent(in) :: path
      type(reference) :: c
      type(hol_chains) :: chains
      type(hol_inverse) :: inverse
      real(real64) :: log_det(1), energy, value, k_eps
      real(real64), allocatable :: force(:, :)
      integer :: n, i
      call read_reference(path, c)
      call test(c%name)
      n = c%n_bonds
      k_eps = (16 + sqrt(real(n, real64)))*eps
      allocate (force(3, n + 1))
      call chains%create(c%mass)
      call chains%add([(i, i=1, n + 1)], 1.0_real64)
      call chains%metric(c%r, 1.0_real64, log_det, energy=energy, force=force)
      call check(abs(log_det(1) - c%log_det) <= k_eps*abs(c%log_det), "ln det within the bound")
      call check(abs(energy - c%fixman_energy) <= k_eps*abs(c%fixman_energy), "Fixman energy within the bound")
      call check(all(abs(force - c%fixman_force) <= 2*k_eps*spread(c%fixman_scale, 1, 3)), "Fixman force within the bound")
      call inverse%create(chains, 1, c%r)
      call check(inverse%n_bonds() == n, "the inverse has a row for each bond")
      do i = 1, c%n_zinv
         associate (at => c%zinv_at(:, i))
            call inverse%entry(at(1), at(2), value)
            call check(abs(value - c%zinv(i)) <= (k_eps + 2*abs(at(1) - at(2))*eps)*abs(c%zinv(i)), &
                       "element of the inverse within the bound")
         end associate
      end do
      call inverse%destroy()
      call chains%destroy()
   end subroutine

   ! A bent chain of five bonds with unequal masses, and one of a single bond.
   subroutine make(chains, r)
      type(hol_chains), intent(inout) :: chains
      real(real64), intent(out) :: r(3, 8)
      integer :: i
      r = reshape([(i + 0.3_real64*mod(i*i, 7), 0.5_real64*mod(i*i, 5), 0.4_real64*mod(i*i*i, 6), i=1, 8)], [3, 8])
      call chains%create([1.0_real64, 2.0_real64, 0.5_real64, 3.0_real64, 1.0_real64, 4.0_real64, 1.0_real64, 1.0_real64])
      call chains%add([1, 2, 3, 4, 5, 6], 1.0_real64)
      call chains%add([8, 7], 1.0_real64)
   end subroutine

   subroutine layouts_of_the_metric()
      type(hol_chains) :: chains
      real(real64), dimension(3, 8) :: r, force, again
      real(real64), dimension(8) :: fx, fy, fz
      real(real32), dimension(3, 8) :: force4
      real(real64) :: log_det(2), log_det_z(2), again_det(2), energy, again_energy, expected(2)
      call test("layouts of the metric")
      call make(chains, r)
      again = 0
      force = 0
      call chains%metric(r, 2.0_real64, log_det, log_det_z, energy, force)
      call check(same_bits(log_det(2), 0.0_real64) .and. log_det(1) < 0, "one bond has ln det 0")
      call check(abs(energy - sum(log_det)) <= 4*eps*abs(energy), "energy is kT/2 times the sum")
      ! Z_kk = 4 (w_{k-1} + w_k) |d_k|^2 for the one bond of the second chain.
      expected(2) = log(8*sum((r(:, 7) - r(:, 8))**2))
      call check(abs(log_det_z(2) - expected(2)) <= 8*eps*abs(expected(2)), "ln det Z of one bond")
      call check(maxval(abs(sum(force, dim=2))) <= 16*eps*maxval(abs(force)), "no total force")
      call chains%metric(r(1, :), r(2, :), r(3, :), 2.0_real64, again_det, energy=again_energy, fx=fx, fy=fy, fz=fz)
      call check(all(same_bits(log_det, again_det)) .and. same_bits(energy, again_energy), "separate arrays: energies")
      call check(all(same_bits(fx(:6), force(1, :6))) .and. all(same_bits(fz(:6), force(3, :6))), "separate arrays: forces")
      again = 1
      call chains%metric(r, 2.0_real64, force=again, add=.true.)
      call check(all(same_bits(again, 1 + force)), "forces are added")
      call chains%metric(r, log_det=again_det)
      call check(all(same_bits(log_det, again_det)), "kt is not needed for ln det")
      r = real(real(r, real32), real64)
      call chains%metric(r, 2.0_real64, force=force)
      call chains%metric(real(r, real32), 2.0_real64, force=force4)
      call check(all(same_bits(real(force4, real64), real(real(force, real32), real64))), "single precision")
      call chains%destroy()
   end subroutine

   subroutine metric_refuses()
      type(hol_chains) :: chains
      real(real64) :: r(3, 8), force(3, 8), short(1), energy
      integer :: stat
      character(100) :: message
      call test("wrong arguments of metric")
      call make(chains, r)
      force = -7
      energy = -7
      short = -7
      call chains%metric(r, force=force, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "kt") > 0, "a force without kt")
      call chains%metric(r, -1.0_real64, energy=energy, force=force, stat=stat)
      call check(stat == HOL_ERR_VALUE, "a negative kt")
      call chains%metric(r, 1.0_real64, short, energy=energy, force=force, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "log_det has 1") > 0, "log_det too small")
      call chains%metric(r, 1.0_real64, energy=energy, force=force(:, :7), stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "force has 7") > 0, "force too small")
      call check(all(same_bits(force, -7.0_real64)) .and. same_bits(energy, -7.0_real64) .and. &
                 all(same_bits(short, -7.0_real64)), "nothing was written")
      call chains%destroy()
   end subroutine

   subroutine parts_of_the_inverse_agree()
      type(hol_chains) :: chains
      type(hol_inverse) :: inverse, separate
      real(real64) :: r(3, 8), matrix(5, 5), band(0:2, 5), row(5), value, z(5, 5), condition
      integer :: i, j, k
      call test("parts of the inverse")
      call make(chains, r)
      call inverse%create(chains, 1, r)
      call inverse%matrix(matrix)
      call inverse%band(band)
      do i = 1, 5
         call inverse%row(i, row)
         call check(all(abs(row - matrix(:, i)) <= 16*eps*abs(row)), "a row is a column of the matrix")
         do j = 1, 5
            call inverse%entry(i, j, value)
            call check(abs(value - matrix(i, j)) <= 16*eps*abs(value), "an entry is an element of the matrix")
         end do
         do k = 0, 2
            if (i + k <= 5) then
               call check(abs(band(k, i) - matrix(i, i + k)) <= 16*eps*abs(band(k, i)), "the band holds diagonals")
            else
               call check(same_bits(band(k, i), 0.0_real64), "and zeros past the end")
            end if
         end do
      end do
      call inverse%condition(condition)
      call check(condition >= 1, "a condition number")
      call inverse%matrix(matrix, HOL_PHYSICAL)
      call physical_matrix(r, z)
      z = matmul(z, matrix)
      do i = 1, 5
         z(i, i) = z(i, i) - 1
      end do
      call check(maxval(abs(z)) <= 100*condition*eps, "Z Z^-1 = 1")
      call separate%create(chains, 1, r(1, :), r(2, :), r(3, :))
      call separate%entry(2, 4, value, HOL_PHYSICAL)
      call check(same_bits(value, matrix(2, 4)) .or. abs(value - matrix(2, 4)) <= 16*eps*abs(value), "separate arrays")
      call separate%destroy()
      call inverse%destroy()
      call chains%destroy()
   end subroutine

   subroutine physical_matrix(r, z)
      real(real64), intent(in) :: r(3, 8)
      real(real64), intent(out) :: z(5, 5)
      real(real64) :: w(6), d(3, 5)
      integer :: k
      w = 1/[1.0_real64, 2.0_real64, 0.5_real64, 3.0_real64, 1.0_real64, 4.0_real64]
      d = r(:, 2:6) - r(:, :5)
      z = 0
      do k = 1, 5
         z(k, k) = 4*(w(k) + w(k + 1))*dot_product(d(:, k), d(:, k))
      end do
      do k = 2, 5
         z(k - 1, k) = -4*w(k)*dot_product(d(:, k - 1), d(:, k))
         z(k, k - 1) = z(k - 1, k)
      end do
   end subroutine

   subroutine multipliers_are_within_their_bounds()
      type(hol_chains) :: chains
      type(hol_inverse) :: inverse
      real(real64) :: r(3, 8), v(3, 8), f(3, 8), lambda(6), bound(5), again(5), relative, rough
      call test("error bounds of multipliers")
      call make(chains, r)
      call random_number(v)
      call random_number(f)
      call chains%forces(r, v, f, lambda)
      call inverse%create(chains, 1, r)
      call inverse%error_bound(lambda, v, f, bound, relative)
      call check(all(bound >= 0) .and. relative < 1e-13_real64, "those of the library have a small bound")
      call inverse%error_bound(lambda, v(1, :), v(2, :), v(3, :), f(1, :), f(2, :), f(3, :), again)
      call check(all(same_bits(again, bound)), "separate arrays")
      lambda(3) = lambda(3)*1.001_real64
      call inverse%error_bound(lambda, v, f, relative=rough)
      call check(rough > 1e-4_real64*abs(lambda(3))/maxval(abs(lambda)), "spoiled ones have a large bound")
      call chains%forces(r, v, lambda=lambda)
      call inverse%error_bound(lambda, v, relative=relative)
      call check(relative < 1e-13_real64, "without applied forces")
      call inverse%error_bound(0*lambda, bound)
      call check(all(bound <= 0), "at rest the multipliers are zero")
      call inverse%destroy()
      call chains%destroy()
   end subroutine

   subroutine inverse_refuses()
      type(hol_chains) :: chains
      type(hol_inverse) :: inverse
      real(real64) :: r(3, 8), value, small(4), square(4, 4)
      integer :: stat
      character(100) :: message
      call test("wrong arguments of the inverse")
      call make(chains, r)
      value = -7
      small = -7
      square = -7
      call inverse%entry(1, 1, value, stat=stat)
      call check(stat == HOL_ERR_NULL, "an inverse that was not created")
      call inverse%create(chains, 3, r, stat, message)
      call check(stat == HOL_ERR_INDEX .and. index(message, "molecule 3 is outside 1 .. 2") > 0, "there is no such molecule")
      call inverse%create(chains, 1, r(:, :7), stat, message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "r has 7") > 0, "r too small")
      call inverse%create(chains, 1, r)
      call inverse%create(chains, 1, r, stat, message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "created already") > 0, "creating twice")
      call inverse%entry(0, 1, value, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_INDEX .and. index(message, "1 .. 5") > 0, "there is no bond 0")
      call inverse%entry(1, 1, value, 17, stat)
      call check(stat == HOL_ERR_VALUE, "there is no scaling 17")
      call inverse%row(1, small, stat=stat)
      call check(stat == HOL_ERR_VALUE, "a row too small")
      call inverse%band(square, stat=stat)
      call check(stat == HOL_ERR_VALUE, "a band too small")
      call inverse%matrix(square, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "5 rows") > 0, "a matrix too small")
      call check(same_bits(value, -7.0_real64) .and. all(same_bits(small, -7.0_real64)) .and. &
                 all(same_bits(square, -7.0_real64)), "nothing was written")
      call inverse%destroy()
      call chains%destroy()
   end subroutine

   subroutine copies_of_an_inverse_do_not_own()
      type(hol_chains) :: chains
      type(hol_inverse) :: owner, copy
      real(real64) :: r(3, 8), a, b
      call test("copies of an inverse")
      call make(chains, r)
      call owner%create(chains, 1, r)
      call chains%destroy()
      call owner%entry(1, 2, a)
      copy = owner
      call copy%entry(1, 2, b)
      call check(same_bits(a, b), "refer to the same inverse")
      call copy%destroy()
      call owner%entry(1, 2, b)
      call check(same_bits(a, b), "are forgotten alone")
      call owner%destroy()
      call check(owner%n_bonds() == 0, "and the owner destroys it")
   end subroutine

end program
