! The assertions of the Fortran tests: each says what it expects; the program fails at its end if one was not met.
module checks
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   implicit none
   private
   public :: test, check, finish, same_bits, eps

   real(real64), parameter :: eps = epsilon(1.0_real64)
   integer :: n_checks = 0, n_failed = 0
   character(:), allocatable :: current

   ! Bit for bit: NaN equals itself, and 0 is not -0.
   interface same_bits
      procedure :: same_bits_64, same_bits_32
   end interface

contains

   subroutine test(name)
      character(*), intent(in) :: name
      current = name
   end subroutine

   subroutine check(met, expectation)
      logical, intent(in) :: met
      character(*), intent(in) :: expectation
      n_checks = n_checks + 1
      if (met) return
      n_failed = n_failed + 1
      print "(4a)", "FAILED ", current, ": ", expectation
   end subroutine

   subroutine finish()
      print "(i0, a, i0, a)", n_checks, " checks, ", n_failed, " failed"
      if (n_checks == 0) error stop "nothing was checked"
      if (n_failed > 0) error stop 1
   end subroutine

   elemental logical function same_bits_64(a, b)
      real(real64), intent(in) :: a, b
      same_bits_64 = transfer(a, 0_int64) == transfer(b, 0_int64)
   end function

   elemental logical function same_bits_32(a, b)
      real(real32), intent(in) :: a, b
      same_bits_32 = transfer(a, 0_int32) == transfer(b, 0_int32)
   end function

end module
