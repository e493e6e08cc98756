! Liquid water of the TIP4P/2005 model at constant energy: molecules are rigid bodies with a site that has a charge and no
! mass. The force on the site goes to the atoms, and its place comes with theirs: the program treats it like any other atom.
!
!     tip4p_md [name=value ...]
!
!     molecules=216       how many
!     melt=3000           steps before, with new velocities of the temperature now and then
!     steps=2000          steps of the run
!     dt=2                time step, fs
!     temperature=298     K
!     density=0.9979      g/cm^3, of the model at 298 K and 1 bar
!     threads=1           for the constraints
!     output=PREFIX       writes PREFIX.dat, PREFIX.energy.dat and PREFIX.gp, and PREFIX.png if gnuplot is installed
!
! The run ends with what can be held against others' results: the distances of oxygens, and the coefficient of
! self-diffusion from how far they go (0.21 A^2/ps for 216 molecules at 298 K; 50 ps and more are needed for two digits).
program tip4p_md
   use, intrinsic :: iso_fortran_env, only: dp => real64, error_unit
   use holonomic, only: hol_chains, hol_instruction_set, hol_version, hol_worst, HOL_SHAPE_RIGID
   use tip4p_2005, only: boltzmann, kj_per_mol, mass, pair_forces, place_molecules, places, thermal_velocities
   use tip4p_plot, only: plot_run
   implicit none
   integer :: molecules = 216, melt = 3000, steps = 2000, threads = 1
   real(dp) :: dt = 2, temperature = 298, density = 0.9979_dp
   character(200) :: output = ""

   type(hol_chains) :: water
   type(hol_worst) :: worst
   real(dp), allocatable :: r(:, :), v(:, :), f(:, :), rigid(:, :), r_ref(:, :), w(:, :), m(:, :)
   real(dp), allocatable :: time(:), energies(:), start(:, :), far(:), g(:)
   real(dp) :: box, cutoff, energy, kinetic, degrees_of_freedom, shape_error, rate, temperature_sum
   integer :: n, step, every, samples
   integer, parameter :: bins = 400
   real(dp), parameter :: bin = 0.02_dp   ! A
   real(dp) :: pairs(bins) = 0

   call read_options()
   n = 4*molecules
   box = (molecules*sum(mass)/(density*0.602214076_dp))**(1/3.0_dp)
   cutoff = min(9.0_dp, box/2)
   allocate (r(3, n), v(3, n), f(3, n), rigid(3, n), r_ref(3, n))
   m = spread([(mass, step=1, molecules)], 1, 3)
   w = merge(1/max(m, mass(2)), 0.0_dp, m > 0)   ! sites are not kicked
   call place_molecules(box, r)
   call thermal_velocities(temperature, v)

   call water%create(m(1, :))
   call water%add_rigid_molecules(molecules, 4, 1, [1, 2, 3, 4], places)
   call water%set_threads(threads)
   call water%project_velocities(r, v)
   call all_forces()

   print "(5a)", "holonomic ", hol_version(), " (", hol_instruction_set(), ")"
   print "(i0, a, f0.3, a, f0.3, a)", water%n_of_shape(HOL_SHAPE_RIGID), " molecules of water in a cube of ", box, &
      " A, cutoff ", cutoff, " A"
   do step = 1, melt
      if (mod(step, 50) == 0) then
         call thermal_velocities(temperature, v)
         call water%project_velocities(r, v)
      end if
      call advance()
   end do
   print "(a, i0, a)", "melted in ", melt, " steps"

   ! The momentum that is left is taken out, and is three degrees of freedom less.
   v = v - spread(sum(m*v, dim=2)/sum(m(1, :)), 2, n)
   degrees_of_freedom = real(water%degrees_of_freedom() - 3, dp)
   print "(a, i0, a)", "degrees of freedom    ", nint(degrees_of_freedom), " in the temperature"
   print "(a)", "   time/ps   E/(kJ/mol) per molecule     T/K  shape error"

   every = max(1, steps/200)
   allocate (time(steps/every), energies(steps/every), far(steps/every))
   start = r(:, 1::4)
   samples = 0
   shape_error = 0
   rate = 0
   temperature_sum = 0
   do step = 1, steps
      call advance()
      call water%violation(r, v, worst)
      shape_error = max(shape_error, worst%length)
      rate = max(rate, worst%rate)
      if (mod(step, every) == 0) call observe()
   end do
   call conclude()
   call water%destroy()

contains

   ! Velocity Verlet (RATTLE). Molecules are not cut by the box, so that the library needs none.
   subroutine advance()
      v = v + dt/2*w*f
      r_ref = r
      r = r + dt*v
      call water%project_positions(r_ref, r, dt, v)
      call all_forces()
      v = v + dt/2*w*f
      call water%project_velocities(r, v)
   end subroutine

   ! A site has no mass, so that a kick leaves it alone. With the forces that keep molecules rigid, for atoms at rest, all
   ! that acts on it acts on the others; what these forces do beside that, the projections would have done.
   subroutine all_forces()
      call pair_forces(box, cutoff, r, f, energy)
      call water%forces(r, f=f, g=rigid)
      f = f + rigid
   end subroutine

   subroutine observe()
      real(dp) :: now
      kinetic = sum(m*v**2)/2
      now = 2*kinetic/(degrees_of_freedom*boltzmann)
      samples = samples + 1
      time(samples) = step*dt/1000
      energies(samples) = (kinetic + energy)/(molecules*kj_per_mol)
      far(samples) = sum((r(:, 1::4) - start)**2)/molecules
      temperature_sum = temperature_sum + now
      call count_oxygens()
      if (mod(step, max(every, steps/10/every*every)) == 0) &
         print "(f10.3, f20.8, f16.2, es13.2)", time(samples), energies(samples), now, shape_error
   end subroutine

   subroutine count_oxygens()
      real(dp) :: d(3)
      integer :: i, j, k
      do i = 1, n, 4
         do j = i + 4, n, 4
            d = r(:, i) - r(:, j)
            k = int(norm2(d - box*anint(d/box))/bin) + 1
            if (k <= bins) pairs(k) = pairs(k) + 1
         end do
      end do
   end subroutine

   subroutine conclude()
      real(dp) :: t(samples), e(samples), slope, shell(bins), diffusion
      integer :: k, first, half, peak
      if (samples < 4) return
      t = time(:samples) - sum(time(:samples))/samples
      e = energies(:samples) - sum(energies(:samples))/samples
      slope = dot_product(t, e)/dot_product(t, t)
      shell = [(4*acos(-1.0_dp)*((k - 0.5_dp)**2 + 1/12.0_dp)*bin**3, k=1, bins)]
      g = pairs/samples/(0.5_dp*molecules*(molecules - 1)*shell/box**3)
      peak = maxloc(g, dim=1)
      ! The first half of the run is not counted: oxygens rattle before they go anywhere.
      half = samples/2
      first = half + 1
      t(first:) = time(first:samples) - sum(time(first:samples))/(samples - half)
      diffusion = dot_product(t(first:), far(first:samples))/dot_product(t(first:), t(first:))/6
      print "(a, es10.2, a)", "largest shape error   ", shape_error, ", of all steps"
      print "(a, es10.2, a)", "largest rate          ", rate, " A^2/fs"
      print "(a, es10.2, a)", "energy drift          ", slope*1000, " kJ/mol per molecule and ns"
      print "(a, es10.2, a)", "energy fluctuation    ", sqrt(sum((e - slope*(time(:samples) - sum(time(:samples))/samples))**2) &
         /samples), " kJ/mol per molecule, rms about it"
      print "(a, f8.2, a)", "mean temperature      ", temperature_sum/samples, " K"
      print "(a, f8.3, a, f6.2)", "oxygens are nearest at", (peak - 0.5_dp)*bin, " A, where their distribution is", g(peak)
      print "(a, f8.3, a)", "self-diffusion        ", diffusion, " A^2/ps"
      if (output /= "") call plot_run(trim(output), bin, g, time(:samples), energies(:samples))
   end subroutine

   ! The words of the command line are the assignments of a namelist.
   subroutine read_options()
      integer :: i, status
      character(256) :: word, reason
      namelist /options/ molecules, melt, steps, threads, dt, temperature, density
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
      write (error_unit, "(2a)") "tip4p_md: ", message
      stop 2
   end subroutine

end program
