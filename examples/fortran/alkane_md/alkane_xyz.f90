! Reads the molecule: an XYZ file with one united atom per line, in order along the chain.
module alkane_xyz
   use alkane_force_field, only: bond_length
   use alkane_options, only: stop_with
   use alkane_units, only: dp
   implicit none
   private
   public :: read_molecule

contains

   subroutine read_molecule(file, names, r)
      character(*), intent(in) :: file
      character(8), allocatable, intent(out) :: names(:)
      real(dp), allocatable, intent(out) :: r(:, :)
      character(256) :: text
      integer :: unit, status, n, i
      open (newunit=unit, file=file, status="old", action="read", iostat=status, iomsg=text)
      if (status /= 0) call stop_with(trim(text))
      read (unit, *, iostat=status) n
      if (status /= 0 .or. n < 2) call stop_with(file//", line 1: a number of atoms, at least 2, is needed")
      read (unit, "(a)", iostat=status) text
      allocate (names(n), r(3, n))
      do i = 1, n
         read (unit, "(a)", iostat=status) text
         if (status /= 0) call stop_with(file//": the file ends before atom "//decimal(i)//" of "//decimal(n))
         read (text, *, iostat=status) names(i), r(:, i)
         if (status /= 0) call stop_with(file//", line "//decimal(i + 2)//": a name and x, y, z are needed")
         if (i == 1) cycle
         ! A file may be rounded, and it may be another molecule.
         if (.not. abs(norm2(r(:, i) - r(:, i - 1)) - bond_length) < 0.1_dp) &
            call stop_with(file//", line "//decimal(i + 2)//": this atom is not a bond of 1.54 A from the one before")
      end do
      close (unit)
   end subroutine

   function decimal(n) result(text)
      integer, intent(in) :: n
      character(:), allocatable :: text
      character(16) :: digits
      write (digits, "(i0)") n
      text = trim(digits)
   end function

end module
