! The three levels on random chains with fixed atoms: against a dense solution in quadruple precision, against the
! equations that they solve, and against each other.
program test_levels
   use, intrinsic :: iso_fortran_env, only: real128, real64
   use checks, only: check, eps, finish, same_bits, test
   use holonomic
   implicit none

   ! Where a compiler has no quadruple precision, double has to do.
   integer, parameter :: qp = merge(real128, real64, real128 > 0)
   integer, parameter :: n = 12, n_bonds = n - 1
   type(hol_chains) :: chains
   real(real64), dimension(3, n) :: r, v, f
   real(real64) :: mass(n), w(n), length(n_bonds)
   integer :: trial, i

   call random_init(.true., .true.)
   do trial = 1, 20
      call make_chain()
      call forces_solve_the_dense_equations()
      call forces_keep_the_lengths()
      call velocities_become_tangent()
      call positions_reach_the_lengths()
      call multipliers_of_small_steps_are_forces()
      call a_guess_saves_iterations()
      call chains%destroy()
   end do
   call finish()

contains

   subroutine make_chain()
      real(real64) :: u(3, n), s(n)
      call random_number(u)
      call random_number(s)
      length = 0.5_real64 + s(:n_bonds)
      u = u - 0.5_real64
      r(:, 1) = 0
      do i = 2, n
         r(:, i) = r(:, i - 1) + length(i - 1)*u(:, i)/norm2(u(:, i))
      end do
      length = norm2(r(:, 2:) - r(:, :n_bonds), dim=1)
      call random_number(s)
      mass = 10**(2*s - 1)
      ! One end held in a part of the trials, an atom within the chain in others.
      if (mod(trial, 3) == 1) mass(1) = 0
      if (mod(trial, 3) == 2) mass(5) = 0
      w = 0
      where (mass > 0) w = 1/mass
      call random_number(v)
      call random_number(f)
      v = v - 0.5_real64
      where (spread(w, 1, 3) <= 0) v = 0
      f = f - 0.5_real64
      call chains%create(mass)
      call chains%add([(i, i=1, n)], length)
   end subroutine

   ! 2 (lambda_{i+1} d_{i+1} - lambda_i d_i)
   function along_bonds(lambda, from) result(g)
      real(real64), intent(in) :: lambda(:), from(:, :)
      real(real64) :: g(3, n), pull(3)
      integer :: k
      g = 0
      do k = 1, n_bonds
         pull = 2*lambda(k)*(from(:, k + 1) - from(:, k))
         g(:, k) = g(:, k) + pull
         g(:, k + 1) = g(:, k + 1) - pull
      end do
   end function

   ! The largest of what enters the sums, as the scale of their rounding.
   real(real64) function scale_of(a)
      real(real64), intent(in) :: a(:, :)
      scale_of = max(maxval(abs(a)), 1.0_real64)
   end function

   subroutine forces_solve_the_dense_equations()
      real(qp) :: z(n_bonds, n_bonds), b(n_bonds), d(3, n_bonds), wq(n)
      real(real64) :: lambda(n_bonds)
      integer :: k, l
      call test("forces solve Z lambda = K + C")
      wq = 0
      where (mass > 0) wq = 1/real(mass, qp)
      d = real(r(:, 2:), qp) - real(r(:, :n_bonds), qp)
      z = 0
      do k = 1, n_bonds
         z(k, k) = 4*(wq(k) + wq(k + 1))*dot_product(d(:, k), d(:, k))
         b(k) = 2*dot_product(d(:, k), wq(k + 1)*f(:, k + 1) - wq(k)*f(:, k)) &
                + 2*sum((real(v(:, k + 1), qp) - v(:, k))**2)
      end do
      do k = 2, n_bonds
         z(k - 1, k) = -4*wq(k)*dot_product(d(:, k - 1), d(:, k))
         z(k, k - 1) = z(k - 1, k)
      end do
      do k = 1, n_bonds   ! Gauss, without pivoting: Z is positive definite
         do l = k + 1, n_bonds
            b(l) = b(l) - z(l, k)/z(k, k)*b(k)
            z(l, :) = z(l, :) - z(l, k)/z(k, k)*z(k, :)
         end do
      end do
      do k = n_bonds, 1, -1
         b(k) = (b(k) - dot_product(z(k, k + 1:), b(k + 1:)))/z(k, k)
      end do
      call chains%forces(r, v, f, lambda)
      ! Random angles keep the condition number, and so the amplification of rounding, below some hundreds.
      call check(maxval(abs(lambda - b)) <= 1000*eps*maxval(abs(b)), "as a dense solution does")
   end subroutine

   subroutine forces_keep_the_lengths()
      real(real64) :: lambda(n_bonds), tension(n_bonds), g(3, n), virial(3, 3), a(3, n), sum_virial(3, 3)
      integer :: k
      call test("forces keep the lengths")
      call chains%forces(r, v, f, lambda, tension, g, virial=virial)
      a = spread(w, 1, 3)*(f + g)
      do k = 1, n_bonds
         call check(abs(dot_product(r(:, k + 1) - r(:, k), a(:, k + 1) - a(:, k)) + sum((v(:, k + 1) - v(:, k))**2)) &
                    <= 64*eps*scale_of(a), "no second derivative of a length")
      end do
      call check(maxval(abs(g - along_bonds(lambda, r))) <= 16*eps*scale_of(g), "forces are those of the multipliers")
      call check(maxval(abs(tension - 2*lambda*length)) <= 8*eps*maxval(abs(tension)), "tensions too")
      call check(maxval(abs(sum(g, dim=2))) <= 2*n*eps*scale_of(g), "no total force")
      sum_virial = matmul(r, transpose(g))
      call check(maxval(abs(virial - sum_virial)) <= 64*eps*scale_of(g)*scale_of(r), "virial is sum r G")
   end subroutine

   subroutine velocities_become_tangent()
      real(real64) :: u(3, n), lambda(n_bonds), virial(3, 3), impulse(3, n), relative
      integer :: k
      call test("velocities become tangent")
      u = v
      call chains%project_velocities(r, u, lambda, virial)
      relative = sqrt(sum((u(:, 2:) - u(:, :n_bonds))**2)/n_bonds)
      do k = 1, n_bonds
         call check(abs(dot_product(r(:, k + 1) - r(:, k), u(:, k + 1) - u(:, k))) <= 64*eps*max(relative, 1.0_real64), &
                    "no first derivative of a length")
      end do
      impulse = along_bonds(lambda, r)
      call check(maxval(abs(u - v - spread(w, 1, 3)*impulse)) <= 64*eps*scale_of(spread(w, 1, 3)*impulse), &
                 "the change is the impulse of the multipliers")
      call check(all(same_bits(u, v) .or. spread(w, 1, 3) > 0), "fixed atoms keep theirs")
      call check(maxval(abs(virial - matmul(r, transpose(impulse)))) <= 64*eps*scale_of(impulse)*scale_of(r), &
                 "virial is sum r (m dv)")
   end subroutine

   subroutine positions_reach_the_lengths()
      real(real64) :: q(3, n), p(3, n), u(3, n), lambda(n_bonds), virial(3, 3), g(3, n)
      real(real64), parameter :: dt = 0.02_real64
      type(hol_report) :: report
      type(hol_worst) :: worst
      call test("positions reach the lengths")
      q = r + dt*v
      p = q
      u = v
      call chains%project_positions(r, p, dt, u, lambda, virial=virial, report=report)
      call chains%violation(p, worst=worst)
      ! Coordinates up to 10 or so carry 10 eps/2 each, in bonds of a half and more.
      call check(worst%length <= 32*eps*maxval(abs(r)), "to the rounding of the coordinates")
      call check(report%n_corrected == 1 .and. report%n_failed == 0 .and. report%iterations <= 5, "report")
      g = along_bonds(lambda, r)
      call check(maxval(abs(p - q - dt**2*spread(w, 1, 3)*g)) <= 16*eps*maxval(abs(r)) + &
                 64*eps*dt**2*scale_of(spread(w, 1, 3)*g), "the displacement is dt^2 w G, along the bonds before")
      call check(maxval(abs(u - v - dt*spread(w, 1, 3)*g)) <= 64*eps*scale_of(dt*spread(w, 1, 3)*g), &
                 "velocities get the displacement over dt")
      call check(maxval(abs(virial - matmul(r, transpose(g)))) <= 64*eps*scale_of(g)*scale_of(r), &
                 "virial is sum r_ref G")
   end subroutine

   ! Leap-frog: r + dt v with v = v(t - dt/2) + dt w f. There the multipliers are those of the force, in velocity Verlet,
   ! whose v is v(t) + dt/2 w f, half of them; both up to a difference of first order in dt.
   subroutine multipliers_of_small_steps_are_forces()
      real(real64) :: u(3, n), q(3, n), exact(n_bonds), lambda(n_bonds), error(2, 2), dt(2), before(3, n)
      integer :: step
      call test("multipliers of small steps")
      u = v
      call chains%project_velocities(r, u)
      call chains%forces(r, u, f, exact)
      dt = [1e-3_real64, 0.5e-3_real64]
      do step = 1, 2
         q = r + dt(step)*(u + dt(step)/2*spread(w, 1, 3)*f)
         call chains%project_positions(r, q, dt(step), lambda=lambda)
         error(1, step) = maxval(abs(2*lambda - exact))
         ! Half a step back along the motion that the constraints allow.
         before = u - dt(step)/2*spread(w, 1, 3)*(f + along_bonds(exact, r))
         q = r + dt(step)*(before + dt(step)*spread(w, 1, 3)*f)
         call chains%project_positions(r, q, dt(step), lambda=lambda)
         error(2, step) = maxval(abs(lambda - exact))
      end do
      call check(all(error(:, 1) < 0.2_real64*max(1.0_real64, maxval(abs(exact)))), "are those of the forces, nearly")
      call check(all(error(:, 2) < 0.6_real64*error(:, 1)), "and half a step halves the difference")
   end subroutine

   subroutine a_guess_saves_iterations()
      real(real64) :: q(3, n), lambda(n_bonds)
      real(real64), parameter :: dt = 0.02_real64
      type(hol_report) :: without, with
      call test("a guess")
      q = r + dt*v
      call chains%project_positions(r, q, dt, lambda=lambda, report=without)
      q = r + dt*v
      call chains%project_positions(r, q, dt, lambda=lambda, guess=.true., report=with)
      call check(with%iterations < without%iterations .or. without%iterations == 1, "that is right saves iterations")
   end subroutine

end program
