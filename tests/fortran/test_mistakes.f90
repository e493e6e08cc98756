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
   call of_same_arrays()
   call of_settings()
   call of_steps()
   call of_bodies()
   call of_sites()
   call of_boxes()
   call of_questions()
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

   ! One array in another one's place.
   subroutine of_same_arrays()
      type(hol_chains) :: chains
      type(hol_worst) :: worst
      real(dp), target :: r(3, n), moved(3, n), f(3, n)
      real(dp), pointer :: other(:, :)
      real(dp) :: kept(3, n), size_of(9), rate(9)
      call test("one array for another")
      call positions(r)
      call positions(moved)
      moved(3, 5) = 0.01_dp
      kept = r
      f = 1
      call chains%create(mass)
      call chains%add_molecules(3, 3, 1, pairs, lengths)
      other => r
      call chains%project_velocities(r, other, stat=stat, errmsg=message)
      call refused("v is the array that was given for r")
      call chains%forces(r, other, f, stat=stat, errmsg=message)
      call refused("v is the array that was given for r")
      call chains%forces(r, f=f, g=other, stat=stat, errmsg=message)
      call refused("g is the array that was given for r")
      call chains%violation(r, other, worst, stat=stat, errmsg=message)
      call refused("v is the array that was given for r")
      call chains%residuals(r, other, size_of, rate, stat=stat, errmsg=message)
      call refused("v is the array that was given for r")
      call chains%project_positions(r, moved, 1.0_dp, other, stat=stat, errmsg=message)
      call refused("v is the array that was given for r_ref")
      call chains%metric(r, 1.0_dp, force=other, stat=stat, errmsg=message)
      call refused("force is the array that was given for r")
      call check(all(same_bits(r, kept)), "nothing is changed")
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

   subroutine of_bodies()
      type(hol_chains) :: chains
      real(dp) :: places(3, 3), wrong(3, 3), r(3, 3)
      call test("bodies")
      places = reshape([0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp], [3, 3])
      call chains%create([0.0_dp, 0.0_dp, 1.0_dp])
      call chains%add_rigid([1, 2], places(:, :2), stat=stat, errmsg=message)
      call refused("mass")
      call chains%destroy()
      call chains%create([16.0_dp, 1.0_dp, 1.0_dp])
      call chains%add_rigid([1, 2, 4], places, stat=stat, errmsg=message)
      call refused("atom 4")
      call chains%add_rigid([0, 1, 2], places, stat=stat, errmsg=message)
      call refused("atom 0")
      call chains%add_rigid([1, 2, 2], places, stat=stat, errmsg=message)
      call refused("atom 2")
      call chains%add_rigid([1, 2, 3], places(:, :2), stat=stat, errmsg=message)
      call refused("places")
      wrong = 0
      call chains%add_rigid([1, 2, 3], wrong, stat=stat, errmsg=message)
      call refused("")
      wrong = places
      wrong(2, 2) = ieee_value(1.0_dp, ieee_quiet_nan)
      call chains%add_rigid([1, 2, 3], wrong, stat=stat, errmsg=message)
      call refused("atom 2")
      call chains%add_linear([1, 2, 3], [1.0_dp, 1.0_dp, -1.0_dp], stat=stat, errmsg=message)
      call refused("add up to 0")
      call chains%add_linear([1, 2, 3], [1.0_dp, -1.0_dp], stat=stat, errmsg=message)
      call refused("coefficients")
      call chains%add_rigid([1, 2, 3], places)
      r = places(:, [2, 1, 3]) ! another order of atoms
      call chains%check(r, stat=stat, errmsg=message)
      call refused("order of atoms")
      call chains%metric(places, 1.0_dp, stat=stat, errmsg=message)
      call refused("rigid bodies")
      call chains%destroy()
   end subroutine

   ! A site that nails its water to a point in space, as a bond, and as it is meant, as an atom of a body.
   subroutine of_sites()
      type(hol_chains) :: chains
      real(dp), parameter :: with_site(4) = [16.0_dp, 1.0_dp, 1.0_dp, 0.0_dp]
      logical :: is_held(4)
      real(dp) :: places(3, 4)
      call test("massless sites")
      call chains%create(with_site)
      call chains%add(bonds=reshape([1, 2, 1, 3, 2, 3, 1, 4], [2, 4]), lengths=[1.0_dp, 1.0_dp, 1.6_dp, 0.15_dp])
      call chains%held_sites(is_held)
      call check(all(is_held .eqv. [.false., .false., .false., .true.]), "it is named")
      call chains%held_sites(is_held(:3), stat=stat, errmsg=message)
      call refused("is_held")
      call chains%destroy()
      call chains%held_sites(is_held, stat=stat, errmsg=message)
      call refused("create")
      call chains%create(with_site)
      places = reshape([0.0_dp, 0.0_dp, 0.0_dp, 0.6_dp, 0.8_dp, 0.0_dp, 0.6_dp, -0.8_dp, 0.0_dp, 0.15_dp, 0.0_dp, 0.0_dp], [3, 4])
      call chains%add_rigid([1, 2, 3, 4], places)
      call chains%held_sites(is_held)
      call check(.not. any(is_held), "in a body it is none")
      call chains%destroy()
   end subroutine

   ! A cube of 10 with waters across its face: in one of 10.1 they fit worse than those inside.
   subroutine of_boxes()
      type(hol_chains) :: chains
      integer, parameter :: m = 8
      real(dp) :: r(3, 3*m), masses(3*m), kept(3, 3*m), places(3, 3)
      integer :: k
      call test("a box that is slightly wrong")
      masses = 1
      places = reshape([0.0_dp, 0.0_dp, 0.0_dp, 0.6_dp, 0.8_dp, 0.0_dp, 0.6_dp, -0.8_dp, 0.0_dp], [3, 3])
      do k = 0, m - 1
         r(:, 3*k + 1) = [merge(9.7_dp, 4.0_dp, k == 0), 1.1_dp*k, 2.0_dp]
         r(:, 3*k + 2) = r(:, 3*k + 1) + [0.6_dp, 0.8_dp, 0.0_dp]
         r(:, 3*k + 3) = r(:, 3*k + 1) + [0.6_dp, -0.8_dp, 0.0_dp]
      end do
      r = modulo(r, 10.0_dp)
      kept = r
      do k = 1, 2
         call chains%create(masses)
         if (k == 1) call chains%add_molecules(m, 3, 1, pairs, lengths)
         if (k == 2) call chains%add_rigid_molecules(m, 3, 1, [1, 2, 3], places)
         call chains%set_box([10.05_dp, 10.05_dp, 10.05_dp])
         call chains%project_positions(kept, r, 1.0_dp, stat=stat, errmsg=message)
         call check(stat == HOL_ERR_LENGTHS, "its status")
         call refused("a face of the box cuts it")
         call check(all(same_bits(r, kept)), "nothing is moved")
         call chains%set_box([10.0_dp, 10.0_dp, 10.0_dp])
         call chains%project_positions(kept, r, 1.0_dp)
         r = kept
         call chains%set_box() ! forgotten
         call chains%check(r, stat=stat, errmsg=message)
         call refused("no box is set")
         call chains%destroy()
      end do
   end subroutine

   subroutine of_questions()
      type(hol_chains) :: chains
      type(hol_inverse) :: inverse
      real(dp) :: r(3, n), scaled(3, n), lambda(9), long_enough(9), rate(3, 3)
      integer(int64) :: list(3)
      integer :: status(3)
      call test("questions and options")
      call positions(r)
      call chains%create(mass)
      call chains%add_molecules(3, 3, 1, pairs, lengths)
      call chains%atoms(4, list, stat=stat, errmsg=message)
      call refused("molecule 4")
      call chains%atoms(0, list, stat=stat, errmsg=message) ! as in C
      call refused("molecule 0")
      call chains%molecule(4, stat=stat, errmsg=message)
      call refused("molecule 4")
      call inverse%create(chains, 4, r, stat=stat, errmsg=message)
      call refused("molecule 4")
      call chains%outcomes(status, stat=stat, errmsg=message)
      call refused("outcomes were not kept")
      call chains%reference_error(long_enough(1), stat=stat, errmsg=message)
      call refused("no reference")
      call chains%set_checks(7, stat=stat, errmsg=message)
      call refused("HOL_NEVER")
      call chains%set_bodies(7, stat=stat, errmsg=message)
      call refused("HOL_BODIES")
      call chains%set_tolerance(1.0_dp, stat=stat, errmsg=message)
      call refused("below 1")
      call chains%set_tolerance(ieee_value(1.0_dp, ieee_quiet_nan), stat=stat, errmsg=message)
      call refused("tolerance")
      call chains%set_length_tolerance(1.0_dp, stat=stat, errmsg=message)
      call refused("0.01")
      call chains%set_max_iterations(0, stat=stat, errmsg=message)
      call refused("max_iterations")
      call chains%set_memory_limit(-5, stat=stat, errmsg=message)
      call refused("bytes")
      call chains%set_length(10, 1.0_dp, stat=stat, errmsg=message)
      call refused("bond 10")
      call chains%set_length(1, -1.0_dp, stat=stat, errmsg=message)
      call refused("length")
      call chains%set_lengths([1.0_dp, 1.0_dp, 3.0_dp, 1.0_dp, 1.0_dp, 1.6_dp, 1.0_dp, 1.0_dp, 1.6_dp], stat=stat, errmsg=message)
      call refused("triangle")
      call chains%set_masses([0.0_dp, mass(2:)], stat=stat, errmsg=message)
      call refused("atom 1")
      call chains%set_active([.true.], stat=stat, errmsg=message)
      call refused("active")
      call chains%set_labels([1, 2, 3], stat=stat, errmsg=message)
      call refused("atoms")
      rate = ieee_value(1.0_dp, ieee_quiet_nan)
      call chains%set_box_rate(rate, stat=stat, errmsg=message)
      call refused("rate")
      call chains%solve(r, [1.0_dp, 2.0_dp], stat=stat, errmsg=message)
      call refused("rhs")
      lambda = 0
      lambda(6) = ieee_value(1.0_dp, ieee_quiet_nan)
      call chains%reactions(r, lambda, tension=long_enough, stat=stat, errmsg=message)
      call refused("")
      call chains%metric(r, -1.0_dp, stat=stat, errmsg=message)
      call refused("kT")
      call chains%project_positions(r, scaled, 1.0_dp, guess=.true., stat=stat, errmsg=message)
      call refused("lambda")
      scaled = 0.1_dp*r ! nanometres for Angstrom
      call chains%check(scaled, stat=stat, errmsg=message)
      call refused("unit")
      scaled = r(:, [1, 4, 7, 2, 5, 8, 3, 6, 9]) ! all oxygens first
      call chains%check(scaled, stat=stat, errmsg=message)
      call refused("order")
      call chains%destroy()
   end subroutine

end program
