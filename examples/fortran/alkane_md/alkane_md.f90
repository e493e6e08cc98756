! Molecular dynamics of a united-atom n-alkane whose bonds are rigid: what a molecular dynamics code written in plain
! Fortran adds to get its constraints from the library. The forces are TraPPE-UA; the molecule is alone in space.
!
!     alkane_md [name=value ...]
!
!     file=n-hexadecane.xyz   the molecule: XYZ, one united atom (CH3 or CH2) per line, lengths in A
!     integrator=rattle       rattle or rk4 (constant energy), or langevin (constant temperature)
!     steps=100000            number of steps
!     dt=2                    time step, fs
!     temperature=300         of the first velocities, and of the bath, K
!     friction=1              of the bath, 1/ps
!     seed=1                  of the random numbers
!     every=steps/1000        steps between samples
!     tolerance=1e-4          SHAKE and RATTLE's iterations to this tolerance in place of the library, to compare
!     output=PREFIX           writes PREFIX.dat and PREFIX.gp, and PREFIX.png if gnuplot is installed
program alkane_md
   use alkane_force_field, only: bond_length, set_up_force_field
   use alkane_integrators, only: kinetic_energy, molecule, start, step_langevin, step_rattle, step_rk4
   use alkane_options, only: options, read_options, stop_with
   use alkane_samples, only: open_samples, plot, print_energy, print_temperature, print_tensions, samples, take_sample
   use alkane_units, only: dp
   use alkane_xyz, only: read_molecule
   use, intrinsic :: iso_fortran_env, only: int64
   use holonomic, only: hol_instruction_set, hol_version, hol_worst
   implicit none
   type(options) :: chosen
   type(molecule) :: m, first
   type(samples) :: sampled
   type(hol_worst) :: worst
   character(8), allocatable :: names(:)
   real(dp), allocatable :: tension(:)
   real(dp) :: degrees_of_freedom, bond_error
   integer :: n, i, step, unknown
   integer(int64) :: began, ended, rate, observing = 0
   character(64) :: message

   call read_options(chosen)
   call read_molecule(chosen%file, names, m%r)
   call set_up_force_field(names, m%field, unknown)
   if (unknown > 0) then
      write (message, "(3a, i0, a)") ": '", trim(names(unknown)), "', atom ", unknown, ", is neither CH3 nor CH2"
      call stop_with(chosen%file//trim(message))
   end if
   n = size(names)

   call m%chains%create(m%field%mass)
   call m%chains%add([(i, i=1, n)], bond_length)

   call set_seed(chosen%seed)
   call start(m, chosen%temperature)
   m%tolerance = chosen%tolerance
   ! At constant energy the total momentum stays zero, which is three degrees of freedom less; a bath kicks it too.
   degrees_of_freedom = real(m%chains%degrees_of_freedom(), dp)
   if (chosen%integrator /= "langevin") degrees_of_freedom = degrees_of_freedom - 3

   print "(5a)", "holonomic ", hol_version(), " (", hol_instruction_set(), ")"
   print "(a, i0, 2a)", "united atoms          ", n, " from ", chosen%file
   print "(a, i0, a)", "degrees of freedom    ", nint(degrees_of_freedom), " in the temperature"
   print "(3a, f0.3, a, i0, a)", "integrator            ", chosen%integrator, ", dt = ", chosen%dt, " fs, ", &
      chosen%steps, " steps"
   if (chosen%tolerance > 0) print "(a, es8.1)", "constraints           by SHAKE, to", chosen%tolerance
   print "(a)", "   time/ps      E/(kJ/mol)       T/K   bond error"

   allocate (tension(n - 1))
   call open_samples(sampled, chosen%steps/chosen%every + 1, n - 1, chosen%output)
   first = m
   call m%chains%violation(m%r, m%v, worst)
   bond_error = worst%length
   call observe(0)
   call system_clock(began, rate)
   do step = 1, chosen%steps
      call advance(m, chosen%dt)
      call watch(step)
   end do
   call system_clock(ended)

   print "(a, es10.2, a)", "largest bond error    ", bond_error, " = |d^2 - a^2|/a^2, of all steps"
   if (chosen%integrator /= "rk4") print "(a, i0)", "most iterations       ", m%iterations
   if (chosen%integrator /= "rk4") print "(a, f8.2, a, f5.1, a)", "constraints take      ", &
      1e6_dp*m%ticks/rate/chosen%steps, " us a step,", 100.0_dp*m%ticks/(ended - began - observing), " % of it"
   if (chosen%integrator /= "langevin") call print_energy(sampled, n)
   call print_temperature(sampled)
   if (chosen%integrator == "rk4") call print_order()
   call print_tensions(sampled, names)
   call plot(sampled, chosen%output)
   call m%chains%destroy()

contains

   subroutine advance(m, dt)
      type(molecule), intent(inout) :: m
      real(dp), intent(in) :: dt
      select case (chosen%integrator)
      case ("rk4")
         call step_rk4(m, dt)
      case ("rattle")
         call step_rattle(m, dt)
      case ("langevin")
         call step_langevin(m, dt, chosen%temperature, chosen%friction/1000)
      end select
   end subroutine

   ! What the program measures beside its steps; the time for it is not the steps'.
   subroutine watch(step)
      integer, intent(in) :: step
      integer(int64) :: began, ended
      call system_clock(began)
      call m%chains%violation(m%r, m%v, worst)
      bond_error = max(bond_error, worst%length)
      if (mod(step, chosen%every) == 0) call observe(step)
      call system_clock(ended)
      observing = observing + ended - began
   end subroutine

   ! The tensions at this instant, from positions, velocities and applied forces; no integrator enters.
   subroutine observe(step)
      integer, intent(in) :: step
      real(dp) :: time
      time = step*chosen%dt
      call m%chains%forces(m%r, m%v, m%f, tension=tension)
      call take_sample(sampled, time, kinetic_energy(m), m%potential, degrees_of_freedom, worst%length, &
                       tension)
      if (mod(step, max(chosen%every, chosen%steps/10)) == 0) &
         print "(f10.3, f16.8, f10.2, es13.2)", time/1000, sampled%energy(sampled%n), sampled%temperature(sampled%n), &
         bond_error
   end subroutine

   ! The same stretch of time with steps of dt, dt/2 and dt/4: each should err 16 times less than the one before.
   subroutine print_order()
      type(molecule) :: again
      real(dp) :: error(0:2)
      integer :: halvings, step, steps
      steps = min(chosen%steps, 1000)
      do halvings = 0, 2
         again = first
         do step = 1, steps*2**halvings
            call advance(again, chosen%dt/2**halvings)
         end do
         call again%chains%violation(again%r, worst=worst)
         error(halvings) = worst%length
      end do
      print "(a, 3es10.2)", "bond error of dt, dt/2, dt/4", error
      print "(a, 2f6.2)", "observed order        ", log(error(0:1)/error(1:2))/log(2.0_dp)
   end subroutine

   subroutine set_seed(seed)
      integer, intent(in) :: seed
      integer :: length, i
      call random_seed(size=length)
      call random_seed(put=[(seed + 7919*i, i=1, length)])
   end subroutine

end program
