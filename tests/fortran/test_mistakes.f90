! Mistakes that are made in the first hour: none is silent, and nothing is changed. Units, boxes and numbering are in test_start.f90.
program test_mistakes
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use holonomic
   use checks, only: check, finish, same_bits, test
   implicit none
   integer, parameter :: dp = real64, n = 9
   integer, parameter :: pairs(2, 3) = reshape([1, 2, 1, 3, 2, 3], [2, 3])
   real(dp), parameter :: mass(n) = [16.0_dp, 1.0_dp, 1.0_dp, 16.0_dp, 1.0_dp, 1.0_dp, 16.0_dp, 1.0_dp, 1.0_dp]
   real(dp), parameter :: lengths(3) = [1.0_dp, 1.0_dp, 1.6_dp]
   integer :: stat
   character(256) :: message

   call of_masses_and_bonds()
   call of_arrays()
   call of_settings()
   call of_steps()
   call finish()

contains

   ! The call before was refused, and its message, which is not cut, has these words.
   subroutine refused(words)
      character(*), intent(in) :: words
      call check(stat /= HOL_OK, words//": something is said")
      call check(index(message, words) > 0, words//" is in: "//trim(message))
      call check(len_trim(message) < len(message), "the message is whole")
      stat = 0
      message = ""
   end subroutine

   subroutine positions(r)
      real(dp), intent(out) :: r(3, n)
      integer :: m
      do m = 0, 2
         r(:, 3*m + 1) = [4.0_dp*m, 0.0_dp, 0.0_dp]
         r(:, 3*m + 2) = [4.0_dp*m + 0.6_dp, 0.8_dp, 0.0_dp]
         r(:, 3*m + 3) = [4.0_dp*m + 0.6_dp, -0.8_dp, 0.0_dp]
      end do
   end subroutine

   subroutine of_masses_and_bonds()
      type(hol_chains) :: chains
      real(dp) :: wrong(n)
      real(dp) :: nan
      call test("masses and bonds")
      nan = ieee_value(nan, ieee_quiet_nan)
      wrong = mass
      wrong(5) = -1
      call chains%create(wrong, stat=stat, errmsg=message)
      call refused("atom 5")
      wrong(5) = nan
      call chains%create(wrong, stat=stat, errmsg=message)
      call refused("atom 5")
      call chains%create(mass)
      call chains%add(bonds=reshape([9, 10], [2, 1]), lengths=1.0_dp, stat=stat, errmsg=message)
      call refused("10")
      call chains%add(bonds=reshape([0, 1], [2, 1]), lengths=1.0_dp, stat=stat, errmsg=message)
      call refused("0")
      call chains%add(bonds=reshape([4, 4], [2, 1]), lengths=1.0_dp, stat=stat, errmsg=message)
      call refused("itself")
      call chains%add(bonds=reshape([1, 2, 2, 1], [2, 2]), lengths=1.0_dp, stat=stat, errmsg=message)
      call refused("bond")
      call chains%add(bonds=pairs, lengths=[1.0_dp, -1.0_dp, 1.0_dp], stat=stat, errmsg=message)
      call refused("length")
      call chains%add(bonds=pairs, lengths=[1.0_dp, nan, 1.0_dp], stat=stat, errmsg=message)
      call refused("length")
      call chains%add(bonds=pairs, lengths=[1.0_dp, 1.0_dp], stat=stat, errmsg=message)
      call refused("lengths")
      call chains%add(bonds=pairs, lengths=[1.0_dp, 1.0_dp, 2.1_dp], stat=stat, errmsg=message)
      call refused("triangle")
      call chains%add(bonds=transpose(pairs), lengths=lengths, stat=stat, errmsg=message) ! (3, 2) for (2, 3)
      call refused("bonds")
      call chains%add_molecules(4, 3, 1, pairs, lengths, stat=stat, errmsg=message)
      call refused("atom")
      call chains%add_molecules(3, 3, 0, pairs, lengths, stat=stat, errmsg=message) ! first atom 0, as in C
      call refused("0")
      call chains%add_molecules(3, 3, 1, pairs, lengths)
      call chains%add_molecules(3, 3, 1, pairs, lengths, stat=stat, errmsg=message)
      call refused("atom 1")
      call chains%destroy()
   end subroutine

   subroutine of_arrays()
      type(hol_chains) :: chains
      real(dp) :: r(3, n), v(3, n), short(3, n - 1), across(n, 3), tension(4)
      call test("arrays")
      call positions(r)
      v = 0
      call chains%forces(r, stat=stat, errmsg=message) ! not created
      call refused("create")
      call chains%create(mass)
      call chains%add_molecules(3, 3, 1, pairs, lengths)
      short = r(:, :n - 1)
      call chains%project_velocities(short, v, stat=stat, errmsg=message)
      call refused("r")
      across = transpose(r)
      call chains%project_velocities(r, across, stat=stat, errmsg=message)
      call refused("v")
      tension = -7
      call chains%forces(r, v, tension=tension, stat=stat, errmsg=message)
      call refused("tension")
      call check(all(same_bits(tension, -7.0_dp)), "nothing is written")
      call chains%destroy()
   end subroutine

   subroutine of_settings()
      type(hol_chains) :: chains
      real(dp) :: nan
      call test("settings")
      nan = ieee_value(nan, ieee_quiet_nan)
      call chains%create(mass)
      call chains%add_molecules(3, 3, 1, pairs, lengths)
      call chains%set_box([3.0_dp, 20.0_dp, 20.0_dp], stat=stat, errmsg=message)
      call refused("bond")
      call chains%set_box([20.0_dp, nan, 20.0_dp], stat=stat, errmsg=message)
      call refused("box")
      call chains%set_tolerance(-1e-8_dp, stat=stat, errmsg=message)
      call refused("tolerance")
      call chains%set_threads(0, stat=stat, errmsg=message)
      call refused("threads")
      call chains%set_lengths([1.0_dp, 1.0_dp], stat=stat, errmsg=message)
      call refused("lengths")
      call chains%set_masses([1.0_dp, 1.0_dp], stat=stat, errmsg=message)
      call refused("masses")
      call chains%destroy()
   end subroutine

   subroutine of_steps()
      type(hol_chains) :: chains
      real(dp) :: before(3, n), r(3, n), v(3, n), f(3, n), kept(3, n)
      call test("steps")
      call positions(before)
      v = 0
      f = 0
      call chains%create(mass)
      call chains%add_molecules(3, 3, 1, pairs, lengths)
      r = before
      call chains%project_positions(before, r, 0.0_dp, v, stat=stat, errmsg=message)
      call refused("dt")
      r(2, 5) = ieee_value(1.0_dp, ieee_quiet_nan)
      call chains%project_positions(before, r, 1.0_dp, v, stat=stat, errmsg=message)
      call refused("position of atom 5")
      call positions(r)
      f(1, 9) = ieee_value(1.0_dp, ieee_quiet_nan)
      call chains%forces(r, v, f, stat=stat, errmsg=message)
      call refused("atom 9")
      call positions(r)
      r(3, 2) = 300
      kept = r
      call chains%project_positions(before, r, 1.0_dp, v, stat=stat, errmsg=message)
      call refused("forces or time step")
      call check(all(same_bits(r(:, 1:3), kept(:, 1:3))), "its molecule is left as it is")
      call chains%destroy()
   end subroutine

end program
