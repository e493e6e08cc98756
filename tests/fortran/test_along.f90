! Bond vectors in place of reference positions: the same results, in every layout.
program test_along
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic
   use checks, only: check, eps, finish, same_bits, test
   implicit none
   integer, parameter :: dp = real64, n = 7, n_bonds = 7
   integer, parameter :: pairs(2, n_bonds) = reshape([2, 1, 2, 3, 4, 3, 4, 5, 5, 6, 6, 4, 7, 6], [2, n_bonds])
   real(dp), parameter :: dt = 0.1_dp
   real(dp) :: r_ref(3, n), r(3, n), b(3, n_bonds), lengths(n_bonds), along(3, n), v(3, n), v_along(3, n)
   real(dp) :: x(n), y(n), z(n), vx(n), vy(n), vz(n), lambda(n_bonds), lambda_along(n_bonds), virial(3, 3), other(3, 3)
   real(real32) :: single(3, n)
   type(hol_chains) :: chains
   type(hol_report) :: report
   character(600) :: message
   integer :: i, stat

   call random_init(.true., .true.)
   call random_number(r_ref)
   r_ref = 3*r_ref
   b = r_ref(:, pairs(2, :)) - r_ref(:, pairs(1, :))
   lengths = [(norm2(b(:, i)), i=1, n_bonds)]
   call random_number(r)
   r = r_ref + 0.02_dp*(r - 0.5_dp)
   call chains%create([(1.0_dp + 0.1_dp*i, i=1, n)])
   call chains%add(bonds=pairs, lengths=lengths)

   call test("rows")
   along = r
   v = 0
   v_along = 0
   call chains%project_positions_along(b, along, dt, v_along, lambda_along, virial=other, report=report)
   call chains%project_positions(r_ref, r, dt, v, lambda, virial=virial)
   call check(maxval(abs(along - r)) <= 64*eps .and. maxval(abs(v_along - v)) <= 1000*eps, "positions and velocities")
   call check(maxval(abs(lambda_along - lambda)) <= 1e-9_dp*maxval(abs(lambda)), "multipliers")
   call check(maxval(abs(other - virial)) <= 1e-9_dp*maxval(abs(virial)), "virial")
   call check(report%n_corrected == 1 .and. report%max_error < 1e-13_dp, "report")

   call test("separate arrays")
   call drift(x, y, z)
   vx = 0
   vy = 0
   vz = 0
   call chains%project_positions_along(b(1, :), b(2, :), b(3, :), x, y, z, dt, vx, vy, vz)
   call drift(r(1, :), r(2, :), r(3, :))
   call chains%project_positions_along(b, r, dt)
   call check(all(same_bits(x, r(1, :))) .and. all(same_bits(z, r(3, :))), "the same bits")

   call test("single precision")
   single = real(r_ref, real32)
   single(1, 1) = single(1, 1) + 0.01_real32
   call chains%project_positions_along(real(b, real32), single, real(dt, real32))
   call check(abs(norm2(single(:, 1) - single(:, 2)) - lengths(1)) < 1e-5, "on its length")
   x = r_ref(1, :)
   call chains%project_positions_along(real(b(1, :), real32), real(b(2, :), real32), real(b(3, :), real32), &
                                       single(1, :), single(2, :), single(3, :), dt)

   call test("mistakes")
   r = r_ref
   call chains%project_positions_along(b(:, :3), r, dt, stat=stat, errmsg=message)
   call check(stat == HOL_ERR_VALUE .and. index(message, "b has 3 elements, too few for 7 bonds") > 0, trim(message))
   b(:, 5) = -b(:, 5)
   call chains%project_positions_along(b, r, dt, stat=stat, errmsg=message)
   call check(stat == HOL_ERR_DEGENERATE .and. index(message, "does not close its cycle") > 0, trim(message))
   b(:, 5) = -10*b(:, 5)
   call chains%set_checks(HOL_ALWAYS)
   call chains%project_positions_along(b, r, dt, stat=stat, errmsg=message)
   call check(stat == HOL_ERR_LENGTHS .and. index(message, "among the reference vectors") > 0, trim(message))
   call check(all(same_bits(r, r_ref)), "nothing is moved")
   call chains%destroy()
   call finish()

contains

   subroutine drift(to_x, to_y, to_z)
      real(dp), intent(out) :: to_x(n), to_y(n), to_z(n)
      integer :: k
      to_x = r_ref(1, :) + [(0.005_dp*mod(7*k, 5), k=1, n)]
      to_y = r_ref(2, :) - [(0.005_dp*mod(3*k, 4), k=1, n)]
      to_z = r_ref(3, :)
   end subroutine

end program
