! The command line of alkane_md: words of the form name=value.
module alkane_options
   use, intrinsic :: iso_fortran_env, only: error_unit
   use alkane_units, only: dp
   implicit none
   private
   public :: options, read_options, stop_with

   type :: options
      character(:), allocatable :: file        ! XYZ
      character(:), allocatable :: integrator  ! rattle, rk4 or langevin
      character(:), allocatable :: output      ! prefix of the files to be written; empty: none
      integer :: steps = 100000
      integer :: every = 0                     ! steps between samples; 0: a thousand samples in all
      integer :: seed = 1
      real(dp) :: dt = 2                       ! fs
      real(dp) :: temperature = 300            ! K
      real(dp) :: friction = 1                 ! 1/ps, for langevin
      real(dp) :: tolerance = 0                ! of SHAKE in place of the library; 0: the library
   end type

contains

   subroutine read_options(chosen)
      type(options), intent(out) :: chosen
      character(:), allocatable :: word
      integer :: i, equals
      chosen%file = "n-hexadecane.xyz"
      chosen%integrator = "rattle"
      chosen%output = ""
      do i = 1, command_argument_count()
         word = argument(i)
         equals = index(word, "=")
         if (equals == 0) call stop_with("'"//word//"' is not of the form name=value")
         call set(chosen, word(:equals - 1), word(equals + 1:))
      end do
      if (all(chosen%integrator /= [character(8) :: "rattle", "rk4", "langevin"])) &
         call stop_with("integrator="//chosen%integrator//" is none of rattle, rk4, langevin")
      if (chosen%tolerance > 0 .and. chosen%integrator == "rk4") call stop_with("tolerance= is SHAKE's, and rk4 has none")
      if (chosen%every == 0) chosen%every = max(1, chosen%steps/1000)
   end subroutine

   subroutine set(chosen, name, value)
      type(options), intent(inout) :: chosen
      character(*), intent(in) :: name, value
      select case (name)
      case ("file")
         chosen%file = value
      case ("integrator")
         chosen%integrator = value
      case ("output")
         chosen%output = value
      case ("steps")
         chosen%steps = whole_number(name, value, at_least=1)
      case ("every")
         chosen%every = whole_number(name, value, at_least=1)
      case ("seed")
         chosen%seed = whole_number(name, value, at_least=0)
      case ("dt")
         chosen%dt = positive_number(name, value)
      case ("temperature")
         chosen%temperature = positive_number(name, value)
      case ("friction")
         chosen%friction = positive_number(name, value)
      case ("tolerance")
         chosen%tolerance = positive_number(name, value)
      case default
         call stop_with("there is no option '"//name//"'; there are file, integrator, steps, dt, temperature, "// &
                        "friction, seed, every, tolerance and output")
      end select
   end subroutine

   integer function whole_number(name, value, at_least) result(number)
      character(*), intent(in) :: name, value
      integer, intent(in) :: at_least
      integer :: status
      number = 0
      status = verify(value, "0123456789")
      if (status == 0) read (value, *, iostat=status) number
      if (status /= 0 .or. number < at_least) call stop_with(name//"="//value//" must be a whole number, not too small")
   end function

   real(dp) function positive_number(name, value) result(number)
      character(*), intent(in) :: name, value
      integer :: status
      number = 0
      status = verify(value, "0123456789.eEdD+-")
      if (status == 0) read (value, *, iostat=status) number
      if (status /= 0 .or. .not. (number > 0 .and. number < huge(number))) &
         call stop_with(name//"="//value//" must be a number above zero")
   end function

   function argument(i) result(word)
      integer, intent(in) :: i
      character(:), allocatable :: word
      integer :: length
      call get_command_argument(i, length=length)
      allocate (character(length) :: word)
      call get_command_argument(i, word)
   end function

   subroutine stop_with(message)
      character(*), intent(in) :: message
      write (error_unit, "(2a)") "alkane_md: ", message
      stop 2
   end subroutine

end module
