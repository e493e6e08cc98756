! All levels on molecules of any shape: against a dense solution in quadruple precision, against the equations, and
! against each other.
program test_graphs
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use checks, only: check, eps, finish, same_bits, test
   use dense_bonds, only: along_bonds, curvature, dense_multipliers, rates
   use holonomic
   implicit none

   ! A tree with a branch of branches (1 .. 10), a ring of six with a chord and a tail (11 .. 18), water (19 .. 21),
   ! rigid angles in a row (22 .. 26) and a chain (27 .. 30).
   integer, parameter :: n = 30, n_bonds = 31
   integer, parameter :: bonds(2, n_bonds) = reshape([ &
      1, 2, 2, 3, 3, 4, 3, 5, 2, 6, 6, 7, 6, 8, 6, 9, 1, 10, &
      11, 12, 12, 13, 13, 14, 14, 15, 15, 16, 16, 11, 16, 17, 17, 18, &
      20, 19, 19, 21, 21, 20, &
      22, 23, 23, 24, 24, 25, 25, 26, 22, 24, 23, 25, 24, 26, &
      28, 27, 28, 29, 29, 30, 11, 14], [2, n_bonds])
   type(hol_chains) :: set
   real(real64), dimension(3, n) :: r, v, f
   real(real64) :: mass(n), w(n), length(n_bonds)
   integer :: trial

   call random_init(.true., .true.)
   do trial = 1, 10
      call make_molecules()
      call forces_solve_the_dense_equations()
      call given_right_hand_sides()
      call velocities_become_tangent()
      call positions_reach_the_lengths()
      call order_of_bonds_does_not_matter()
      call layouts_give_the_same()
      call new_masses_and_lengths()
      call boxes_of_two_moments()
      call metric_is_a_potential()
      call inverse_times_matrix_is_one()
      call set%destroy()
   end do
   call finish()

contains

   ! Random, but every bond about 1 to 2 long and no angle flat: atoms on a random walk of the graph.
   subroutine make_molecules()
      real(real64) :: s(n), u(3)
      integer :: i, k
      call random_number(s)
      mass = 10**(2*s - 1)
      if (mod(trial, 2) == 0) mass([6, 13]) = 0   ! inside the tree, and in the ring
      w = 0
      where (mass > 0) w = 1/mass
      do i = 1, n
         call random_number(u)
         r(:, i) = modulo([0.9_real64, 0.7_real64, 0.5_real64]*i, [5.0_real64, 3.0_real64, 2.0_real64]) + 0.3_real64*u
      end do
      call random_number(v)
      call random_number(f)
      v = v - 0.5_real64
      where (spread(w, 1, 3) <= 0) v = 0
      f = f - 0.5_real64
      do k = 1, n_bonds
         length(k) = norm2(r(:, bonds(2, k)) - r(:, bonds(1, k)))
      end do
      call set%create(mass)
      call set%add(bonds=bonds, lengths=length)
   end subroutine

   ! Largest of what enters the sums, as the scale of their rounding.
   real(real64) function scale_of(a)
      real(real64), intent(in) :: a(:, :)
      scale_of = max(maxval(abs(a)), 1.0_real64)
   end function

   subroutine forces_solve_the_dense_equations()
      real(real64) :: lambda(n_bonds), exact(n_bonds), tension(n_bonds), g(3, n), a(3, n), virial(3, 3)
      call test("forces")
      exact = dense_multipliers(bonds, w, r, curvature(bonds, w, r, v, f))
      call set%forces(r, v, f, lambda, tension, g, virial=virial)
      ! Random angles keep the condition number, and so the amplification of rounding of the right-hand side, below some
      ! thousands.
      call check(maxval(abs(lambda - exact)) <= 1e4_real64*eps*maxval(abs(exact)), "solve the dense equations")
      call check(maxval(abs(g - along_bonds(bonds, lambda, r))) <= 32*eps*scale_of(g), "are those of the multipliers")
      call check(maxval(abs(tension - 2*lambda*length)) <= 8*eps*maxval(abs(tension)), "tensions too")
      a = spread(w, 1, 3)*(f + g)
      call check(maxval(abs(rates(bonds, r, a) + relative_squares())) <= 64*eps*scale_of(a)*scale_of(r), &
                 "no second derivative of a length")
      call check(maxval(abs(virial - matmul(r, transpose(g)))) <= 64*eps*scale_of(g)*scale_of(r), "virial is sum r G")
   end subroutine

   function relative_squares() result(squares)
      real(real64) :: squares(n_bonds)
      squares = sum((v(:, bonds(2, :)) - v(:, bonds(1, :)))**2, dim=1)
   end function

   subroutine given_right_hand_sides()
      real(real64) :: rhs(n_bonds), lambda(n_bonds), mu(n_bonds), exact(n_bonds), g(3, n), h(3, n), virial(3, 3)
      real(real64), dimension(n) :: gx, gy, gz
      call test("solve")
      rhs = curvature(bonds, w, r, v, f)
      call set%forces(r, v, f, lambda, g=g)
      call set%solve(r, rhs, mu, h)
      call check(maxval(abs(lambda - mu)) <= 1e4_real64*eps*maxval(abs(lambda)), "with the right-hand side of forces")
      call random_number(rhs)
      exact = dense_multipliers(bonds, w, r, rhs)
      call set%solve(r, rhs, lambda, g, virial=virial)
      call check(maxval(abs(lambda - exact)) <= 1e4_real64*eps*maxval(abs(exact)), "with any other")
      call check(maxval(abs(g - along_bonds(bonds, lambda, r))) <= 32*eps*scale_of(g), "forces of the multipliers")
      call check(maxval(abs(virial - matmul(r, transpose(g)))) <= 64*eps*scale_of(g)*scale_of(r), "virial")
      call check(maxval(abs(2*rates(bonds, r, spread(w, 1, 3)*g) + rhs)) <= 640*eps*scale_of(g)*scale_of(r), &
                 "sigma'' is minus the right-hand side")   ! 10: the largest w
      call set%solve(r(1, :), r(2, :), r(3, :), rhs, mu, gx, gy, gz)
      call check(all(same_bits(mu, lambda)) .and. all(same_bits(gy, g(2, :))), "separate arrays")
      h = f
      call set%solve(r, rhs, g=h, add=.true.)
      call check(all(same_bits(h, f + g)), "added to what is there")
   end subroutine

   subroutine velocities_become_tangent()
      real(real64) :: u(3, n), lambda(n_bonds), impulse(3, n)
      call test("velocities")
      u = v
      call set%project_velocities(r, u, lambda)
      call check(maxval(abs(rates(bonds, r, u))) <= 64*eps*scale_of(u)*scale_of(r), "no first derivative of a length")
      impulse = along_bonds(bonds, lambda, r)
      call check(maxval(abs(u - v - spread(w, 1, 3)*impulse)) <= 64*eps*scale_of(spread(w, 1, 3)*impulse), &
                 "the change is the impulse of the multipliers")
      call check(all(same_bits(u, v) .or. spread(w, 1, 3) > 0), "fixed atoms keep theirs")
   end subroutine

   subroutine positions_reach_the_lengths()
      real(real64) :: p(3, n), q(3, n), u(3, n), lambda(n_bonds), g(3, n)
      real(real64), parameter :: dt = 0.01_real64
      type(hol_report) :: report
      type(hol_worst) :: worst
      call test("positions")
      q = r + dt*v
      p = q
      u = v
      call set%project_positions(r, p, dt, u, lambda, report=report)
      call set%violation(p, worst=worst)
      call check(worst%length <= 32*eps*maxval(abs(r)), "to the rounding of the coordinates")
      call check(report%n_failed == 0 .and. report%n_corrected == set%n_molecules(), "report")
      g = along_bonds(bonds, lambda, r)
      call check(maxval(abs(p - q - dt**2*spread(w, 1, 3)*g)) <= 64*eps*maxval(abs(r)), &
                 "displaced by dt^2 w G along the bonds before")
      call check(maxval(abs(u - v - dt*spread(w, 1, 3)*g)) <= 64*eps*scale_of(dt*spread(w, 1, 3)*g), &
                 "velocities by the displacement over dt")
   end subroutine

   subroutine order_of_bonds_does_not_matter()
      type(hol_chains) :: other
      integer :: shuffled(2, n_bonds), k
      real(real64) :: g(3, n), h(3, n), lambda(n_bonds), mu(n_bonds), turned(n_bonds)
      call test("the order of the bonds")
      do k = 1, n_bonds   ! 7 and 31 have no common divisor; every third bond the other way round
         shuffled(:, k) = bonds(:, 1 + mod(7*k, n_bonds))
         if (mod(k, 3) == 0) shuffled(:, k) = shuffled([2, 1], k)
         turned(k) = length(1 + mod(7*k, n_bonds))
      end do
      call other%create(mass)
      call other%add(shuffled, turned)
      call set%forces(r, v, f, lambda, g=g)
      call other%forces(r, v, f, mu, g=h)
      call check(all(same_bits(g, h)), "forces")
      call check(all([(same_bits(mu(k), lambda(1 + mod(7*k, n_bonds))), k=1, n_bonds)]), &
                 "multipliers, in the order given")
      call other%destroy()
   end subroutine

   subroutine layouts_give_the_same()
      real(real64) :: g(3, n), wide(5, 2*n), lambda(n_bonds), mu(n_bonds)
      real(real32) :: r4(3, n), g4(3, n)
      call test("layouts")
      call set%forces(r, v, f, lambda, g=g)
      wide = -7
      call set%forces(r, v, f, mu, g=wide(2:4, ::2))
      call check(all(same_bits(wide(2:4, ::2), g)) .and. all(same_bits(mu, lambda)), "a section")
      call check(all(same_bits(wide(1, :), -7.0_real64)) .and. all(same_bits(wide(:, 2::2), -7.0_real64)), &
                 "and nothing else")
      r4 = real(r, real32)
      call set%forces(real(r4, real64), lambda=lambda, g=g)
      call set%forces(r4, lambda=mu, g=g4)
      call check(all(same_bits(mu, lambda)) .and. all(same_bits(g4, real(g, real32))), "single precision")
   end subroutine

   subroutine new_masses_and_lengths()
      type(hol_chains) :: other
      real(real64) :: g(3, n), h(3, n), p(3, n), q(3, n)
      integer :: stat
      character(200) :: message
      call test("new masses and lengths")
      call other%create(merge(1.0_real64, 0.0_real64, mass > 0))
      call other%add(bonds, 1.0_real64)
      call other%set_masses(mass)
      call other%set_lengths(length)
      call set%forces(r, v, f, g=g)
      call other%forces(r, v, f, g=h)
      call check(all(same_bits(g, h)), "the same forces as with those from the start")
      p = r + 0.01_real64*v
      q = p
      call set%project_positions(r, p, 0.01_real64)
      call other%project_positions(r, q, 0.01_real64)
      call check(all(same_bits(p, q)), "the same positions")
      call other%set_lengths(length(2:), stat, message)
      call check(stat == HOL_ERR_VALUE .and. message == "set_lengths: lengths has 30 elements, too few for 31 bonds", &
                 "too few lengths")
      call other%set_masses(mass(2:), stat, message)
      call check(stat == HOL_ERR_VALUE .and. message == "set_masses: masses has 29 elements, too few for 30 atoms", &
                 "too few masses")
      call other%set_masses(merge(0.0_real64, mass, [(mod(stat, 2) == 0, stat=1, n)]), stat, message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "atom") > 0, "what could move stays movable")
      call other%forces(r, v, f, g=h)
      call check(all(same_bits(g, h)), "nothing is changed by any of these")
      call other%destroy()
   end subroutine

   ! A barostat deforms the cell between r_ref and r; bonds cross its faces in both.
   subroutine boxes_of_two_moments()
      real(real64), parameter :: before(3) = [11.0_real64, 12.0_real64, 13.0_real64], after(3) = before*1.01_real64
      real(real64) :: p(3, n), q(3, n), r_wrapped(3, n), u(3, n), s(3, n)
      real(real64), parameter :: dt = 0.01_real64
      type(hol_worst) :: worst
      call test("a reference box")
      p = r + dt*v
      u = v
      call set%project_positions(r, p, dt, u)
      r_wrapped = modulo(r + 9, spread(before, 2, n))
      q = modulo(r + dt*v + 9, spread(after, 2, n))
      s = v
      call set%set_box(after)
      call set%set_reference_box(before)
      call set%project_positions(r_wrapped, q, dt, s)
      call set%violation(q, worst=worst)
      call check(worst%length <= 64*eps*maxval(after), "lengths in the new box")
      ! One solution for both but for the rounding of the wrapped coordinates, up to 13.
      call check(maxval(abs(s - u)) <= 1e-9_real64*scale_of(u), "as without any box")
      call set%set_reference_box()
      q = modulo(r + dt*v + 9, spread(after, 2, n))
      s = v
      call set%project_positions(modulo(r + 9, spread(after, 2, n)), q, dt, s)
      call check(maxval(abs(s - u)) <= 1e-9_real64*scale_of(u), "taken away: one box for both")
      call set%set_box()
   end subroutine

   subroutine metric_is_a_potential()
      real(real64) :: force(3, n), energy, up, down, moved(3, n), h
      real(real64) :: log_det(n)
      integer :: i, x
      call test("metric")
      call set%metric(r, 1.0_real64, log_det=log_det, energy=energy, force=force)
      call check(set%n_molecules() == 5 .or. mod(trial, 2) == 0, "five molecules, if no fixed atom cuts them")
      if (set%n_molecules() == 5) call check(abs(energy - sum(log_det(:5))/2) <= 16*eps*abs(energy), "energy is theirs")
      call check(maxval(abs(sum(force, dim=2))) <= 100*eps*scale_of(force), "no total force")
      h = 1e-4_real64
      do i = 1, n, 3
         x = 1 + mod(i + trial, 3)
         moved = r
         moved(x, i) = r(x, i) + h
         call set%metric(moved, 1.0_real64, energy=up)
         moved(x, i) = r(x, i) - h
         call set%metric(moved, 1.0_real64, energy=down)
         call check(abs((down - up)/(2*h) - force(x, i)) <= 1e-5_real64*scale_of(force), "force is minus its gradient")
      end do
   end subroutine

   ! With a unit vector as right-hand side, solve gives a column of the inverse.
   subroutine inverse_times_matrix_is_one()
      type(hol_inverse) :: inverse
      real(real64) :: rhs(n_bonds), lambda(n_bonds), row(n_bonds), condition
      integer(int64) :: list(n_bonds), m, molecule, k
      call test("inverse")
      molecule = 1
      call set%molecule(molecule, n_bonds=m)
      call set%bonds(molecule, list)
      call inverse%create(set, int(molecule), r)
      call check(inverse%n_bonds() == m, "of one molecule")
      do k = 1, m
         rhs = 0
         rhs(list(k)) = 1
         call set%solve(r, rhs, lambda)
         call inverse%row(int(k), row, HOL_PHYSICAL)
         call check(maxval(abs(row(:m) - lambda(list(:m)))) <= 1e4_real64*eps*maxval(abs(lambda)), "rows are solutions")
      end do
      call inverse%condition(condition)
      call check(condition > 1 .and. condition < 1e8_real64, "condition")
      call inverse%destroy()
   end subroutine

end program
