! Writes an XYZ file of an all-trans united-atom n-alkane: bonds of 1.54 A, angles of 114 degrees.
!
!     make_alkane N > FILE      N carbon atoms, at least 2; make_alkane 16 > n-hexadecane.xyz
program make_alkane
   use, intrinsic :: iso_fortran_env, only: dp => real64, error_unit
   implicit none
   real(dp), parameter :: bond = 1.54_dp, half_angle = 57*acos(-1.0_dp)/180
   character(32) :: word
   integer :: n, i, status

   call get_command_argument(1, word)
   read (word, *, iostat=status) n
   if (status /= 0 .or. n < 2) then
      write (error_unit, "(a)") "usage: make_alkane N, with at least 2 carbon atoms"
      error stop
   end if
   print "(i0)", n
   print "(a, i0, a)", "united-atom n-alkane with ", n, " carbon atoms, all trans; lengths in A"
   do i = 1, n
      print "(a, 3f18.12)", merge("CH3", "CH2", i == 1 .or. i == n), (i - 1)*bond*sin(half_angle), &
         merge(1, -1, mod(i, 2) == 0)*bond*cos(half_angle)/2, 0.0_dp
   end do
end program
