! What the messages of steps and bonds that can't be solved say: the bond, its atoms, its lengths, whether a box is set.
program test_messages
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use holonomic
   use checks, only: check, finish, same_bits, test
   implicit none
   integer, parameter :: dp = real64
   integer, parameter :: n_molecules = 3, bad = 2
   real(dp), parameter :: box(3) = 40.0_dp
   integer :: stat
   character(600) :: message

   call steps_that_do_not_converge("two bonds", reshape([1, 2, 2, 3], [2, 2]), &
                                   reshape([0.0_dp, 0.0_dp, 1.0_dp, 0.1_dp, 1.2_dp, 1.3_dp], [2, 3]), 3, 2)
   call steps_that_do_not_converge("water", reshape([1, 2, 1, 3, 2, 3], [2, 3]), &
                                   reshape([0.0_dp, 0.0_dp, 1.0_dp, 0.1_dp, -0.3_dp, 0.9_dp], [2, 3]), 2, 1)
   call steps_that_do_not_converge("a star", reshape([1, 2, 1, 3, 1, 4], [2, 3]), &
                                   reshape([0.0_dp, 0.0_dp, 1.0_dp, 0.1_dp, -0.7_dp, 0.9_dp, 0.2_dp, -1.3_dp], [2, 4]), 3, 2)
   call bonds_of_length_zero()
   call bonds_that_depend_on_each_other()
   call molecules_that_leap()
   call finish()

contains

   logical function says(words)
      character(*), intent(in) :: words
      says = index(message, words) > 0
   end function

   ! As %.6g shows it: "1.00499".
   character(7) function shown(x)
      real(dp), intent(in) :: x
      write (shown, "(f7.5)") x
   end function

   ! A flat molecule of which one atom is lifted by 3: no correction in its plane brings it back.
   subroutine steps_that_do_not_converge(name, pairs, xy, lifted, worst)
      character(*), intent(in) :: name
      integer, intent(in) :: pairs(:, :), lifted, worst
      real(dp), intent(in) :: xy(:, :)
      type(hol_chains) :: chains
      real(dp) :: r_ref(3, n_molecules*size(xy, 2)), r(3, n_molecules*size(xy, 2)), before(3, n_molecules*size(xy, 2))
      real(dp) :: lengths(size(pairs, 2)), off(3)
      integer :: m, k, n_atoms, with_box, first, i, j
      integer(int64) :: molecule
      character(200) :: words
      call test("steps that do not converge: "//name)
      n_atoms = size(xy, 2)
      r_ref = 0
      do m = 1, n_molecules
         r_ref(1:2, (m - 1)*n_atoms + 1:m*n_atoms) = xy
         r_ref(1, (m - 1)*n_atoms + 1:m*n_atoms) = xy(1, :) + 6*m
      end do
      do k = 1, size(lengths)
         lengths(k) = norm2(xy(:, pairs(2, k)) - xy(:, pairs(1, k)))
      end do
      first = (bad - 1)*n_atoms
      i = first + pairs(1, worst)
      j = first + pairs(2, worst)
      do with_box = 0, 1
         call chains%create([(1.0_dp + 0.1_dp*m, m=1, size(r, 2))])
         call chains%add_molecules(n_molecules, n_atoms, 1, pairs, lengths)
         if (with_box == 1) call chains%set_box(box)
         r = r_ref
         r(3, first + lifted) = 3
         before = r
         off = r(:, j) - r(:, i)
         message = ""
         call chains%project_positions(r_ref, r, 1.0_dp, stat=stat, errmsg=message)
         call check(stat == HOL_ERR_NO_CONVERGENCE, "it does not converge: "//trim(message))
         write (words, "(a, i0, a, i0, a)") "atoms ", i, " and ", j, "): it should be "//shown(lengths(worst))// &
            " long, is "//shown(lengths(worst))//" in the reference and "//shown(norm2(off))//" in the positions to be "// &
            "projected; "//trim(merge("a box is set ", "no box is set", with_box == 1))
         call check(says(trim(words)), trim(words)//" is in: "//trim(message))
         call hol_error_location(molecule)
         call check(molecule == bad, "the molecule in numbers")
         call check(all(same_bits(r, before)), "nothing is moved")
         call chains%destroy()
      end do
   end subroutine

   subroutine bonds_of_length_zero()
      type(hol_chains) :: chains
      real(dp) :: r(3, 4), next(3, 4), before(3, 4), g(3, 4)
      call test("bonds of length zero")
      r = reshape([0.0_dp, 0.0_dp, 0.0_dp, 1.5_dp, 0.0_dp, 0.0_dp, 1.5_dp, 1.5_dp, 0.0_dp, 3.0_dp, 1.5_dp, 0.0_dp], [3, 4])
      call chains%create([1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp])
      call chains%add([1, 2, 3, 4], [1.5_dp, 1.5_dp, 1.5_dp])
      call chains%set_box(box)
      next = r
      call chains%project_positions(r, next, 1.0_dp)
      r(:, 3) = r(:, 2)
      g = -7
      call chains%forces(r, g=g, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_DEGENERATE .and. says("bond 2 (atoms 2 and 3) has length zero") .and. &
                 says("it should be 1.5 long and is 0; a box is set"), trim(message))
      call check(all(same_bits(g, -7.0_dp)), "nothing is written")
      next = 1.02_dp*next
      before = next
      call chains%project_positions(r, next, 1.0_dp, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_DEGENERATE .and. &
                 says("is 0 in the reference and 1.53 in the positions to be projected; a box is set"), trim(message))
      call check(all(same_bits(next, before)), "nothing is moved")
      call chains%destroy()
   end subroutine

   subroutine bonds_that_depend_on_each_other()
      type(hol_chains) :: chains
      real(dp) :: r(3, 4)
      integer :: i
      call test("bonds that depend on each other")
      r = 0
      r(1, :) = [(1.5_dp*(i - 1), i=1, 4)]
      call chains%create([0.0_dp, 1.0_dp, 0.0_dp])
      call chains%add([1, 2, 3], [1.5_dp, 1.5_dp])
      call chains%forces(r, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_DEGENERATE .and. says("taut between atoms that are held fixed") .and. &
                 says("(atoms 2 and 3) is not determined: it should be 1.5 long and is 1.5; no box is set"), trim(message))
      call chains%destroy()
      call chains%create([1.0_dp, 1.0_dp, 1.0_dp])
      call chains%add(bonds=reshape([1, 2, 2, 3, 1, 3], [2, 3]), lengths=[1.5_dp, 1.5_dp, 2.99_dp]) ! 2.999 would be straight
      call chains%forces(r, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_DEGENERATE .and. says("depends on the others") .and. says("no box is set"), trim(message))
      call chains%destroy()
      r(1, :) = [0.0_dp, 10.0_dp, 20.0_dp, 30.0_dp]
      call chains%create([1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp])
      call chains%add(bonds=reshape([1, 2, 2, 3, 3, 4, 1, 4], [2, 4]), lengths=10.0_dp)
      call chains%set_box(box)
      call chains%forces(r, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_DEGENERATE .and. says("depends on the others") .and. &
                 says("it should be 10 long and is 10; a box is set"), trim(message))
      call chains%destroy()
   end subroutine

   ! In a later step: the molecule that is cut is left as it is, the other is done.
   subroutine molecules_that_leap()
      type(hol_chains) :: chains
      real(dp) :: r_ref(3, 4), r(3, 4), before(3, 4)
      call test("molecules that leap")
      r_ref = reshape([0.0_dp, 0.0_dp, 0.0_dp, 1.5_dp, 0.0_dp, 0.0_dp, 9.0_dp, 0.0_dp, 0.0_dp, 9.0_dp, 1.5_dp, 0.0_dp], [3, 4])
      call chains%create([1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp])
      call chains%add(2, 1, 1, 1.5_dp)
      r = r_ref
      call chains%project_positions(r_ref, r, 1.0_dp)
      r = r_ref + 0.01_dp
      r(:, 2) = r(:, 2) + [0.01_dp, 0.0_dp, 0.0_dp]
      r(2, 4) = r(2, 4) + 20
      before = r
      call chains%project_positions(r_ref, r, 1.0_dp, stat=stat, errmsg=message)
      call check(stat == HOL_ERR_NO_CONVERGENCE .and. says("molecule 2") .and. says("atoms 3 and 4)") .and. &
                 says("21.5 long in the positions to be projected, it should be 1.5; no box is set"), trim(message))
      call check(all(same_bits(r(:, 3:4), before(:, 3:4))), "it is left as it is")
      call check(abs(norm2(r(:, 2) - r(:, 1)) - 1.5_dp) < 1e-14_dp, "the other one is done")
      call chains%destroy()
   end subroutine

end program
