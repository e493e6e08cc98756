! The picture of a run, by gnuplot.
module water_plot
   use, intrinsic :: iso_fortran_env, only: dp => real64
   implicit none
   private
   public :: plot_run

contains

   ! Writes OUTPUT.gp beside OUTPUT.dat, and draws OUTPUT.png if gnuplot is there.
   subroutine plot_run(output, first_energy)
      character(*), intent(in) :: output
      real(dp), intent(in) :: first_energy
      integer :: unit, status
      open (newunit=unit, file=output//".gp", status="replace", action="write")
      write (unit, "(a)") "set terminal pngcairo size 900,1000", "set output '"//output//".png'", &
         "set multiplot layout 4,1", "set grid", "set lmargin 14", "set key outside top horizontal", &
         "set ylabel 'T / K'", "plot '"//output//".dat' using 1:4 with lines title 'temperature'", &
         "set ylabel '(kJ/mol) per molecule'"
      write (unit, "(a, es20.12, a)") "plot '"//output//".dat' using 1:($3 - ", first_energy, &
         ") with lines title 'total energy less that at the start'"
      write (unit, "(a)") "set ylabel 'bond error'", "set format y '%.1e'", &
         "plot '"//output//".dat' using 1:5 with points pt 7 ps 0.3 title 'largest |d^2 - a^2| / a^2'", "set format y", &
         "set xlabel 'time / ps'", "set ylabel 'P / bar'", &
         "plot '"//output//".dat' using 1:7 with lines title 'pressure'", "unset multiplot"
      close (unit)
      call execute_command_line("command -v gnuplot >/dev/null 2>&1 && gnuplot '"//output//".gp'", exitstat=status)
      if (status == 0) then
         print "(3a)", "plot                  ", output, ".png"
      else
         print "(3a)", "plot                  gnuplot was not found; ", output, ".gp draws it"
      end if
   end subroutine

end module
