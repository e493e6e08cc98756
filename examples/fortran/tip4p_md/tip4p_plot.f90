! Distances between oxygens and how far they have gone, as files and pictures by gnuplot.
module tip4p_plot
   use, intrinsic :: iso_fortran_env, only: dp => real64
   implicit none
   private
   public :: plot_run

contains

   ! Writes OUTPUT.dat (distance and g), OUTPUT.energy.dat and OUTPUT.gp, and draws OUTPUT.png if gnuplot is there.
   subroutine plot_run(output, bin, g, time, energy)
      character(*), intent(in) :: output
      real(dp), intent(in) :: bin, g(:), time(:), energy(:)
      integer :: unit, status, k
      open (newunit=unit, file=output//".dat", status="replace", action="write")
      write (unit, "(a)") "# distance/A   g of oxygens"
      write (unit, "(f10.4, f12.5)") ((k - 0.5_dp)*bin, g(k), k=1, size(g))
      close (unit)
      open (newunit=unit, file=output//".energy.dat", status="replace", action="write")
      write (unit, "(a)") "# time/ps   total energy, kJ/mol per molecule"
      write (unit, "(f12.4, f20.10)") (time(k), energy(k), k=1, size(time))
      close (unit)
      open (newunit=unit, file=output//".gp", status="replace", action="write")
      write (unit, "(a)") "set terminal pngcairo size 900,800", "set output '"//output//".png'", &
         "set multiplot layout 2,1", "set grid", "set xlabel 'distance of oxygens / A'", "set ylabel 'g'", &
         "set arrow from 2.80,0 to 2.80,2.57 nohead dt 2", &
         "set label 'measured (Skinner et al. 2013)' at 2.9,2.75", &
         "plot '"//output//".dat' with lines lw 2 title 'TIP4P/2005'", "unset arrow", "unset label", &
         "set xlabel 'time / ps'", "set ylabel '(kJ/mol) per molecule'", &
         "plot '"//output//".energy.dat' with lines title 'total energy'", "unset multiplot"
      close (unit)
      call execute_command_line("command -v gnuplot >/dev/null 2>&1 && gnuplot '"//output//".gp'", exitstat=status)
      if (status == 0) then
         print "(3a)", "plot                  ", output, ".png"
      else
         print "(3a)", "plot                  gnuplot was not found; ", output, ".gp draws it"
      end if
   end subroutine

end module
