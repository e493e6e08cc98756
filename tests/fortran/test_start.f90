! Mistakes that are made where a program begins are errors at the first call that can know of them; nothing is moved.
program test_start
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use holonomic
   use checks, only: check, finish, same_bits, test
   implicit none
   integer, parameter :: dp = real64, side = 5, n_waters = side**3, n = 3*n_waters, n_bonds = 3*n_waters
   real(dp), parameter :: oh = 1.0_dp, hh = 1.6329931618554521_dp, spacing = 3.1_dp, cell = side*spacing
   integer, parameter :: pairs(2, 3) = reshape([1, 2, 1, 3, 2, 3], [2, 3])
   real(dp), parameter :: whole_box(3) = cell
   real(dp) :: r(3, n), whole(3, n), mass(n)
   integer :: stat
   character(600) :: message

   call make_waters()
   call a_molecule_is_cut()
   call lengths_are_wrong()
   call atoms_are_counted_otherwise()
   call the_box_is_stale()
   call masses_are_zero()
   call boxes_are_refused()
   call triangles_are_refused()
   call crude_positions()
   call every_layout()
   call finish()

contains

   ! One in each cube of a lattice, turned about z by an angle of its own.
   subroutine make_waters()
      integer :: m, place
      real(dp) :: angle, x(2), y(2), height
      height = sqrt(oh**2 - hh**2/4)
      do m = 1, n_waters
         place = m - 1
         angle = 2.4_dp*m
         x = height*[cos(angle), sin(angle)]
         y = hh/2*[-sin(angle), cos(angle)]
         whole(:, 3*m - 2) = spacing*[mod(place, side), mod(place/side, side), place/side**2]
         whole(:, 3*m - 1) = whole(:, 3*m - 2) + [x + y, 0.0_dp]
         whole(:, 3*m) = whole(:, 3*m - 2) + [x - y, 0.0_dp]
         mass(3*m - 2:3*m) = [16, 1, 1]
      end do
   end subroutine

   subroutine put_into_the_cell()
      r = whole - cell*floor(whole/cell)
   end subroutine

   logical function says(words)
      character(*), intent(in) :: words
      says = index(message, words) > 0
   end function

   ! The first step is refused, and nothing is written.
   subroutine must_be_refused(chains, words)
      type(hol_chains), intent(in) :: chains
      character(*), intent(in) :: words
      real(dp) :: next(3, n), before(3, n), v(3, n), lambda(n_bonds), virial(3, 3)
      type(hol_report) :: report
      integer(int64) :: molecule, bond
      next = r + 1e-3_dp
      before = next
      v = -7
      lambda = -7
      virial = -7
      report%iterations = -7
      message = ""
      call chains%project_positions(r, next, 1.0_dp, v, lambda, virial=virial, report=report, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_LENGTHS, "the call is refused")
      call check(says(words) .and. says("atoms ") .and. says("it should be"), "the message says why: "//trim(message))
      call hol_error_location(molecule, bond)
      call check(molecule >= 1 .and. molecule <= n_waters .and. bond >= 1 .and. bond <= 3, "and where, in numbers")
      call check(all(same_bits(next, before)) .and. all(same_bits(v, -7.0_dp)) .and. all(same_bits(lambda, -7.0_dp)) &
                 .and. all(same_bits(virial, -7.0_dp)) .and. report%iterations == -7, "nothing is written")
      call chains%check(r, stat=stat)
      call check(stat == HOL_ERR_LENGTHS, "on request, too")
   end subroutine

   subroutine add_waters(chains, lengths)
      type(hol_chains), intent(inout) :: chains
      real(dp), intent(in) :: lengths(3)
      call chains%create(mass)
      call chains%add_molecules(n_waters, 3, 1, pairs, lengths)
   end subroutine

   subroutine a_molecule_is_cut()
      type(hol_chains) :: chains
      call test("molecules cut by the cell, and no box")
      call put_into_the_cell()
      call add_waters(chains, [oh, oh, hh])
      call must_be_refused(chains, "no box is set")
      call chains%set_box(whole_box)
      call chains%project_positions(r, r, 1.0_dp, stat=stat)
      call check(stat == HOL_OK, "with the box it is not")
      call chains%destroy()
   end subroutine

   subroutine lengths_are_wrong()
      type(hol_chains) :: chains
      call test("lengths in another unit or order")
      r = whole
      call add_waters(chains, 10*[oh, oh, hh])
      call must_be_refused(chains, "same unit")
      call chains%destroy()
      call add_waters(chains, 0.1_dp*[oh, oh, hh])
      call must_be_refused(chains, "about 10 times")
      call chains%destroy()
      call add_waters(chains, [hh, oh, oh])
      call must_be_refused(chains, "another order")
      call chains%destroy()
   end subroutine

   subroutine atoms_are_counted_otherwise()
      type(hol_chains) :: chains
      integer :: bonds(2, n_bonds - 3), m
      call test("atoms counted from 0, as the list comes from C, but for the first molecule")
      r = whole
      do m = 2, n_waters
         bonds(:, 3*m - 5:3*m - 3) = pairs + 3*(m - 1) - 1
      end do
      call chains%create(mass)
      call chains%add(bonds=bonds, lengths=[([oh, oh, hh], m=2, n_waters)])
      call must_be_refused(chains, "atoms counted from 0 (here from 1)")
      call chains%destroy()
   end subroutine

   subroutine the_box_is_stale()
      type(hol_chains) :: chains
      call test("a box of another time")
      call put_into_the_cell()
      call add_waters(chains, [oh, oh, hh])
      call chains%set_box(1.1_dp*whole_box)
      call must_be_refused(chains, "a box is set")
      call chains%set_box(whole_box)
      call chains%check(r, stat=stat)
      call check(stat == HOL_OK, "and of this one")
      call chains%set_reference_box(1.1_dp*whole_box)
      call chains%check(r, reference=.true., stat=stat)
      call check(stat == HOL_ERR_LENGTHS, "the box of the reference")
      call chains%destroy()
   end subroutine

   subroutine masses_are_zero()
      type(hol_chains) :: chains
      call test("atoms that are all held fixed")
      call chains%create(0*mass, stat=stat, errmsg=message)
      call check(stat == HOL_OK .and. chains%degrees_of_freedom() == 0, "may be")
      call chains%destroy()
   end subroutine

   subroutine boxes_are_refused()
      type(hol_chains) :: chains
      real(dp) :: box(3, 3)
      call test("boxes that are no cell, or too narrow")
      call add_waters(chains, [oh, oh, hh])
      box = 0
      box(:, 1) = cell   ! the three sides in one vector
      call chains%set_box(box, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("no cell"), trim(message))
      call chains%set_box(0.1_dp*whole_box, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("1.55 wide") .and. says("same unit"), trim(message))
      call chains%set_box(2.1_dp*[oh, oh, oh], stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("longest bond, 1.63299 (atoms 2 and 3)"), trim(message))
      call chains%destroy()
   end subroutine

   subroutine triangles_are_refused()
      type(hol_chains) :: chains
      real(dp) :: lengths(n_bonds)
      call test("lengths that make no triangle")
      call chains%create(mass)
      call chains%add_molecules(n_waters, 3, 1, pairs, [1.0_dp, 1.0_dp, 2.1_dp], stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("bond 3 (atoms 2 and 3) has the length 2.1") .and. says("atom 1"), &
                 trim(message))
      call check(chains%n_bonds() == 0, "nothing is added")
      call chains%destroy()
      call add_waters(chains, [oh, oh, hh])
      lengths = oh
      lengths(6) = 109.47_dp   ! an angle
      call chains%set_lengths(lengths, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_VALUE .and. says("bond 6 (atoms 5 and 6)"), trim(message))
      call chains%destroy()
   end subroutine

   subroutine crude_positions()
      type(hol_chains) :: chains
      type(hol_report) :: report
      real(dp) :: error
      integer(int64) :: molecule
      call test("crude positions, said so")
      r = whole
      r(1, 5) = r(1, 5) + 0.4_dp
      call add_waters(chains, [oh, oh, hh])
      call must_be_refused(chains, "molecule 2, ")
      call chains%set_checks(HOL_NEVER)
      call chains%project_positions(r, r, 1.0_dp, report=report)
      call chains%reference_error(error, molecule)
      call check(error > 0.2_dp .and. molecule == 2, "the reference's own error is told")
      call check(report%max_error < 1e-13_dp, "and what is left")
      call chains%set_checks(HOL_AT_START)
      call chains%check(r, stat=stat)
      call check(stat == HOL_OK, "the positions are right afterwards")
      call chains%set_checks(7, stat=stat)
      call check(stat == HOL_ERR_VALUE, "no such time")
      call chains%destroy()
   end subroutine

   subroutine every_layout()
      type(hol_chains) :: chains
      call test("layouts")
      r = whole
      call add_waters(chains, [oh, oh, hh])
      call chains%check(real(r, real32), stat=stat)
      call check(stat == HOL_OK, "single precision")
      call chains%check(r(1, :), r(2, :), r(3, :), stat=stat)
      call check(stat == HOL_OK, "separate arrays")
      call chains%check(real(r(1, :), real32), real(r(2, :), real32), real(r(3, :), real32), stat=stat)
      call check(stat == HOL_OK, "of single precision")
      call chains%check(2*r(1, :), r(2, :), r(3, :), stat=stat)
      call check(stat == HOL_ERR_LENGTHS, "with an x that is wrong")
      call chains%destroy()
   end subroutine

end program
