! Reads the reference cases of tests/oracle; its README has the format.
module oracle_case
   use, intrinsic :: iso_fortran_env, only: real64
   implicit none
   private
   public :: reference, read_reference, read_names

   type :: reference
      character(:), allocatable :: name
      integer :: n_bonds = 0
      real(real64), allocatable :: mass(:), r(:, :), v(:, :), f(:, :)
      real(real64), allocatable :: lambda(:), lambda_scale(:), g(:, :), g_scale(:)
      real(real64), allocatable :: fixman_force(:, :), fixman_scale(:)
      real(real64) :: log_det = 0, fixman_energy = 0, virial(3, 3) = 0
      integer :: n_zinv = 0
      integer, allocatable :: zinv_at(:, :)
      real(real64), allocatable :: zinv(:)
   end type

contains

   ! The names of the files that folder/INDEX lists.
   function read_names(folder) result(names)
      character(*), intent(in) :: folder
      character(128), allocatable :: names(:)
      character(128) :: line
      integer :: unit, status
      allocate (names(0))
      open (newunit=unit, file=folder//"/INDEX", status="old", action="read")
      do
         read (unit, "(a)", iostat=status) line
         if (status /= 0) exit
         if (line == "" .or. line(1:1) == "#") cycle
         names = [names, line]
      end do
      close (unit)
   end function

   subroutine read_reference(path, c)
      character(*), intent(in) :: path
      type(reference), intent(out) :: c
      character(512) :: line
      character(32) :: word
      real(real64) :: w, tensor(6)
      integer :: unit, i, k
      open (newunit=unit, file=path, status="old", action="read")
      line = next_line(unit)
      c%name = trim(line(6:))
      line = next_line(unit)
      read (line, *) word, c%n_bonds
      associate (n => c%n_bonds)
         allocate (c%mass(n + 1), c%r(3, n + 1), c%v(3, n + 1), c%f(3, n + 1))
         allocate (c%lambda(n), c%lambda_scale(n), c%g(3, n + 1), c%g_scale(n + 1))
         allocate (c%fixman_force(3, n + 1), c%fixman_scale(n + 1))
         line = next_line(unit)
         do i = 1, n + 1
            line = next_line(unit)
            read (line, *) k, w, c%mass(i), c%r(:, i), c%v(:, i), c%f(:, i)
            ! In the file -1 stands for a mass without end.
            if (c%mass(i) < 0) c%mass(i) = 0
         end do
         do i = 0, n   ! bonds_in: lengths for information
            line = next_line(unit)
         end do
         line = next_line(unit)
         read (line, *) word, c%log_det
         line = next_line(unit)
         read (line, *) word, c%fixman_energy
         line = next_line(unit)
         read (line, *) word, tensor
         c%virial = reshape([tensor(1), tensor(2), tensor(3), tensor(2), tensor(4), tensor(5), tensor(3), tensor(5), &
                             tensor(6)], [3, 3])
         line = next_line(unit)   ! cond
         line = next_line(unit)
         do i = 1, n
            line = next_line(unit)
            read (line, *) k, c%lambda(i), c%lambda_scale(i)
         end do
         line = next_line(unit)
         do i = 1, n + 1
            line = next_line(unit)
            read (line, *) k, c%g(:, i), c%g_scale(i), c%fixman_force(:, i), c%fixman_scale(i)
         end do
         line = next_line(unit)
         read (line, *) word, c%n_zinv
         allocate (c%zinv_at(2, c%n_zinv), c%zinv(c%n_zinv))
         do i = 1, c%n_zinv
            line = next_line(unit)
            read (line, *) c%zinv_at(:, i), c%zinv(i)
         end do
      end associate
      line = next_line(unit)
      if (line /= "end") error stop "no end in a reference file"
      close (unit)
   end subroutine

   function next_line(unit) result(line)
      integer, intent(in) :: unit
      character(512) :: line
      do
         read (unit, "(a)") line
         if (line /= "" .and. line(1:1) /= "#") return
      end do
   end function

end module
