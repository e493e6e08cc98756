! Ring polymers with rigid bonds, sampled with and without the Fixman potential.
!
! With it the bonds of a ring are distributed as those of the freely jointed ring: N unit steps that return to their start.
! These may be exchanged for one another, so that any two of them, neighbours or not, have the mean cosine -1/(N - 1), and
! the mean square radius of gyration is (N + 1)/12. Without it rigid neighbours prefer right angles.
!
!     ring_fixman [bonds=6] [molecules=400] [moves=600] [steps=8] [dt=0.12] [factor=1] [seed=1]
!
! The sampling is Hamiltonian Monte Carlo on the constraints: Maxwell velocities, projected; a short RATTLE trajectory;
! acceptance by the change of energy. It has no error of the time step. Bonds, masses and kT are 1. The rigid ring's own
! means are found once more from the run with the potential, by weights exp(+U_F/kT); the program fails if a mean is four
! standard errors off.
program ring_fixman
   use, intrinsic :: iso_fortran_env, only: dp => real64, error_unit
   use holonomic, only: hol_chains, HOL_ERR_NO_CONVERGENCE, HOL_OK, HOL_SHAPE_RING
   implicit none
   integer, parameter :: n_means = 4   ! cos and cos^2 of neighbours, cos^2 of next neighbours, radius of gyration^2
   character(*), parameter :: what(n_means) = [character(28) :: "mean cos, neighbours", "mean cos^2, neighbours", &
                                               "mean cos^2, next neighbours", "radius of gyration^2"]
   integer :: bonds = 6, molecules = 400, moves = 600, steps = 8, seed = 1
   real(dp) :: dt = 0.12_dp, factor = 1

   type(hol_chains) :: rings
   real(dp), allocatable, dimension(:, :) :: r, r_old, r_ref, v, f
   real(dp), allocatable, dimension(:) :: log_det, log_det_old, energy_old
   logical, allocatable :: failed(:)
   real(dp), dimension(n_means) :: rigid, rigid_error, free, free_error, weighted, weighted_error, off
   real(dp) :: expected(n_means), worst
   integer :: accepted, k

   call read_options()
   call make_rings()
   print "(i0, a, i0, a)", rings%n_of_shape(HOL_SHAPE_RING), " rings of ", bonds, " bonds"
   call sample(0.0_dp, rigid, rigid_error)
   print "(a, f5.1, a)", "without the Fixman potential: accepted ", 100*real(accepted)/(real(moves)*molecules), "%"
   call sample(factor, free, free_error, weighted, weighted_error)
   print "(a, f5.1, a)", "with the Fixman potential:    accepted ", 100*real(accepted)/(real(moves)*molecules), "%"
   expected = [-1/real(bonds - 1, dp), free(3), free(2), (bonds + 1)/12.0_dp]
   print "(a)", "                                 rigid          with the potential  freely jointed  rigid by weights"
   do k = 1, n_means
      print "(a, 2(f10.5, a, f7.5), f14.5, f12.5, a, f7.5)", what(k), rigid(k), " +-", rigid_error(k), free(k), " +-", &
         free_error(k), expected(k), weighted(k), " +-", weighted_error(k)
   end do
   off = abs(free - expected)/free_error
   off(2:3) = abs(free(2) - free(3))/norm2(free_error(2:3))
   worst = max(maxval(off), maxval(abs(rigid - weighted)/sqrt(rigid_error**2 + weighted_error**2)))
   print "(a, f6.2, a)", "largest deviation:", worst, " standard errors"
   print "(a, f6.2, a)", "what the potential does to neighbours:", &
      (free(2) - rigid(2))/norm2([free_error(2), rigid_error(2)]), " standard errors of cos^2"
   call rings%destroy()
   if (worst > 4) then
      write (error_unit, "(a)") "ring_fixman: the sampling is not what it should be"
      stop 1
   end if

contains

   subroutine make_rings()
      integer :: n, i
      real(dp) :: radius, angle
      real(dp), parameter :: pi = acos(-1.0_dp)
      n = bonds*molecules
      allocate (r(3, n), r_old(3, n), r_ref(3, n), v(3, n), f(3, n))
      allocate (log_det(molecules), log_det_old(molecules), energy_old(molecules), failed(molecules))
      radius = 0.5_dp/sin(pi/bonds)
      do i = 1, n
         angle = 2*pi*i/bonds
         r(:, i) = [radius*cos(angle), radius*sin(angle), 0.0_dp]
      end do
      call rings%create([(1.0_dp, i=1, n)])
      call rings%add_molecules(molecules, bonds, 1, reshape([(i, 1 + mod(i, bonds), i=1, bonds)], [2, bonds]), 1.0_dp)
      call random_seed(size=n)
      call random_seed(put=[(seed + 7919*i, i=1, n)])
   end subroutine

   ! Means over all moves but the first tenth, with the standard errors from the scatter of the molecules' means; `weighted`
   ! are those of the rigid ring, if the potential was there.
   subroutine sample(fixman, mean, error, weighted, weighted_error)
      real(dp), intent(in) :: fixman
      real(dp), intent(out) :: mean(n_means), error(n_means)
      real(dp), intent(out), optional :: weighted(n_means), weighted_error(n_means)
      real(dp), dimension(n_means, molecules) :: sums, weighted_sums
      real(dp) :: weights(molecules), now(n_means), weight
      integer :: move_number, m, samples
      sums = 0
      weighted_sums = 0
      weights = 0
      samples = 0
      accepted = 0
      call rings%metric(r, 1.0_dp, log_det=log_det, force=f)
      do move_number = 1, moves
         call move(fixman)
         if (10*move_number <= moves) cycle
         samples = samples + 1
         do m = 1, molecules
            now = measure(r(:, (m - 1)*bonds + 1:m*bonds))
            weight = exp(log_det(m)/2)
            sums(:, m) = sums(:, m) + now
            weighted_sums(:, m) = weighted_sums(:, m) + weight*now
            weights(m) = weights(m) + weight
         end do
      end do
      sums = sums/samples
      mean = sum(sums, dim=2)/molecules
      error = sqrt(sum((sums - spread(mean, 2, molecules))**2, dim=2)/(molecules*(molecules - 1.0_dp)))
      if (.not. present(weighted)) return
      weighted = sum(weighted_sums, dim=2)/sum(weights)
      weighted_error = sqrt(sum((weighted_sums - spread(weights, 1, n_means)*spread(weighted, 2, molecules))**2, dim=2)* &
                            molecules/(molecules - 1.0_dp))/sum(weights)
   end subroutine

   function measure(a) result(means)
      real(dp), intent(in) :: a(3, bonds)
      real(dp) :: means(n_means), d(3, bonds)
      d = cshift(a, 1, dim=2) - a
      means(1) = sum(d*cshift(d, 1, dim=2))/bonds
      means(2) = sum(sum(d*cshift(d, 1, dim=2), dim=1)**2)/bonds
      means(3) = sum(sum(d*cshift(d, 2, dim=2), dim=1)**2)/bonds
      means(4) = sum((a - spread(sum(a, dim=2)/bonds, 2, bonds))**2)/bonds
   end function

   ! One proposal for every ring.
   subroutine move(fixman)
      real(dp), intent(in) :: fixman
      real(dp) :: u(3, size(r, 2)), change
      integer :: step, m
      r_old = r
      log_det_old = log_det
      failed = .false.
      call random_number(u)
      call random_number(v)
      v = sqrt(-2*log(1 - u))*cos(2*acos(-1.0_dp)*v)
      call rings%project_velocities(r, v)
      energy_old = energies(fixman)
      do step = 1, steps   ! RATTLE
         v = v + dt/2*fixman*f
         r_ref = r
         r = r + dt*v
         call constrain()
         call rings%metric(r, 1.0_dp, log_det=log_det, force=f)
         v = v + dt/2*fixman*f
         call rings%project_velocities(r, v)
      end do
      u(1, :molecules) = energies(fixman)
      do m = 1, molecules
         change = u(1, m) - energy_old(m)
         call random_number(u(2, 1))
         if (.not. failed(m) .and. u(2, 1) < exp(-change)) then
            accepted = accepted + 1
         else
            r(:, (m - 1)*bonds + 1:m*bonds) = r_old(:, (m - 1)*bonds + 1:m*bonds)
         end if
      end do
      call rings%metric(r, 1.0_dp, log_det=log_det, force=f)
   end subroutine

   ! Kinetic energy plus fixman times U_F of each ring.
   function energies(fixman) result(energy)
      real(dp), intent(in) :: fixman
      real(dp) :: energy(molecules)
      integer :: m
      do m = 1, molecules
         energy(m) = sum(v(:, (m - 1)*bonds + 1:m*bonds)**2)/2 + fixman*log_det(m)/2
      end do
   end function

   ! Now and then a step is too long for a ring: the library leaves it as it was and says so. Its proposal will be
   ! rejected; until then it goes on from where the proposal began.
   subroutine constrain()
      integer :: stat, m
      character(200) :: message
      real(dp) :: d(3, bonds)
      call rings%project_positions(r_ref, r, dt, v, stat=stat, errmsg=message)
      if (stat == HOL_OK) return
      if (stat /= HOL_ERR_NO_CONVERGENCE) error stop "ring_fixman: an error that is not expected"
      do m = 1, molecules
         d = r(:, (m - 1)*bonds + 1:m*bonds)
         d = cshift(d, 1, dim=2) - d
         if (maxval(abs(sum(d**2, dim=1) - 1)) < 1e-8_dp) cycle
         failed(m) = .true.
         r(:, (m - 1)*bonds + 1:m*bonds) = r_old(:, (m - 1)*bonds + 1:m*bonds)
      end do
   end subroutine

   ! The words of the command line are the assignments of a namelist.
   subroutine read_options()
      integer :: i, status
      character(256) :: word, reason
      namelist /options/ bonds, molecules, moves, steps, seed, dt, factor
      do i = 1, command_argument_count()
         call get_command_argument(i, word)
         word = "&options "//trim(word)//" /"
         read (word, options, iostat=status, iomsg=reason)
         if (status == 0) cycle
         write (error_unit, "(4a)") "ring_fixman: ", trim(word), " ", trim(reason)
         stop 2
      end do
      if (bonds >= 5 .and. molecules >= 2 .and. moves >= 20 .and. steps >= 1 .and. dt > 0) return
      write (error_unit, "(a)") "ring_fixman: at least bonds=5 molecules=2 moves=20 steps=1, and dt above zero"
      stop 2
   end subroutine

end program
