! What happens to wrong arguments and bad data: stat and errmsg as in ALLOCATE, outputs left alone bit for bit, numbers
! counted from 1.
program test_arguments
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use checks, only: check, finish, same_bits, test
   use holonomic
   implicit none

   integer, parameter :: n_chains = 4, n_beads = 5, n = n_chains*n_beads, n_bonds = n_chains*(n_beads - 1)
   type(hol_chains) :: chains
   real(real64), dimension(3, n) :: r, v, f, g, r_ref
   real(real64) :: lambda(n_bonds), tension(n_bonds), virial(3, 3), nan
   type(hol_report) :: report
   type(hol_worst) :: worst
   character(200) :: message
   integer :: stat, i

   nan = ieee_value(nan, ieee_quiet_nan)
   call chains%create([(1.0_real64, i=1, n)])
   call chains%add(n_chains, n_beads - 1, 1, 1.0_real64)

   call success_leaves_errmsg_alone()
   call masses_are_checked()
   call lists_are_checked()
   call options_are_checked()
   call shapes_are_checked()
   call an_array_that_is_half_given()
   call bad_chains_are_named_and_left_alone()
   call positions_that_cannot_be_reached()
   call messages_name_the_procedure()
   call chains%destroy()
   call finish()

contains

   subroutine reset()
      integer :: c, b
      do c = 0, n_chains - 1
         do b = 1, n_beads
            r(:, c*n_beads + b) = [b*0.8_real64, mod(b, 2)*0.6_real64, 3.0_real64*c]
         end do
      end do
      call random_number(v)
      call random_number(f)
      g = -7
      lambda = -7
      tension = -7
      virial = -7
      r_ref = r
      message = "unchanged"
      stat = -7
   end subroutine

   logical function nothing_written()
      nothing_written = all(same_bits(g, -7.0_real64)) .and. all(same_bits(lambda, -7.0_real64)) .and. &
                        all(same_bits(tension, -7.0_real64)) .and. all(same_bits(virial, -7.0_real64))
   end function

   pure logical function says(text)
      character(*), intent(in) :: text
      says = index(message, text) > 0
   end function

   subroutine success_leaves_errmsg_alone()
      call test("a success")
      call reset()
      call chains%forces(r, v, f, g=g, stat=stat, errmsg=message)
      call check(stat == HOL_OK .and. message == "unchanged", "stat is 0, errmsg as it was")
   end subroutine

   subroutine masses_are_checked()
      type(hol_chains) :: other
      call test("masses")
      call reset()
      call other%create([1.0_real64, 1.0_real64, -1.0_real64], stat, message)
      call check(stat == HOL_ERR_VALUE, "a negative mass is refused")
      call check(says("atom 3") .and. .not. says("atom 2"), "and counted from 1")
      call check(other%n_atoms() == 0, "nothing was created")
      call other%create([nan], stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("atom 1"), "NaN is refused")
      call chains%create([1.0_real64], stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("created already"), "chains are not created twice")
      call check(chains%n_atoms() == n, "and the first ones stay")
   end subroutine

   subroutine lists_are_checked()
      type(hol_chains) :: other
      integer(int64) :: chain, bond, atom, n_bad
      call test("lists of atoms")
      call reset()
      call other%create([(1.0_real64, i=1, 6)])
      call other%add([1, 2, 3], [1.0_real64, 1.0_real64])
      call other%add([4, 7], [1.0_real64], stat, message)
      call check(stat == HOL_ERR_INDEX .and. says("atom 7") .and. says("1 .. 6"), "an atom that does not exist")
      call hol_error_location(chain, bond, atom, n_bad)
      call check(atom == 7 .and. chain == 2 .and. n_bad == 0, "is told in numbers from 1")
      call other%add([0, 4], [1.0_real64], stat, message)
      call check(stat == HOL_ERR_INDEX .and. says("atom 0"), "there is no atom 0")
      call other%add([4, 3], [1.0_real64], stat, message)
      call check(stat == HOL_ERR_SHARED_ATOM .and. says("atom 3"), "an atom of another chain")
      call other%add([4_int64, 5_int64, 4_int64], 1.0_real64, stat, message)
      call check(stat == HOL_ERR_SHARED_ATOM .and. says("atom 4"), "an atom twice in a chain")
      call other%add([4, 5], [0.0_real64], stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("bond 1"), "a length of zero")
      call other%add([4, 5, 6], [1.0_real64], stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("1 lengths") .and. says("2 bonds"), "too few lengths")
      call hol_error_location(chain, bond, atom, n_bad)
      call check(chain == -1 .and. bond == -1 .and. atom == -1 .and. n_bad == 0, "which is nowhere in the molecules")
      call other%add([4], [real(real64) ::], stat, message)
      call check(stat == HOL_OK, "a chain of one atom has no bond to be added")
      call other%add([integer ::], 1.0_real64, stat, message)
      call check(stat == HOL_OK, "nor has a chain of none")
      call other%add(2, 1, 4, 1.0_real64, stat, message)
      call check(stat == HOL_ERR_INDEX .and. says("atom 4"), "a block that reaches too far")
      call other%add(1, 0, 4, 1.0_real64, stat, message)
      call check(stat == HOL_OK, "nor have chains without bonds")
      call other%add(0, 1, 4, 1.0_real64, stat, message)
      call check(stat == HOL_OK, "nor has a block of no chains")
      call other%add(1, 2, 4, [1.0_real64], stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("2 bonds"), "a block with too few lengths")
      call check(other%n_molecules() == 1 .and. other%n_bonds() == 2, "nothing was added by any of these")
      call other%add([4, 5, 6], 1.0_real64, stat)
      call check(stat == HOL_OK .and. other%n_molecules() == 2, "and the chains stay usable")
      call other%destroy()
   end subroutine

   subroutine options_are_checked()
      call test("options")
      call reset()
      call chains%set_threads(0, stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("n_threads"), "no threads")
      call chains%set_tolerance(-1.0_real64, stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("tolerance"), "a negative tolerance")
      call chains%set_max_iterations(0, stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("max_iterations"), "no iterations")
      call chains%set_box([1.0_real64, nan, 1.0_real64], stat, message)
      call check(stat == HOL_ERR_VALUE, "a box that is not finite")
      call chains%set_active([.true.], stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("active") .and. says("4 molecules"), "too few flags")
      call check(chains%degrees_of_freedom(4) == -1, "four dimensions")
   end subroutine

   subroutine shapes_are_checked()
      real(real64) :: short(3, n - 1), short_lambda(n_bonds - 1), flat(2, n), four(4, n)
      integer(int64) :: few(2)
      call test("sizes and shapes")
      call reset()
      call chains%forces(short, v, f, lambda, tension, g, virial=virial, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("r has 19 elements, too few for 20 atoms"), "r too small")
      call chains%forces(r, v, short, lambda, tension, g, virial=virial, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("f has 19"), "f too small")
      call chains%forces(r, v, f, short_lambda, tension, g, virial=virial, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("lambda has 15 elements, too few for 16 bonds"), "lambda too small")
      call chains%forces(r, v, f, lambda, short_lambda, g, virial=virial, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("tension has 15"), "tension too small")
      call chains%forces(r, v, f, lambda, tension, short, virial=virial, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("g has 19"), "g too small")
      call chains%forces(r, flat, f, lambda, tension, g, virial=virial, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE, "two and three dimensions in one call")
      call chains%forces(four, v, f, lambda, tension, g, virial=virial, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("the first dimension of r") .and. says("not 4"), "four rows")
      call chains%forces(r(1, :), r(2, :), r(3, :), fx=f(1, :), fy=f(2, :), fz=f(3, :n - 1), lambda=lambda, &
                         gx=g(1, :), gy=g(2, :), gz=g(3, :), virial=virial, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("fz has 19"), "one of separate arrays too small")
      call check(nothing_written(), "nothing was written by any of these")
      call chains%project_positions(short, r, 0.1_real64, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("r_ref has 19"), "r_ref too small")
      call chains%project_velocities(r, short, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("v has 19"), "v too small")
      call chains%violation(r, short, worst, stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("v has 19"), "v too small for violation")
      few = -7
      call chains%offsets(few, stat, message)
      call check(stat == HOL_ERR_VALUE .and. all(few == -7), "offsets too small")
      call chains%atoms(few, stat, message)
      call check(stat == HOL_ERR_VALUE .and. all(few == -7), "a list of atoms too small")
      call check(all(same_bits(r, r_ref)), "positions were not changed by any of these")
   end subroutine

   subroutine an_array_that_is_half_given()
      call test("separate arrays that are not complete")
      call reset()
      call chains%forces(r(1, :), r(2, :), r(3, :), vx=v(1, :), lambda=lambda, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_NULL .and. says("vx and vy"), "vx without vy")
      call chains%forces(r(1, :), r(2, :), r(3, :), gz=g(3, :), lambda=lambda, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_NULL .and. says("gx and gy"), "gz alone")
      call chains%forces(r(1, :), r(2, :), r(3, :), vx=v(1, :), vy=v(2, :), lambda=lambda, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE, "z without vz")
      call check(nothing_written(), "nothing was written by any of these")
      call chains%project_positions(r_ref, r, 0.1_real64, guess=.true., stat=stat, errmsg=message)
      call check(stat == HOL_ERR_NULL .and. says("lambda"), "a guess without multipliers")
      call chains%project_positions(r_ref, r, -0.1_real64, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("dt"), "a negative time step")
   end subroutine

   subroutine bad_chains_are_named_and_left_alone()
      real(real64) :: good_g(3, n), good_lambda(n_bonds), before(3, n)
      integer(int64) :: chain, bond, atom, n_bad
      call test("bad chains")
      call reset()
      call chains%forces(r, v, f, good_lambda, g=good_g)
      v(2, 8) = nan               ! chain 2
      r(:, 17) = r(:, 16)         ! chain 4, first bond
      call chains%forces(r, v, f, lambda, tension, g, virial=virial, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_NOT_FINITE .and. says("molecule 2") .and. says("atom 8"), "the first one is named")
      call hol_error_location(chain, bond, atom, n_bad)
      call check(chain == 2 .and. atom == 8 .and. n_bad == 2, "in numbers, too, with how many there are")
      call check(all(same_bits(g(:, 6:10), -7.0_real64)) .and. all(same_bits(g(:, 16:20), -7.0_real64)) .and. &
                 all(same_bits(lambda(5:8), -7.0_real64)) .and. all(same_bits(tension(13:16), -7.0_real64)), &
                 "their outputs are left alone")
      call check(all(same_bits(g(:, 1:5), good_g(:, 1:5))) .and. all(same_bits(g(:, 11:15), good_g(:, 11:15))) .and. &
                 all(same_bits(lambda(9:12), good_lambda(9:12))), "the others are complete")
      call check(all(same_bits(virial, -7.0_real64)), "sums are not written")
      v(2, 8) = 0
      call chains%forces(r, v, f, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_DEGENERATE .and. says("molecule 4") .and. says("bond 1"), "a bond of length zero")
      before = v
      call chains%project_velocities(r, v, virial=virial, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_DEGENERATE .and. says("molecule 4"), "in project_velocities")
      call check(all(same_bits(v(:, 16:20), before(:, 16:20))) .and. .not. all(same_bits(v(:, :5), before(:, :5))), &
                 "its velocities are left alone, the others are projected")
      r(1, 3) = nan
      worst%length = -7
      call chains%violation(r, worst=worst, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_NOT_FINITE .and. says("molecule 1") .and. same_bits(worst%length, -7.0_real64), &
                 "in violation")
   end subroutine

   subroutine positions_that_cannot_be_reached()
      real(real64), dimension(3, n) :: before, before_v
      call test("positions that cannot be reached")
      call reset()
      r = r + 0.01_real64*v
      r(1, 12) = r(1, 12) + 1000   ! chain 3
      call chains%set_checks(HOL_NEVER)   ! which would refuse the whole call
      before = r
      before_v = v
      call chains%project_positions(r_ref, r, 0.01_real64, v, lambda, virial=virial, report=report, stat=stat, &
                                    errmsg=message)
      call check(stat == HOL_ERR_NO_CONVERGENCE .and. says("molecule 3"), "the chain is named")
      call check(report%n_failed == 1 .and. report%n_corrected == 3, "and counted in the report")
      call check(all(same_bits(r(:, 11:15), before(:, 11:15))) .and. all(same_bits(v(:, 11:15), before_v(:, 11:15))) &
                 .and. all(same_bits(lambda(9:12), -7.0_real64)), "it is left alone")
      call check(all(same_bits(virial, -7.0_real64)), "sums are not written")
      r(:, 11:15) = r_ref(:, 11:15)
      call chains%violation(r, worst=worst)
      call check(worst%length < 1e-14_real64, "the others are complete")
   end subroutine

   ! Whether the procedure or the library found the fault, the message begins with the name that the caller knows.
   subroutine messages_name_the_procedure()
      real(real64) :: z(2)
      call test("messages name the procedure")
      call reset()
      call chains%forces(r(:, :5), stat=stat, errmsg=message)
      call check(message == "forces: r has 5 elements, too few for 20 atoms", "a fault that Fortran finds")
      call chains%add_forces(r(:, :5), f=f, stat=stat, errmsg=message)
      call check(index(message, "add_forces: r has") == 1, "add_forces is not forces")
      call chains%project_positions(r_ref, r, -0.1_real64, stat=stat, errmsg=message)
      call check(index(message, "project_positions: ") == 1 .and. .not. says("hol_") .and. says("dt"), &
                 "a fault that the library finds")
      r(1, 3) = nan
      call chains%project_velocities(r, v, stat=stat, errmsg=message)
      call check(index(message, "project_velocities: ") == 1 .and. .not. says("hol_") .and. says("atom 3"), "bad data")
      call chains%set_threads(0, stat, message)
      call check(index(message, "set_threads: ") == 1 .and. .not. says("hol_"), "an option")
      call hol_tridiagonal_solve([2.0_real64], [1.0_real64, 1.0_real64], z, stat, message)
      call check(index(message, "hol_tridiagonal_solve: ") == 1 .and. .not. says(": hol_"), "a free procedure")
   end subroutine

end program
