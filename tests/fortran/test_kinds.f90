! What is given in default reals, or by integers of either size, is the same as by real64 and int64; what was set can be asked.
program test_kinds
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   use checks, only: check, finish, test
   use holonomic
   implicit none
   real(real64), parameter :: mass(4) = [2.0_real64, 1.5_real64, 1.0_real64, 4.0_real64]
   real(real64), parameter :: r(3, 4) = reshape([0.0_real64, 0.0_real64, 0.0_real64, 1.0_real64, 0.0_real64, 0.0_real64, &
                                                 1.0_real64, 1.0_real64, 0.0_real64, 1.0_real64, 1.0_real64, 1.0_real64], [3, 4])
   real(real64), parameter :: length(3) = 1

   call single_reals()
   call bodies_and_relations()
   call inverse_by_either_integer()
   call lists_of_either_integer()
   call settings_are_told()
   call factors()
   call finish()

contains

   ! All of these are numbers that both kinds have.
   subroutine single_reals()
      type(hol_chains) :: single, double
      real(real64) :: lambda(3), expected(3)
      real(real32) :: of_single(4), box(3, 3), lengths(3)
      call test("masses, lengths, boxes and tolerances in default reals")
      call double%create(mass)
      call double%add([1, 2, 3, 4], length)
      call single%create(real(mass, real32))
      call single%add([1_int64, 2_int64, 3_int64, 4_int64], 1.0_real32)
      call single%set_box([8.0_real32, 9.0_real32, 10.0_real32])
      call double%set_box([8.0_real64, 9.0_real64, 10.0_real64])
      call double%forces(r, -r, r, lambda=expected)
      call single%forces(real(r, real32), real(-r, real32), real(r, real32), lambda=lambda)
      call check(all(abs(lambda - expected) <= 0), "the same multipliers, bit for bit")
      call single%atom_masses(of_single)
      call check(all(abs(of_single - real(mass, real32)) <= 0), "masses")
      call single%box(box)
      call check(abs(box(2, 2) - 9) <= 0, "box")
      call single%set_length(2, 1.25_real32)
      call single%set_length(3_int64, 1.5_real64)
      call single%bond_lengths(lengths)
      call check(all(abs(lengths - [1.0_real32, 1.25_real32, 1.5_real32]) <= 0), "lengths")
      call single%set_length_tolerance(0.005)
      call check(abs(single%length_tolerance() - 0.005_real64) < 1e-9_real64, "tolerance of lengths")
      call single%destroy()
      call double%destroy()
   end subroutine

   subroutine bodies_and_relations()
      type(hol_chains) :: single, double
      real(real64) :: g(3, 4), expected(3, 4)
      integer :: stat
      call test("places and coefficients in default reals")
      g = 0   ! of the atom that is in no molecule
      expected = 0
      call double%create(mass)
      call double%add_rigid([1, 2, 3], r(:, :3))
      call single%create(mass)
      call single%add_rigid([1_int64, 2_int64, 3_int64], real(r(:, :3), real32))
      call double%forces(r, f=3*r*r - r, g=expected)
      call single%forces(r, f=3*r*r - r, g=g)
      call check(all(abs(g - expected) <= 0) .and. any(abs(g) > 0), "the same forces on the body, bit for bit")
      call single%destroy()
      call single%create(mass)
      call single%add_rigid_molecules(1, 4, 1, [1, 2, 3], real(r(:, :3), real32))
      call single%forces(r, f=3*r*r - r, g=g)
      call check(all(abs(g - expected) <= 0), "and of a molecule of one")
      call single%add_rigid([1], real(r(:, :2), real32), stat=stat)
      call check(stat == HOL_ERR_VALUE, "two places for one atom are refused")
      call single%destroy()
      call double%destroy()
      call double%create(mass)
      call double%add_linear([1, 2, 3], [0.5_real64, -1.0_real64, 0.5_real64])
      call single%create(mass)
      call single%add_linear([1_int64, 2_int64, 3_int64], [0.5_real32, -1.0_real32, 0.5_real32])
      call check(single%degrees_of_freedom() == double%degrees_of_freedom() .and. single%degrees_of_freedom() == 9, "relations")
      call single%destroy()
      call double%destroy()
   end subroutine

   subroutine inverse_by_either_integer()
      type(hol_chains) :: chains
      type(hol_inverse) :: inverse
      real(real64) :: one, other, row(3), wide_row(3)
      call test("the inverse by int32 and int64")
      call chains%create(mass)
      call chains%add([1, 2, 3, 4], length)
      call inverse%create(chains, 1_int64, r)
      call inverse%entry(2_int64, 3_int64, one)
      call inverse%row(2_int64, wide_row, scaling=HOL_PHYSICAL)
      call inverse%destroy()
      call inverse%create(chains, 1_int32, r(1, :), r(2, :), r(3, :))
      call inverse%entry(2_int32, 3_int32, other)
      call inverse%row(2_int32, row, scaling=HOL_PHYSICAL)
      call check(abs(one - other) <= 0 .and. abs(one) < 1, "elements")
      call check(all(abs(row - wide_row) <= 0), "rows")
      call inverse%destroy()
      call chains%destroy()
   end subroutine

   subroutine lists_of_either_integer()
      type(hol_chains) :: chains
      integer(int32) :: atoms(8), bonds(3), first(3), molecules(3), pairs(2, 3), untouched(1)
      integer(int64) :: wide(8)
      integer :: stat
      call test("lists of int32 and int64")
      call chains%create(mass)
      call chains%add([2, 1], 1.0_real64)
      call chains%add([3, 4], 1.0_real64)
      call chains%atoms(atoms)
      call chains%atoms(wide)
      call check(all(atoms(:4) == [2, 1, 3, 4]) .and. all(wide(:4) == atoms(:4)), "atoms of all")
      call chains%atoms(2, atoms)
      call chains%atoms(2_int64, atoms(5:8:2))
      call check(all(atoms(:2) == [3, 4]) .and. all(atoms(5:8:2) == [3, 4]), "atoms of one, also into a section")
      call chains%bonds(2_int64, bonds)
      call check(bonds(1) == 2, "bonds")
      call check(chains%n_of_shape(0_int32) == 2 .and. chains%n_of_shape(0_int64) == 2, "shapes")
      call check(hol_status_name(1_int32) == hol_status_name(1_int64), "names")
      call chains%offsets(first)
      call check(all(first == [1, 2, 3]), "offsets")
      call chains%molecules_of_bonds(molecules)
      call check(all(molecules(:2) == [1, 2]), "molecules of bonds")
      call chains%bond_pairs(pairs)
      call check(all(pairs(:, 1) == [2, 1]) .and. all(pairs(:, 2) == [3, 4]), "pairs")
      untouched = 7
      call chains%atoms(2, untouched, stat=stat)
      call check(stat == HOL_ERR_VALUE .and. untouched(1) == 7, "a list that is too short is refused")
      call chains%destroy()
   end subroutine

   subroutine settings_are_told()
      type(hol_chains) :: chains, copy
      real(real64) :: rate(3, 3), L(3, 3)
      real(real32) :: short_rate(3, 3)
      integer(int64) :: wide(4)
      integer :: labels(4), of_molecules(2), i
      logical :: is_active(2)
      call test("every setting can be asked")
      call check(chains%threads() == 0, "nothing of what was not created")
      call chains%create(mass)
      call chains%add([1, 2], 1.0_real64)
      call chains%add([3, 4], 1.0_real64)
      call check(chains%threads() == 1 .and. chains%max_iterations() == 50 .and. chains%memory_limit() == 0, "defaults: bounds")
      call check(chains%checks() == HOL_AT_START .and. chains%bodies() == HOL_BODIES_FOUND, "defaults: choices")
      call check(.not. chains%keeps_outcomes() .and. abs(chains%tolerance()) <= 0, "defaults: outcomes, tolerance")
      call chains%set_threads(3)
      call chains%set_max_iterations(30)
      call chains%set_memory_limit(2_int64**40)
      call chains%set_checks(HOL_ALWAYS)
      call chains%set_bodies(HOL_BODIES_GIVEN)
      call chains%set_outcomes(.true.)
      call chains%set_tolerance(1e-9_real64)
      L = reshape([(real(i, real64), i=1, 9)], [3, 3])
      call chains%set_box_rate(L)
      call chains%set_active([.true., .false.])
      call chains%set_labels([11, 12, 13, 14])
      call copy%copy_of(chains)
      call chains%destroy()
      call check(copy%threads() == 3 .and. copy%max_iterations() == 30 .and. copy%memory_limit() == 2_int64**40, "bounds")
      call check(copy%checks() == HOL_ALWAYS .and. copy%bodies() == HOL_BODIES_GIVEN, "choices")
      call check(copy%keeps_outcomes() .and. abs(copy%tolerance() - 1e-9_real64) <= 0, "outcomes, tolerance")
      call copy%box_rate(rate)
      call copy%box_rate(short_rate)
      call check(all(abs(rate - L) <= 0) .and. all(abs(short_rate - real(L, real32)) <= 0), "rate of the box")
      call copy%active(is_active)
      call check(is_active(1) .and. .not. is_active(2), "active")
      call copy%labels(labels, of_molecules)
      call copy%labels(wide)
      call check(all(labels == [11, 12, 13, 14]) .and. all(wide == labels) .and. all(of_molecules == [1, 2]), "labels")
      call copy%destroy()
   end subroutine

   ! Beside forces and solve of the set itself.
   subroutine factors()
      type(hol_chains) :: chains
      type(hol_factors) :: kept, another
      real(real64) :: lambda(3), expected(3), g(3, 4), of_set(3, 4), virial(3, 3), virials(3, 3, 2), several(3, 2)
      real(real64) :: all_g(3, 4, 2), rhs(3, 2), gx(4), gy(4), gz(4)
      real(real32) :: short(3, 4)
      character(200) :: words
      integer :: stat
      call test("factors that are kept")
      call chains%create(mass)
      call chains%add([1, 2, 3, 4], length)
      call kept%update(r, stat=stat, errmsg=words)
      call check(stat == HOL_ERR_NULL .and. words == "update: create has not been called", "they must be created")
      call kept%create(chains)
      call kept%forces(f=r, lambda=lambda, stat=stat)
      call check(stat == HOL_ERR_STATE, "and updated")
      call kept%update(r(1, :), r(2, :), r(3, :))
      call chains%forces(r, -r, 2*r, lambda=expected, g=of_set, virial=virial)
      call kept%forces(-r, 2*r, lambda=lambda, g=g, virial=virials(:, :, 1))
      call check(near(lambda, expected) .and. near(pack(g, .true.), pack(of_set, .true.)), "forces as those of the set")
      call check(near(pack(virials(:, :, 1), .true.), pack(virial, .true.)), "their virial")
      short = 0
      call kept%forces(real(-r, real32), real(2*r, real32), g=short, add=.true.)
      call check(maxval(abs(short - of_set)) < 1e-5_real64, "in single precision, added")
      call kept%forces(-r(1, :), -r(2, :), -r(3, :), 2*r(1, :), 2*r(2, :), 2*r(3, :), gx=gx, gy=gy, gz=gz)
      call check(near(gy, of_set(2, :)), "in parts")

      rhs = reshape([1.0_real64, -2.0_real64, 0.5_real64, 3.0_real64, 0.25_real64, -1.0_real64], [3, 2])
      call chains%solve(r, rhs(:, 2), expected, of_set)
      call kept%solve(rhs(:, 2), lambda)
      call check(near(lambda, expected), "a right-hand side")
      call kept%solve(rhs(:, 2), lambda, g)
      call check(near(pack(g, .true.), pack(of_set, .true.)), "its forces")
      call kept%solve(rhs, several, all_g, virial=virials)
      call check(near(several(:, 2), expected) .and. near(pack(all_g(:, :, 2), .true.), pack(of_set, .true.)), "several at once")
      call kept%solve(rhs(:2, :), several, stat=stat, errmsg=words)
      call check(stat == HOL_ERR_VALUE .and. words == "solve: rhs must be (n_bonds, n_rhs)", "of the right shape")
      another = kept
      call another%destroy()
      call kept%solve(rhs(:, 2), lambda)
      call check(near(lambda, expected), "a copy owns nothing")
      call chains%set_lengths(2*length)
      call kept%solve(rhs(:, 2), lambda, stat=stat)
      call check(stat == HOL_ERR_STATE, "a set that was changed needs another update")
      call kept%destroy()
      call chains%destroy()
   end subroutine

   logical function near(a, b)
      real(real64), intent(in) :: a(:), b(:)
      near = all(abs(a - b) <= 1e-14_real64*maxval(abs(b)))
   end function

end program
