! What docs/integrators.md says about the use of the three levels in a time step, measured on a chain of beads in a
! field of springs.
program test_integrators
   use, intrinsic :: iso_fortran_env, only: real64
   use checks, only: check, eps, finish, test
   use holonomic
   implicit none

   integer, parameter :: n = 10, n_bonds = n - 1
   real(real64), parameter :: total_time = 1
   type(hol_chains) :: chains
   real(real64), dimension(3, n) :: r0, v0
   real(real64) :: mass(n), w(n)
   integer :: i

   call random_init(.true., .true.)
   mass = [(1 + mod(i, 3), i=1, n)]
   w = 1/mass
   do i = 1, n
      r0(:, i) = [0.8_real64*i, 0.6_real64*mod(i, 2), 0.0_real64]
   end do
   call random_number(v0)
   v0 = v0 - 0.5_real64
   call chains%create(mass)
   call chains%add([(i, i=1, n)], 1.0_real64)
   call chains%project_velocities(r0, v0)

   call multipliers_of_velocity_verlet()
   call multipliers_of_leap_frog()
   call leap_frog_and_velocity_verlet_agree()
   call velocity_verlet_can_be_reversed()
   call brownian_multipliers_are_forces()
   call noise_makes_the_thermal_tension()
   call chains%destroy()
   call finish()

contains

   function force(r) result(f)
      real(real64), intent(in) :: r(3, n)
      real(real64) :: f(3, n)
      f = -r*spread([(1 + 0.3_real64*i, i=1, n)], 1, 3)
   end function

   function scaled(a) result(b)
      real(real64), intent(in) :: a(3, n)
      real(real64) :: b(3, n)
      b = a*spread(w, 1, 3)
   end function

   ! One step; multipliers of its first and of its second half.
   subroutine velocity_verlet(r, v, dt, lambda_r, lambda_v)
      real(real64), intent(inout) :: r(3, n), v(3, n)
      real(real64), intent(in) :: dt
      real(real64), intent(inout) :: lambda_r(n_bonds), lambda_v(n_bonds)
      real(real64) :: r_ref(3, n)
      v = v + dt/2*scaled(force(r))
      r_ref = r
      r = r + dt*v
      call chains%project_positions(r_ref, r, dt, v, lambda_r)
      v = v + dt/2*scaled(force(r))
      call chains%project_velocities(r, v, lambda_v)
   end subroutine

   ! At time t: twice the multipliers of the positions, and those of the velocities over dt/2, err to first order in dt,
   ! with opposite signs; their mean to second.
   subroutine multipliers_of_velocity_verlet()
      real(real64) :: r(3, n), v(3, n), dt, exact(n_bonds), r_half(n_bonds), v_half(n_bonds), unused(n_bonds), error(3, 2)
      integer :: halving, step, steps
      call test("velocity Verlet")
      do halving = 1, 2
         steps = 200*2**halving
         dt = total_time/steps
         r = r0
         v = v0
         do step = 1, steps
            call velocity_verlet(r, v, dt, unused, v_half)
         end do
         call chains%forces(r, v, force(r), exact)
         call velocity_verlet(r, v, dt, r_half, unused)
         r_half = 2*r_half
         v_half = v_half/(dt/2)
         error(:, halving) = [maxval(abs(r_half - exact)), maxval(abs(v_half - exact)), &
                              maxval(abs((r_half + v_half)/2 - exact))]/maxval(abs(exact))
      end do
      call check(all(error(:, 2) < 0.05_real64), "multipliers are those of the forces, nearly")
      call check(all(abs(error(:2, 1)/error(:2, 2) - 2) < 0.2_real64), "of the positions, and of the velocities: to first order")
      call check(abs(error(3, 1)/error(3, 2) - 4) < 0.4_real64, "their mean: to second order")
      print "(a, 3es10.2)", "velocity Verlet, relative errors of positions, velocities, mean: ", error(:, 2)
   end subroutine

   ! The multipliers of the step from t to t + dt are those of the forces at t, to second order.
   subroutine multipliers_of_leap_frog()
      real(real64) :: r(3, n), v(3, n), v_before(3, n), dt, exact(n_bonds), lambda(n_bonds), error(2)
      integer :: halving, step, steps
      call test("leap-frog")
      do halving = 1, 2
         steps = 200*2**halving
         dt = total_time/steps
         call start_leap_frog(r, v, dt)
         do step = 1, steps
            v_before = v
            call leap_frog(r, v, dt, lambda)
            if (step == steps) exit
         end do
         ! Positions of the beginning of that step, and the velocities there.
         r = r - dt*v
         call chains%forces(r, (v + v_before)/2, force(r), exact)
         error(halving) = maxval(abs(lambda - exact))/maxval(abs(exact))
      end do
      call check(error(2) < 1e-3_real64, "multipliers are those of the forces")
      call check(abs(error(1)/error(2) - 4) < 0.4_real64, "to second order")
      print "(a, es10.2)", "leap-frog, relative error: ", error(2)
   end subroutine

   ! v at dt/2.
   subroutine start_leap_frog(r, v, dt)
      real(real64), intent(out) :: r(3, n), v(3, n)
      real(real64), intent(in) :: dt
      real(real64) :: moved(3, n)
      r = r0
      v = v0 + dt/2*scaled(force(r))
      moved = r + dt*v
      call chains%project_positions(r, moved, dt, v)
      r = moved
   end subroutine

   subroutine leap_frog(r, v, dt, lambda)
      real(real64), intent(inout) :: r(3, n), v(3, n)
      real(real64), intent(in) :: dt
      real(real64), intent(inout) :: lambda(n_bonds)
      real(real64) :: r_ref(3, n)
      v = v + dt*scaled(force(r))
      r_ref = r
      r = r + dt*v
      call chains%project_positions(r_ref, r, dt, v, lambda)
   end subroutine

   subroutine leap_frog_and_velocity_verlet_agree()
      real(real64) :: r(3, n), v(3, n), q(3, n), u(3, n), unused(n_bonds), unused2(n_bonds)
      real(real64), parameter :: dt = 0.005_real64
      integer :: step
      call test("leap-frog and velocity Verlet")
      r = r0
      v = v0
      call velocity_verlet(r, v, dt, unused, unused2)
      call start_leap_frog(q, u, dt)
      do step = 2, 100
         call velocity_verlet(r, v, dt, unused, unused2)
         call leap_frog(q, u, dt, unused)
      end do
      ! Rounding of 100 steps, grown by the motion in half a unit of time.
      call check(maxval(abs(r - q)) < 1e4_real64*eps, "go through the same positions")
   end subroutine

   subroutine velocity_verlet_can_be_reversed()
      real(real64) :: r(3, n), v(3, n), unused(n_bonds), unused2(n_bonds)
      real(real64), parameter :: dt = 0.005_real64
      integer :: step
      call test("time reversal")
      r = r0
      v = v0
      do step = 1, 100
         call velocity_verlet(r, v, dt, unused, unused2)
      end do
      v = -v
      do step = 1, 100
         call velocity_verlet(r, v, dt, unused, unused2)
      end do
      call check(maxval(abs(r - r0)) < 1e4_real64*eps .and. maxval(abs(v + v0)) < 1e4_real64*eps, "leads back")
   end subroutine

   ! Overdamped motion, r' = (f + G)/zeta: frictions in place of masses and sqrt(dt) in place of dt make the multipliers
   ! those of the constraint forces, which hol_forces with velocities of zero gives.
   subroutine brownian_multipliers_are_forces()
      type(hol_chains) :: beads
      real(real64) :: r(3, n), exact(n_bonds), lambda(n_bonds), error(2), dt
      integer :: halving
      call test("Brownian dynamics without noise")
      call beads%create(mass)   ! frictions
      call beads%add([(i, i=1, n)], 1.0_real64)
      call beads%forces(r0, f=force(r0), lambda=exact)
      do halving = 1, 2
         dt = 1e-3_real64/2**halving
         r = r0 + dt*scaled(force(r0))
         call beads%project_positions(r0, r, sqrt(dt), lambda=lambda)
         error(halving) = maxval(abs(lambda - exact))/maxval(abs(exact))
      end do
      call check(error(2) < 0.01_real64 .and. abs(error(1)/error(2) - 2) < 0.2_real64, "multipliers are those of the forces")
      call beads%destroy()
   end subroutine

   ! A dumbbell that turns freely at temperature kT pulls at its bond with 2 kT/a, by its angular velocity. In Brownian
   ! dynamics there are no velocities, and the same mean tension comes from the noise in the multipliers.
   subroutine noise_makes_the_thermal_tension()
      integer, parameter :: n_dumbbells = 200000
      real(real64), parameter :: dt = 0.01_real64
      type(hol_chains) :: dumbbells
      real(real64), allocatable, dimension(:, :) :: r, q, a, b
      real(real64), allocatable, dimension(:) :: tension, lambda
      integer :: i
      call test("thermal tension")
      call dumbbells%create([(1.0_real64, i=1, 2*n_dumbbells)])
      call dumbbells%add(n_dumbbells, 1, 1, 1.0_real64)
      allocate (r(3, 2*n_dumbbells), source=0.0_real64)
      allocate (q(3, 2*n_dumbbells), a(3, 2*n_dumbbells), b(3, 2*n_dumbbells))
      allocate (tension(n_dumbbells), lambda(n_dumbbells))
      r(1, 2::2) = 1
      call random_number(a)
      call random_number(b)
      a = sqrt(-2*log(1 - a))*cos(2*acos(-1.0_real64)*b)
      ! The square of a relative velocity across the bond has the mean 2 times 2 and the standard deviation 4; the
      ! tension is half of it. Six standard errors.
      q = a
      call dumbbells%project_velocities(r, q)
      call dumbbells%forces(r, q, tension=tension)
      call check(abs(sum(tension)/n_dumbbells - 2) < 6*2/sqrt(real(n_dumbbells, real64)), "of velocities")
      ! Noise along the bond gives single multipliers a standard deviation of 1/sqrt(dt). The mean has an error of order dt.
      q = r + sqrt(2*dt)*a
      call dumbbells%project_positions(r, q, sqrt(dt), lambda=lambda)
      call check(abs(sum(2*lambda)/n_dumbbells - 2) < 6/sqrt(dt*n_dumbbells) + 4*dt, "of noise")
      print "(a, 2f8.4)", "thermal tension of velocities and of noise: ", sum(tension)/n_dumbbells, &
         sum(2*lambda)/n_dumbbells
      call dumbbells%destroy()
   end subroutine

end program
