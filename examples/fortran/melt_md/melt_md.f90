! Molecular dynamics of a melt of bead-rod chains: rigid bonds of length 1, repulsive beads of mass 1, in a periodic
! cube. Energies in units of epsilon, lengths in sigma. After a thermostatted run that melts the first configuration,
! energy, momentum, bond lengths, temperature and pressure are followed at constant energy.
!
!     melt_md [name=value ...]
!
!     chains=64 beads=32 density=0.61 dt=0.005
!     melt=20000              steps with the thermostat at kT = 1
!     steps=20000             steps at constant energy
!     threads=1               threads of the library
!
! The pressure is printed three times, from three constraint virials that the library offers: from the constraint forces
! of the instant (`forces`), from the correction of the positions and from that of the velocities; docs/integrators.md
! says why the averages agree.
program melt_md
   use, intrinsic :: iso_fortran_env, only: dp => real64, error_unit
   use holonomic, only: hol_chains, hol_instruction_set, hol_version, hol_worst
   use melt_pairs, only: pair_list, pair_forces, update_list
   use melt_start, only: place_chains, thermal_velocities
   implicit none
   integer :: n_chains = 64, n_beads = 32, melt_steps = 20000, steps = 20000, threads = 1
   real(dp) :: density = 0.61_dp, dt = 0.005_dp

   type(hol_chains) :: chains
   type(pair_list) :: list
   type(hol_worst) :: worst
   real(dp), allocatable :: r(:, :), v(:, :), f(:, :), r_ref(:, :), lambda(:)
   real(dp) :: box, energy, pair_virial, drift_virial(3, 3), kick_virial(3, 3), instant_virial(3, 3)
   real(dp) :: degrees_of_freedom, kinetic, total, bond_error, rate
   real(dp) :: momentum(3), momentum_error, temperature_sum, pressure_sum(3)
   real(dp), allocatable :: time(:), energies(:)
   integer :: n, step, every, samples
   logical :: fits

   call read_options()
   n = n_chains*n_beads
   box = (n/density)**(1/3.0_dp)
   allocate (r(3, n), v(3, n), f(3, n), r_ref(3, n), lambda(n_chains*(n_beads - 1)))
   call place_chains(n_chains, n_beads, box, r, fits)
   if (.not. fits) call stop_with("the box is too small for these chains: choose a smaller density")

   call chains%create(spread(1.0_dp, 1, n))
   call chains%add(n_chains, n_beads - 1, 1, 1.0_dp)
   call chains%set_box([box, box, box])
   call chains%set_threads(threads)
   lambda = 0
   call thermal_velocities(v)
   call update_list(list, box, n_beads, r)
   call chains%project_velocities(r, v)
   call pair_forces(list, box, r, f, energy, pair_virial)

   print "(5a)", "holonomic ", hol_version(), " (", hol_instruction_set(), ")"
   print "(i0, a, i0, a, f0.4, a, f0.4)", n_chains, " chains of ", n_beads, " beads, density ", density, ", box ", box
   do step = 1, melt_steps
      call advance()
      call thermostat()
   end do
   print "(a, i0, a)", "melted in ", melt_steps, " steps"

   ! A bath has left some momentum. It is taken out, stays zero, and is three degrees of freedom less.
   v = v - spread(sum(v, dim=2)/n, 2, n)
   degrees_of_freedom = real(chains%degrees_of_freedom() - 3, dp)
   print "(a, i0, a, i0, a)", "degrees of freedom    ", nint(degrees_of_freedom), " in the temperature, of ", 3*n, &
      " coordinates"
   print "(a)", "      time    E/bead            kT       bond error   pressure"

   every = max(1, steps/1000)
   allocate (time(steps/every), energies(steps/every))
   samples = 0
   bond_error = 0
   rate = 0
   momentum_error = 0
   temperature_sum = 0
   pressure_sum = 0
   do step = 1, steps
      call advance()
      call chains%violation(r, v, worst)
      bond_error = max(bond_error, worst%length)
      rate = max(rate, worst%rate)
      momentum = sum(v, dim=2)
      momentum_error = max(momentum_error, maxval(abs(momentum)))
      if (mod(step, every) == 0) call observe()
   end do
   call conclude()
   call chains%destroy()

contains

   ! Velocity Verlet (RATTLE).
   subroutine advance()
      v = v + dt/2*f
      ! The reference positions are those before the drift, in the same periodic images as the beads are now.
      r_ref = r
      r = r + dt*v
      call chains%project_positions(r_ref, r, dt, v, lambda, guess=.true., virial=drift_virial)
      call update_list(list, box, n_beads, r)
      call pair_forces(list, box, r, f, energy, pair_virial)
      v = v + dt/2*f
      call chains%project_velocities(r, v, virial=kick_virial)
   end subroutine

   ! Exact solution of friction 1 with noise, followed by a projection: the velocities of rigid chains at kT = 1.
   subroutine thermostat()
      real(dp) :: noise(3, n)
      call thermal_velocities(noise)
      v = exp(-dt)*v + sqrt(1 - exp(-2*dt))*noise
      call chains%project_velocities(r, v)
   end subroutine

   subroutine observe()
      real(dp) :: pressure(3)
      call chains%forces(r, v, f, virial=instant_virial)
      kinetic = sum(v**2)/2
      total = kinetic + energy
      ! The position step carries dt^2/2 and the velocity step dt/2 of the constraint force.
      pressure = (2*kinetic + pair_virial + [trace(instant_virial), 2*trace(drift_virial), trace(kick_virial)/(dt/2)])/ &
                 (3*box**3)
      samples = samples + 1
      time(samples) = step*dt
      energies(samples) = total/n
      temperature_sum = temperature_sum + 2*kinetic/degrees_of_freedom
      pressure_sum = pressure_sum + pressure
      if (mod(step, max(every, steps/10/every*every)) == 0) print "(f10.3, f18.12, f10.5, es13.2, f10.4)", &
         time(samples), energies(samples), 2*kinetic/degrees_of_freedom, bond_error, pressure(1)
   end subroutine

   subroutine conclude()
      real(dp) :: t(samples), e(samples), slope, kt
      if (samples == 0) return
      kt = temperature_sum/samples
      t = time(:samples) - sum(time(:samples))/samples
      e = energies(:samples) - sum(energies(:samples))/samples
      slope = dot_product(t, e)/max(dot_product(t, t), tiny(slope))
      print "(a, es10.2, a)", "largest bond error    ", bond_error, " = |d^2 - a^2|/a^2, of all steps"
      print "(a, es10.2)", "largest |d.v|         ", rate
      print "(a, es10.2)", "largest momentum      ", momentum_error
      print "(a, es10.2, a)", "energy drift          ", slope/kt, " kT per bead and unit of time"
      print "(a, es10.2, a)", "energy fluctuation    ", sqrt(sum((e - slope*t)**2)/samples)/kt, " kT per bead, rms about it"
      print "(a, f10.5)", "temperature           ", kt
      print "(a, 3f10.4)", "pressure              ", pressure_sum/samples
      print "(a, es10.2)", "  largest difference  ", (maxval(pressure_sum) - minval(pressure_sum))/samples
      print "(a, i0, a)", "neighbour list        ", list%made, " times made"
   end subroutine

   real(dp) function trace(tensor)
      real(dp), intent(in) :: tensor(3, 3)
      trace = tensor(1, 1) + tensor(2, 2) + tensor(3, 3)
   end function

   ! The words of the command line are the assignments of a namelist.
   subroutine read_options()
      integer :: chains, beads, melt, i, status
      character(256) :: word, reason
      namelist /options/ chains, beads, melt, steps, threads, density, dt
      chains = n_chains
      beads = n_beads
      melt = melt_steps
      do i = 1, command_argument_count()
         call get_command_argument(i, word)
         word = "&options "//trim(word)//" /"
         read (word, options, iostat=status, iomsg=reason)
         if (status /= 0) call stop_with(trim(word)//" "//trim(reason))
      end do
      if (chains < 1 .or. beads < 2) call stop_with("chains must be at least 1 and beads at least 2")
      if (melt < 0 .or. steps < 1) call stop_with("melt must be at least 0 and steps at least 1")
      if (.not. (density > 0 .and. dt > 0)) call stop_with("density and dt must be above zero")
      if (threads < 1) call stop_with("threads must be at least 1")
      n_chains = chains
      n_beads = beads
      melt_steps = melt
   end subroutine

   subroutine stop_with(message)
      character(*), intent(in) :: message
      write (error_unit, "(2a)") "melt_md: ", message
      stop 2
   end subroutine

end program
