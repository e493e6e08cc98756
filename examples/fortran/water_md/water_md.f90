! Molecular dynamics of rigid water at constant energy, or at constant pressure and temperature: SPC/E in a periodic cube,
! whose three distances per molecule the library holds, all molecules in one call.
!
!     water_md [name=value ...]
!
!     molecules=216       how many
!     melt=1000           steps before, with new velocities of the temperature now and then
!     steps=2000          steps of the run
!     pressure=P          bar: at constant pressure and temperature; if it is not given, at constant energy
!     dt=2                time step, fs
!     temperature=300     K
!     density=0.997       g/cm^3
!     threads=1           for the constraints
!     output=PREFIX       writes PREFIX.dat and PREFIX.gp, and PREFIX.png if gnuplot is installed
program water_md
   use, intrinsic :: iso_fortran_env, only: dp => real64, error_unit
   use holonomic, only: hol_chains, hol_instruction_set, hol_report, hol_version, hol_worst, HOL_SHAPE_TRIANGLE
   use water_plot, only: plot_run
   use water_spce, only: bar, boltzmann, hh, kj_per_mol, mass, oh, pair_forces
   use water_start, only: place_molecules, thermal_velocities
   implicit none
   integer :: molecules = 216, melt = 1000, steps = 2000, threads = 1
   real(dp) :: dt = 2, temperature = 300, density = 0.997_dp, pressure = -huge(1.0_dp)
   character(200) :: output = ""

   type(hol_chains) :: water
   type(hol_report) :: report
   type(hol_worst) :: worst
   real(dp), allocatable :: r(:, :), v(:, :), f(:, :), r_ref(:, :), w(:, :)
   real(dp), allocatable :: time(:), energies(:)
   real(dp) :: box, cutoff, energy, pair_virial, virial(3, 3), kinetic, degrees_of_freedom
   real(dp) :: bond_error, rate, temperature_sum, pressure_sum, density_sum
   logical :: has_barostat
   integer :: n, step, every, samples, iterations, data, peak(400)
   real(dp), parameter :: bin = 0.05_dp   ! of distances between oxygens, A

   call read_options()
   n = 3*molecules
   box = (molecules*sum(mass)/(density*0.602214076_dp))**(1/3.0_dp)
   cutoff = min(9.0_dp, 0.47_dp*box)   ! less than half of a box that a barostat makes smaller
   allocate (r(3, n), v(3, n), f(3, n), r_ref(3, n), w(3, n))
   w = reshape(spread(spread(1/mass, 1, 3), 3, molecules), [3, n])
   call place_molecules(box, r)
   call thermal_velocities(temperature, v)

   call water%create([(mass, step=1, molecules)])
   call water%add_molecules(molecules, 3, 1, reshape([1, 2, 1, 3, 2, 3], [2, 3]), [oh, oh, hh])
   call water%set_box([box, box, box])
   call water%set_threads(threads)
   call water%project_velocities(r, v)
   call pair_forces(box, cutoff, r, f, energy, pair_virial)

   print "(5a)", "holonomic ", hol_version(), " (", hol_instruction_set(), ")"
   print "(i0, a, f0.3, a, f0.3, a)", water%n_of_shape(HOL_SHAPE_TRIANGLE), " molecules of water in a cube of ", box, &
      " A, cutoff ", cutoff, " A"
   has_barostat = .false.
   do step = 1, melt
      if (mod(step, 25) == 0) call thermostat()
      call advance()
   end do
   print "(a, i0, a)", "melted in ", melt, " steps"

   ! Some momentum is left. It is taken out, stays zero, and is three degrees of freedom less; a bath kicks it, too.
   has_barostat = pressure > -huge(1.0_dp)
   degrees_of_freedom = real(water%degrees_of_freedom(), dp)
   if (.not. has_barostat) then
      v = v - spread(sum(v/w, dim=2)/sum(1/w(1, :)), 2, n)
      degrees_of_freedom = degrees_of_freedom - 3
   end if
   print "(a, i0, a)", "degrees of freedom    ", nint(degrees_of_freedom), " in the temperature"
   print "(a)", "   time/ps   E/(kJ/mol) per molecule     T/K   bond error    |d.v| A^2/fs   P/bar"

   every = max(1, steps/500)
   allocate (time(steps/every), energies(steps/every))
   samples = 0
   iterations = 0
   bond_error = 0
   rate = 0
   temperature_sum = 0
   pressure_sum = 0
   density_sum = 0
   peak = 0
   if (output /= "") open (newunit=data, file=trim(output)//".dat", status="replace", action="write")
   do step = 1, steps
      call advance()
      if (has_barostat) then
         call barostat()
         if (mod(step, 25) == 0) call thermostat()
      end if
      call water%violation(r, v, worst)
      bond_error = max(bond_error, worst%length)
      rate = max(rate, worst%rate)
      iterations = max(iterations, int(report%iterations))
      if (mod(step, every) == 0) call observe()
   end do
   call conclude()
   call water%destroy()

contains

   ! Velocity Verlet (RATTLE).
   subroutine advance()
      v = v + dt/2*w*f
      r_ref = r
      r = r + dt*v
      call water%project_positions(r_ref, r, dt, v, report=report)
      call pair_forces(box, cutoff, r, f, energy, pair_virial)
      v = v + dt/2*w*f
      call water%project_velocities(r, v)
   end subroutine

   ! New velocities of the temperature.
   subroutine thermostat()
      call thermal_velocities(temperature, v)
      call water%project_velocities(r, v)
   end subroutine

   ! Of this instant, with the virial of the rigid bonds from their exact forces.
   real(dp) function pressure_now()
      call water%forces(r, v, f, virial=virial)
      kinetic = sum(v**2/w)/2
      pressure_now = (2*kinetic + pair_virial + virial(1, 1) + virial(2, 2) + virial(3, 3))/(3*box**3)
   end function

   ! Stochastic cell rescaling (Bernetti and Bussi 2020, DOI 10.1063/5.0020514): deforms the cell and all atoms in it, and
   ! puts the bonds back to their lengths. Positions before belong to the old cell, positions after it to the new one; as
   ! the atoms are put back into the cell one by one, bonds cross its faces in both.
   subroutine barostat()
      real(dp), parameter :: compressibility = 4.5e-5_dp/bar, period = 500   ! fs
      real(dp) :: strain, old_box, u(2)
      call random_number(u)
      strain = compressibility/period*dt*(pressure_now() + boltzmann*temperature/box**3 - pressure*bar) + &
               sqrt(2*boltzmann*temperature*compressibility*dt/(period*box**3))* &
               sqrt(-2*log(1 - u(1)))*cos(2*acos(-1.0_dp)*u(2))   ! a normal random number
      old_box = box
      box = box*exp(strain/3)
      r = r - old_box*floor(r/old_box)
      r_ref = r
      r = r*(box/old_box)
      v = v*(old_box/box)
      call water%set_box([box, box, box])
      call water%set_reference_box([old_box, old_box, old_box])
      call water%project_positions(r_ref, r, dt)
      call water%set_reference_box()
      call water%project_velocities(r, v)
      call pair_forces(box, cutoff, r, f, energy, pair_virial)
   end subroutine

   subroutine observe()
      real(dp) :: now, pressure
      pressure = pressure_now()/bar
      now = 2*kinetic/(degrees_of_freedom*boltzmann)
      samples = samples + 1
      time(samples) = step*dt/1000
      energies(samples) = (kinetic + energy)/(molecules*kj_per_mol)
      temperature_sum = temperature_sum + now
      pressure_sum = pressure_sum + pressure
      density_sum = density_sum + molecules*sum(mass)/(box**3*0.602214076_dp)
      call count_oxygens()
      if (output /= "") write (data, "(f12.4, 3es20.12, 2es12.4, f12.2)") time(samples), &
         kinetic/(molecules*kj_per_mol), energies(samples), now, worst%length, worst%rate, pressure
      if (mod(step, max(every, steps/10/every*every)) == 0) &
         print "(f10.3, f20.8, f16.2, 2es13.2, f12.0)", time(samples), energies(samples), now, bond_error, rate, pressure
   end subroutine

   ! Distances between oxygens, for their distribution.
   subroutine count_oxygens()
      real(dp) :: d(3)
      integer :: i, j, k
      do i = 1, n, 3
         do j = i + 3, n, 3
            d = r(:, i) - r(:, j)
            k = int(norm2(d - box*anint(d/box))/bin) + 1
            if (k <= size(peak)) peak(k) = peak(k) + 1
         end do
      end do
   end subroutine

   subroutine conclude()
      real(dp) :: t(samples), e(samples), slope, shell(size(peak))
      integer :: k
      if (samples < 3) return
      t = time(:samples) - sum(time(:samples))/samples
      e = energies(:samples) - sum(energies(:samples))/samples
      slope = dot_product(t, e)/dot_product(t, t)
      shell = [(((k - 0.5_dp)*bin)**2, k=1, size(peak))]
      print "(a, es10.2, a)", "largest bond error    ", bond_error, " = |d^2 - a^2|/a^2, of all steps"
      print "(a, es10.2, a)", "largest |d.v|         ", rate, " A^2/fs"
      print "(a, i0)", "most iterations       ", iterations
      if (has_barostat) then
         print "(a, f8.4, a)", "mean density          ", density_sum/samples, " g/cm^3"
      else
         print "(a, es10.2, a)", "energy drift          ", slope*1000, " kJ/mol per molecule and ns"
         print "(a, es10.2, a)", "energy fluctuation    ", sqrt(sum((e - slope*t)**2)/samples), &
            " kJ/mol per molecule, rms about it"
      end if
      print "(a, f8.2, a)", "mean temperature      ", temperature_sum/samples, " K"
      print "(a, f8.0, a)", "mean pressure         ", pressure_sum/samples, " bar"
      print "(a, f8.3, a)", "oxygens are nearest at", (maxloc(peak/shell, dim=1) - 0.5_dp)*bin, &
         " A, the first peak of their distribution"
      if (output == "") return
      close (data)
      call plot_run(trim(output), energies(1))
   end subroutine

   ! The words of the command line are the assignments of a namelist.
   subroutine read_options()
      integer :: i, status
      character(256) :: word, reason
      namelist /options/ molecules, melt, steps, threads, dt, temperature, density, pressure
      do i = 1, command_argument_count()
         call get_command_argument(i, word)
         if (word(:7) == "output=") then
            output = word(8:)
            cycle
         end if
         word = "&options "//trim(word)//" /"
         read (word, options, iostat=status, iomsg=reason)
         if (status /= 0) call stop_with(trim(word)//" "//trim(reason))
      end do
      if (molecules < 8) call stop_with("molecules must be at least 8")
      if (melt < 0 .or. steps < 1 .or. threads < 1) call stop_with("melt, steps and threads must be positive")
      if (.not. (dt > 0 .and. temperature > 0 .and. density > 0)) &
         call stop_with("dt, temperature and density must be above zero")
   end subroutine

   subroutine stop_with(message)
      character(*), intent(in) :: message
      write (error_unit, "(2a)") "water_md: ", message
      stop 2
   end subroutine

end program
