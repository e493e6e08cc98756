! What is measured along a run, and what is said about it at the end.
module alkane_samples
   use alkane_units, only: dp, boltzmann, kj_per_mol, piconewton
   implicit none
   private
   public :: samples, open_samples, take_sample, print_energy, print_temperature, print_tensions, plot

   integer, parameter :: n_blocks = 10

   type :: samples
      real(dp), allocatable :: time(:), energy(:), temperature(:)   ! fs, kJ/mol, K
      real(dp), allocatable :: tension_sum(:), tension_square_sum(:), tension(:)  ! pN
      integer :: n = 0
      integer :: unit = -1   ! of the data file; -1: none
   end type

contains

   subroutine open_samples(s, room, n_bonds, output)
      type(samples), intent(out) :: s
      integer, intent(in) :: room, n_bonds
      character(*), intent(in) :: output
      allocate (s%time(room), s%energy(room), s%temperature(room))
      allocate (s%tension(n_bonds))
      allocate (s%tension_sum(n_bonds), s%tension_square_sum(n_bonds), source=0.0_dp)
      if (output == "") return
      open (newunit=s%unit, file=output//".dat", status="replace", action="write")
      write (s%unit, "(a)") "# time/ps  kinetic, potential, total energy/(kJ/mol)  temperature/K  bond error  "// &
         "tension of each bond/pN"
   end subroutine

   subroutine take_sample(s, time, kinetic, potential, degrees_of_freedom, bond_error, tension)
      type(samples), intent(inout) :: s
      real(dp), intent(in) :: time, kinetic, potential, degrees_of_freedom, bond_error, tension(:)
      s%n = s%n + 1
      s%time(s%n) = time
      s%energy(s%n) = (kinetic + potential)/kj_per_mol
      s%temperature(s%n) = 2*kinetic/(degrees_of_freedom*boltzmann)
      s%tension = tension/piconewton
      s%tension_sum = s%tension_sum + s%tension
      s%tension_square_sum = s%tension_square_sum + s%tension**2
      if (s%unit /= -1) write (s%unit, "(f12.4, 3es20.12, f12.4, es12.4, *(es14.6))") time/1000, kinetic/kj_per_mol, &
         potential/kj_per_mol, s%energy(s%n), s%temperature(s%n), bond_error, s%tension
   end subroutine

   ! How well the energy is kept: the slope of a straight line through the samples, and the deviations from it.
   subroutine print_energy(s, n_atoms)
      type(samples), intent(in) :: s
      integer, intent(in) :: n_atoms
      real(dp) :: t(s%n), e(s%n), slope, mean_temperature
      if (s%n < 3) return
      t = s%time(:s%n) - sum(s%time(:s%n))/s%n
      e = s%energy(:s%n) - sum(s%energy(:s%n))/s%n
      slope = dot_product(t, e)/dot_product(t, t)
      mean_temperature = sum(s%temperature(:s%n))/s%n
      print "(a, es10.2, a)", "energy drift          ", slope*1e6_dp, " kJ/mol per ns"
      print "(a, es10.2)", "  in kT per atom and ps", slope*1e3_dp*kj_per_mol/(n_atoms*boltzmann*mean_temperature)
      print "(a, es10.2, a)", "energy fluctuation    ", sqrt(sum((e - slope*t)**2)/s%n), " kJ/mol rms about it"
   end subroutine

   ! The mean, with the standard error from the scatter of block means.
   subroutine print_temperature(s)
      type(samples), intent(in) :: s
      real(dp) :: mean, block(n_blocks)
      integer :: i, length
      length = s%n/n_blocks
      if (length == 0) return
      do i = 1, n_blocks
         block(i) = sum(s%temperature((i - 1)*length + 1:i*length))/length
      end do
      mean = sum(block)/n_blocks
      print "(a, f8.2, a, f6.2, a)", "mean temperature      ", mean, " +- ", &
         sqrt(sum((block - mean)**2)/(n_blocks*(n_blocks - 1))), " K"
   end subroutine

   subroutine print_tensions(s, names)
      type(samples), intent(in) :: s
      character(*), intent(in) :: names(:)
      real(dp) :: mean(size(s%tension)), scatter(size(s%tension))
      integer :: k
      if (s%n == 0) return
      mean = s%tension_sum/s%n
      scatter = sqrt(max(0.0_dp, s%tension_square_sum/s%n - mean**2))
      print "(a)", "bond   tension/pN:         mean         rms        last"
      do k = 1, size(mean)
         print "(i4, 2x, 3a, t20, 3f12.2)", k, trim(names(k)), "-", trim(names(k + 1)), mean(k), scatter(k), s%tension(k)
      end do
   end subroutine

   ! Writes a gnuplot script beside the data, and draws the picture if gnuplot is there.
   subroutine plot(s, output)
      type(samples), intent(inout) :: s
      character(*), intent(in) :: output
      integer :: unit, n, status
      if (s%unit == -1) return
      close (s%unit)
      s%unit = -1
      n = size(s%tension)
      open (newunit=unit, file=output//".gp", status="replace", action="write")
      write (unit, "(a)") "set terminal pngcairo size 900,1200", "set output '"//output//".png'", &
         "set multiplot layout 4,1", "set grid", "set lmargin 14", "set key outside top horizontal", &
         "set ylabel 'energy / (kJ/mol)'", "plot '"//output//".dat' using 1:2 with lines title 'kinetic', \", &
         "     '' using 1:3 with lines title 'potential', '' using 1:4 with lines lw 2 title 'total'"
      write (unit, "(a, es20.12, a)") "plot '' using 1:($4 - ", s%energy(1), &
         ") with lines title 'total energy less that at the start'"
      write (unit, "(a)") "set ylabel 'bond error'", "set format y '%.1e'", &
         "plot '' using 1:6 with points pt 7 ps 0.3 title 'largest |d^2 - a^2| / a^2'", "set format y", &
         "set xlabel 'time / ps'", "set ylabel 'tension / pN'"
      write (unit, "(a, i0, a, i0, a)") "plot '' using 1:7 with lines title 'first bond', '' using 1:", 7 + n/2, &
         " with lines title 'bond ", n/2 + 1, "'"
      write (unit, "(a)") "unset multiplot"
      close (unit)
      call execute_command_line("command -v gnuplot >/dev/null 2>&1 && gnuplot '"//output//".gp'", exitstat=status)
      if (status == 0) then
         print "(3a)", "plot                  ", output, ".png"
      else
         print "(3a)", "plot                  gnuplot was not found; ", output, ".gp draws it"
      end if
   end subroutine

end module
