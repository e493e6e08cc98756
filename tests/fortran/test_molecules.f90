! Molecules of any shape: how they are added, what is told about them, and how wrong ones are refused.
program test_molecules
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use checks, only: check, finish, same_bits, test
   use holonomic
   implicit none

   ! One of each shape, in disorder: triangle 1 2 3, tree 4 (5 6 7), ring 8 9 10 11, chain 12 13 14, two rings 15 .. 18.
   integer, parameter :: n = 18
   integer, parameter :: mixed(2, 17) = reshape([13, 12, 2, 1, 4, 6, 9, 8, 3, 2, 13, 14, 10, 9, 5, 4, 1, 3, 11, 10, &
                                                 11, 8, 7, 4, 15, 16, 16, 17, 15, 17, 17, 18, 18, 16], [2, 17])
   real(real64), parameter :: ones(n) = 1
   character(200) :: message
   integer :: stat, i

   call shapes_are_found()
   call both_kinds_of_integers_do()
   call blocks_of_molecules()
   call a_set_of_several_calls()
   call fixed_atoms_may_be_shared()
   call wrong_bonds_are_refused()
   call wrong_blocks_are_refused()
   call what_was_not_created()
   call finish()

contains

   pure logical function says(text)
      character(*), intent(in) :: text
      says = index(message, text) > 0
   end function

   subroutine shapes_are_found()
      type(hol_chains) :: set
      integer :: shape, k, seen(17)
      integer(int64) :: n_atoms, n_bonds, list(5), of_bonds(17), molecule, all_atoms(n), offsets(6)
      call test("shapes")
      call set%create(ones)
      call set%add(bonds=mixed, lengths=1.0_real64)
      call check(set%n_molecules() == 5 .and. set%n_bonds() == 17, "five molecules are found")
      call check(set%n_of_shape(HOL_SHAPE_CHAIN) == 1 .and. set%n_of_shape(HOL_SHAPE_TREE) == 1 .and. &
                 set%n_of_shape(HOL_SHAPE_RING) == 1 .and. set%n_of_shape(HOL_SHAPE_TRIANGLE) == 1 .and. &
                 set%n_of_shape(HOL_SHAPE_OTHER) == 1, "one of each shape")
      call check(set%n_kinds() == 5, "of five kinds")
      call set%molecule(4, shape, n_atoms, n_bonds)
      call check(shape == HOL_SHAPE_CHAIN .and. n_atoms == 3 .and. n_bonds == 2, "numbered by their lowest atoms")
      call set%molecule(2_int64, shape=shape, n_bonds=n_bonds)
      call check(shape == HOL_SHAPE_TREE .and. n_bonds == 3, "the tree")
      call set%atoms(1, list)
      call check(all(list(:3) == [1, 2, 3]), "atoms of a triangle ascend")
      call set%atoms(4_int64, list)
      call check(all(list(:3) == [12, 13, 14]) .or. all(list(:3) == [14, 13, 12]), "atoms along a chain")
      call set%molecules_of_bonds(of_bonds)
      call check(all(of_bonds == [4, 1, 2, 3, 1, 4, 3, 2, 1, 3, 3, 2, 5, 5, 5, 5, 5]), "the molecule of every bond")
      seen = 0
      do molecule = 1, 5
         call set%molecule(molecule, n_bonds=n_bonds)
         call set%bonds(molecule, list)
         do k = 1, int(n_bonds)
            call check(of_bonds(list(k)) == molecule, "bonds of a molecule")
            seen(list(k)) = seen(list(k)) + 1
         end do
      end do
      call check(all(seen == 1), "each bond belongs to one molecule")
      call set%bonds(2, list)
      call check(all(list(:3) == [8, 3, 12]), "counted by their atoms: 4-5, 4-6, 4-7")
      call set%atoms(all_atoms)
      call check(sum(all_atoms) == n*(n + 1)/2 .and. all(all_atoms(:3) == [1, 2, 3]), "atoms of all molecules")
      offsets = -7
      call set%offsets(offsets, stat, message)
      call check(stat == HOL_ERR_VALUE .and. index(message, "offsets: ") == 1 .and. all(offsets == -7), &
                 "offsets are refused where bonds are mixed")
      call check(set%degrees_of_freedom() == 3*n - 17, "degrees of freedom")
      call set%destroy()
   end subroutine

   subroutine both_kinds_of_integers_do()
      type(hol_chains) :: a, b
      real(real64) :: length(17), r(3, n), v(3, n), g(3, n), h(3, n)
      call test("integers of 32 and 64 bits")
      call random_number(r)
      call random_number(v)
      length = [(1 + 0.01_real64*i, i=1, 17)]
      call a%create(ones)
      call a%add(mixed, length)
      call b%create(ones)
      call b%add(int(mixed, int64), length)
      call a%forces(r, v, g=g)
      call b%forces(r, v, g=h)
      call check(all(same_bits(g, h)) .and. maxval(abs(g)) > 0, "the same molecules")
      call a%destroy()
      call b%destroy()
      call a%create(ones)
      call a%add(int(mixed, int64), 1.0_real64)
      call check(a%n_molecules() == 5, "with one length for all, too")
      call a%destroy()
   end subroutine

   subroutine blocks_of_molecules()
      integer, parameter :: water(2, 3) = reshape([1, 2, 1, 3, 2, 3], [2, 3])
      type(hol_chains) :: a, b
      real(real64), parameter :: length(3) = [1.0_real64, 1.0_real64, 1.633_real64]
      real(real64) :: r(3, 12), v(3, 12), g(3, 12), h(3, 12), lambda(9), mu(9)
      integer :: bonds(2, 9), m
      call test("blocks of molecules")
      call random_number(r)
      call random_number(v)
      do m = 1, 3   ! of four atoms, of which the fourth has no bond: a virtual site
         bonds(:, 3*m - 2:3*m) = water + 4*(m - 1)
      end do
      call a%create(ones(:12))
      call a%add_molecules(3, 4, 1, water, length)
      call b%create(ones(:12))
      call b%add(bonds, [length, length, length])
      call check(a%n_of_shape(HOL_SHAPE_TRIANGLE) == 3 .and. a%n_kinds() == 1, "three waters")
      g = -7
      h = -7
      call a%forces(r, v, lambda=lambda, g=g)
      call b%forces(r, v, lambda=mu, g=h)
      call check(all(same_bits(g, h)) .and. all(same_bits(lambda, mu)), "as if bond by bond")
      call check(all(same_bits(g(:, 4::4), -7.0_real64)), "atoms without bonds are left alone")
      call b%destroy()
      call b%create(ones(:12))
      call b%add_molecules(3_int64, 4_int64, 1_int64, int(water, int64), length)
      call b%forces(r, v, g=h)
      call check(all(same_bits(g, h)), "integers of 64 bits")
      call b%destroy()
      call b%create(ones(:12))
      call b%add_molecules(2, 4, 5, water, 1.0_real64)
      call b%add_molecules(1_int64, 4_int64, 1_int64, int(water, int64), 1.0_real64)
      call check(b%n_of_shape(HOL_SHAPE_TRIANGLE) == 3, "one length for all bonds")
      call a%destroy()
      call b%destroy()
   end subroutine

   subroutine a_set_of_several_calls()
      type(hol_chains) :: set
      integer(int64) :: list(3), of_bonds(8)
      call test("chains and molecules in one set")
      call set%create(ones)
      call set%add([9, 8, 7], 1.0_real64)
      call set%add(reshape([1, 2, 2, 3, 3, 1], [2, 3]), 1.0_real64)
      call set%add(1, 1, 10, 1.0_real64)
      call set%add(reshape([5, 4, 5, 6], [2, 2]), 1.0_real64)
      call set%molecules_of_bonds(of_bonds)
      call check(all(of_bonds == [1, 1, 2, 2, 2, 3, 4, 4]), "bonds stand in the order of the calls")
      call set%atoms(4, list)
      call check(list(2) == 5, "bonds that form a chain are a chain")
      call check(set%n_of_shape(HOL_SHAPE_CHAIN) == 3, "as those that were given as chains")
      call set%destroy()
   end subroutine

   subroutine fixed_atoms_may_be_shared()
      type(hol_chains) :: set
      real(real64) :: mass(5), r(3, 5), f(3, 5), g(3, 5), tension(4)
      integer(int64) :: of_bonds(4)
      call test("fixed atoms")
      ! 1 and 5 are fixed; 2, 3 and 4 hang from 1 by a bond each, and a bond joins 1 and 5.
      mass = [0, 1, 1, 1, 0]
      r = reshape([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 5], [3, 5])
      f = 2*r
      g = -7
      call set%create(mass)
      call set%add(reshape([1, 2, 1, 3, 5, 1], [2, 3]), [1.0_real64, 1.0_real64, 5.0_real64])
      call set%add([4, 1], 1.0_real64)
      call set%molecules_of_bonds(of_bonds)
      call check(all(of_bonds == [1, 2, -1, 3]), "cut molecules; a bond between two of them belongs to none")
      call check(set%degrees_of_freedom() == 9 - 3, "and removes no degree of freedom")
      tension = -7
      call set%forces(r, f=f, tension=tension, g=g)
      call check(all(abs(tension - [2, 2, 0, 2]) < 1e-14_real64), "tensions; that of two fixed atoms is 0")
      call check(all(abs(g(:, 1) - [2, 2, 2]) < 1e-14_real64), "all that pull at the fixed atom")
      call set%destroy()
   end subroutine

   subroutine wrong_bonds_are_refused()
      type(hol_chains) :: set
      integer :: pair(2, 1), k4(2, 10)
      integer :: k, l, m
      call test("wrong bonds")
      call set%create(ones)
      call set%add(reshape([1, 2, 2, 3], [2, 2]), 1.0_real64)
      call set%add(reshape([1, 2, 3], [3, 1]), 1.0_real64, stat, message)
      call check(stat == HOL_ERR_VALUE .and. message == "add: the first dimension of bonds must be 2, not 3", &
                 "three rows")
      call set%add(reshape([integer ::], [2, 0]), 1.0_real64, stat, message)
      call check(stat == HOL_OK, "none: nothing to be added")
      call set%add(reshape([4, 5, 5, 6], [2, 2]), [1.0_real64], stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("1 lengths") .and. says("2 bonds"), "too few lengths")
      pair(:, 1) = [4, 19]
      call set%add(pair, 1.0_real64, stat, message)
      call check(stat == HOL_ERR_INDEX .and. says("19"), "an atom that does not exist")
      pair(:, 1) = [0, 4]
      call set%add(pair, 1.0_real64, stat, message)
      call check(stat == HOL_ERR_INDEX .and. says("0"), "atoms are counted from 1")
      pair(:, 1) = [4, 4]
      call set%add(pair, 1.0_real64, stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("itself"), "an atom with itself")
      pair(:, 1) = [3, 4]
      call set%add(pair, 1.0_real64, stat, message)
      call check(stat == HOL_ERR_SHARED_ATOM .and. says("atom 3"), "an atom of an earlier call")
      pair(:, 1) = [4, 5]
      call set%add(pair, -1.0_real64, stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("bond 1"), "a length below zero")
      call set%add(reshape([4, 5, 6, 7, 5, 4], [2, 3]), 1.0_real64, stat, message)
      call check(stat == HOL_ERR_DEGENERATE .and. says("bond"), "a bond given twice")
      m = 0
      do k = 5, 8
         do l = 4, k - 1
            m = m + 1
            k4(:, m) = [k, l]
         end do
      end do
      call set%add(k4, 1.0_real64, stat, message)
      call check(stat == HOL_ERR_DEGENERATE .and. says("bond"), "all ten distances of five atoms")
      call check(set%n_molecules() == 1 .and. set%n_bonds() == 2, "nothing was added by any of these")
      call set%add(reshape([4, 5], [2, 1]), 1.0_real64)
      call check(set%n_molecules() == 2, "and the set stays usable")
      call set%destroy()
   end subroutine

   subroutine wrong_blocks_are_refused()
      type(hol_chains) :: set
      integer, parameter :: pair(2, 1) = reshape([1, 2], [2, 1])
      integer(int64) :: list(1)
      call test("wrong blocks")
      call set%create(ones)
      call set%add_molecules(0, 2, 1, pair, 1.0_real64, stat, message)
      call check(stat == HOL_OK, "no molecules: nothing to be added")
      call set%add_molecules(10, 2, 1, pair, 1.0_real64, stat, message)
      call check(stat == HOL_ERR_INDEX, "a block that reaches too far")
      call set%add_molecules(2, 2, 1, reshape([1, 3], [2, 1]), 1.0_real64, stat, message)
      call check(stat == HOL_ERR_INDEX .and. says("3"), "an atom outside of the molecule")
      call set%add_molecules(2, 2, 1, pair, [1.0_real64, 1.0_real64], stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("2 lengths"), "too many lengths")
      call check(set%n_molecules() == 0, "nothing was added by any of these")
      call set%add_molecules(2, 2, 1, pair, 1.0_real64)
      call set%atoms(3, list, stat, message)
      call check(stat == HOL_ERR_INDEX .and. index(message, "atoms: ") == 1, "there is no third molecule")
      call set%bonds(0, list, stat, message)
      call check(stat == HOL_ERR_INDEX .and. index(message, "bonds: ") == 1, "nor molecule 0")
      call set%atoms(1, list, stat, message)
      call check(stat == HOL_ERR_VALUE .and. says("list has 1 elements, too few for 2 atoms"), "a list too small")
      call set%destroy()
   end subroutine

   subroutine what_was_not_created()
      type(hol_chains) :: none
      integer(int64) :: list(3)
      real(real64) :: numbers(3, 3)
      call test("a set that was not created")
      call none%add(reshape([1, 2], [2, 1]), 1.0_real64, stat, message)
      call expect("add")
      call none%add_molecules(1, 2, 1, reshape([1, 2], [2, 1]), 1.0_real64, stat, message)
      call expect("add_molecules")
      call none%molecule(1, n_atoms=list(1), stat=stat, errmsg=message)
      call expect("molecule")
      call none%atoms(1, list, stat, message)
      call expect("atoms")
      call none%bonds(1, list, stat, message)
      call expect("bonds")
      call none%molecules_of_bonds(list, stat, message)
      call expect("molecules_of_bonds")
      call none%set_lengths(numbers(:, 1), stat, message)
      call expect("set_lengths")
      call none%set_masses(numbers(:, 1), stat, message)
      call expect("set_masses")
      call none%set_reference_box(stat=stat, errmsg=message)
      call expect("set_reference_box")
      call none%solve(numbers, numbers(:, 1), stat=stat, errmsg=message)
      call expect("solve")
      call check(none%n_kinds() == 0 .and. none%n_of_shape(HOL_SHAPE_RING) == 0, "counts")
   end subroutine

   subroutine expect(procedure)
      character(*), intent(in) :: procedure
      call check(stat == HOL_ERR_NULL .and. message == procedure//": create has not been called", procedure)
   end subroutine

end program
