! Creation, copies, destruction, options, counts, and the names and sizes that must agree with C.
program test_lifecycle
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_loc, c_ptr, c_sizeof
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use checks, only: check, eps, finish, same_bits, test
   use holonomic
   use holonomic_c, only: c_hol_forces => hol_forces, hol_view, HOL_ADD, HOL_DOUBLE, HOL_FLOAT, HOL_WRITE
   implicit none
   integer :: i

   interface
      ! c_side.c: what the header says.
      function c_layout(which) bind(c) result(number)
         import :: c_int, c_int64_t
         integer(c_int), value :: which
         integer(c_int64_t) :: number
      end function
   end interface

   call layouts_agree_with_c()
   call texts()
   call what_is_destroyed_is_gone()
   call chains_can_be_created_again()
   call counts()
   call boxes()
   call inactive_chains()
   call tolerance_and_iterations()
   call raw_interface()
   call finish()

contains

   subroutine layouts_agree_with_c()
      type(hol_view), target :: view
      type(hol_report), target :: report
      type(hol_worst), target :: worst
      integer(c_int64_t), allocatable :: ours(:)
      integer :: k
      call test("types and constants agree with the header")
      ours = [integer(c_int64_t) :: HOL_OK, HOL_ERR_NULL, HOL_ERR_VALUE, HOL_ERR_INDEX, HOL_ERR_SHARED_ATOM, &
              HOL_ERR_MEMORY, HOL_ERR_NOT_FINITE, HOL_ERR_DEGENERATE, HOL_ERR_NO_CONVERGENCE, HOL_ERR_NOT_DEFINITE, &
              HOL_ERR_INTERNAL, HOL_DOUBLE, HOL_FLOAT, HOL_WRITE, HOL_ADD, HOL_UNIT_DIAGONAL, HOL_PHYSICAL, &
              HOL_SHAPE_CHAIN, HOL_SHAPE_TREE, HOL_SHAPE_RING, HOL_SHAPE_TRIANGLE, HOL_SHAPE_OTHER, &
              c_sizeof(view), offset(c_loc(view), c_loc(view%x)), offset(c_loc(view), c_loc(view%y)), &
              offset(c_loc(view), c_loc(view%z)), offset(c_loc(view), c_loc(view%stride)), &
              offset(c_loc(view), c_loc(view%element)), offset(c_loc(view), c_loc(view%reserved)), &
              c_sizeof(report), offset(c_loc(report), c_loc(report%iterations)), &
              offset(c_loc(report), c_loc(report%n_corrected)), offset(c_loc(report), c_loc(report%n_failed)), &
              offset(c_loc(report), c_loc(report%molecule)), offset(c_loc(report), c_loc(report%bond)), &
              offset(c_loc(report), c_loc(report%max_error)), &
              c_sizeof(worst), offset(c_loc(worst), c_loc(worst%length)), &
              offset(c_loc(worst), c_loc(worst%length_molecule)), offset(c_loc(worst), c_loc(worst%length_bond)), &
              offset(c_loc(worst), c_loc(worst%rate)), offset(c_loc(worst), c_loc(worst%rate_molecule)), &
              offset(c_loc(worst), c_loc(worst%rate_bond))]
      do k = 1, size(ours)
         call check(c_layout(int(k - 1, c_int)) == ours(k), "number "//achar(iachar("0") + k/10)// &
                    achar(iachar("0") + mod(k, 10))//" of the list")
      end do
      call check(c_layout(int(size(ours), c_int)) == -1, "the list is as long as in C")
   end subroutine

   integer(c_int64_t) function offset(whole, part)
      type(c_ptr), intent(in) :: whole, part
      offset = transfer(part, offset) - transfer(whole, offset)
   end function

   subroutine texts()
      character(:), allocatable :: version
      call test("texts")
      version = hol_version()
      call check(verify(version, "0123456789.") == 0 .and. len(version) >= 5, "a version")
      call check(hol_status_name(HOL_ERR_INDEX) == "HOL_ERR_INDEX", "the name of a status")
      call check(hol_status_name(12345) == "unknown status", "and of none")
      call check(any(hol_instruction_set() == [character(8) :: "baseline", "avx2", "avx512vl", "neon", "scalar"]), &
                 "an instruction set")
   end subroutine

   subroutine what_is_destroyed_is_gone()
      type(hol_chains) :: chains
      call test("destroy")
      call chains%create([1.0_real64, 1.0_real64])
      call chains%add([1, 2], 1.0_real64)
      call chains%destroy()
      call chains%destroy()
      call check(chains%n_bonds() == 0, "twice does no harm")
   end subroutine

   subroutine chains_can_be_created_again()
      type(hol_chains) :: chains
      integer :: round
      call test("create after destroy")
      do round = 1, 3
         call chains%create([(1.0_real64, i=1, round + 1)])
         call chains%add([(i, i=1, round + 1)], 1.0_real64)
         call check(chains%n_bonds() == round, "makes new chains")
         call chains%destroy()
      end do
   end subroutine

   subroutine counts()
      type(hol_chains) :: chains
      integer(int64) :: first_bond(5), list(11)
      call test("counts")
      call chains%create([0.0_real64, (1.0_real64, i=2, 14)])
      call chains%add([7, 3, 5], 1.0_real64)
      call chains%add(2, 1, 8, 1.0_real64)
      call chains%add([1_int64, 2_int64, 4_int64, 6_int64], [1.0_real64, 2.0_real64, 3.0_real64])
      call check(chains%n_atoms() == 14 .and. chains%n_molecules() == 4 .and. chains%n_bonds() == 7, "what there is")
      call chains%offsets(first_bond)
      call check(all(first_bond == [1, 3, 4, 5, 8]), "offsets count from 1")
      call chains%atoms(list)
      call check(all(list == [7, 3, 5, 8, 9, 10, 11, 1, 2, 4, 6]), "atoms count from 1")
      call check(chains%degrees_of_freedom() == 3*13 - 7, "degrees of freedom in three dimensions")
      call check(chains%degrees_of_freedom(2) == 2*13 - 7, "and in two")
      call check(chains%memory() > 0, "memory")
      call chains%destroy()
   end subroutine

   subroutine boxes()
      type(hol_chains) :: chains
      type(hol_worst) :: worst
      real(real64) :: r(3, 2), box(3, 3)
      call test("boxes")
      call chains%create([1.0_real64, 1.0_real64])
      call chains%add([1, 2], 1.0_real64)
      r = reshape([0.25_real64, 0.0_real64, 0.0_real64, 9.25_real64, 0.0_real64, 0.0_real64], [3, 2])
      call chains%violation(r, worst=worst)
      call check(same_bits(worst%length, 80.0_real64), "none: the bond is 9 long")
      call chains%set_box([10.0_real64, 10.0_real64, 10.0_real64])
      call chains%violation(r, worst=worst)
      call check(worst%length <= 8*eps, "edges: the bond is 1 long")
      call chains%set_box([0.0_real64, 10.0_real64, 10.0_real64])
      call chains%violation(r, worst=worst)
      call check(same_bits(worst%length, 80.0_real64), "not periodic along x")
      ! The columns are the box vectors: along the second, (3, 10, 0), from (0, 0, 0) to (3, 9, 0) is 1.
      box = reshape([10, 0, 0, 3, 10, 0, 0, 0, 10], [3, 3])
      r = reshape([0, 0, 0, 3, 9, 0], [3, 2])
      call chains%set_box(box)
      call chains%violation(r, worst=worst)
      call check(worst%length <= 8*eps, "columns are box vectors")
      call chains%set_box()
      call chains%violation(r, worst=worst)
      call check(same_bits(worst%length, 89.0_real64), "the box can be taken away")
      call chains%destroy()
   end subroutine

   subroutine inactive_chains()
      type(hol_chains) :: chains
      real(real64) :: r(3, 4), g(3, 4), v(3, 4)
      call test("inactive chains")
      call chains%create([1.0_real64, 1.0_real64, 1.0_real64, 1.0_real64])
      call chains%add(2, 1, 1, 1.0_real64)
      call random_number(r)
      call random_number(v)
      g = -7
      call chains%set_active([.false., .true.])
      call chains%forces(r, v, g=g)
      call check(all(same_bits(g(:, :2), -7.0_real64)) .and. .not. any(same_bits(g(:, 3:), -7.0_real64)), &
                 "are neither read nor written")
      call check(chains%degrees_of_freedom() == 12 - 1, "take no degree of freedom")
      call chains%set_active()
      call chains%forces(r, v, g=g)
      call check(.not. any(same_bits(g, -7.0_real64)), "can be made active again")
      call chains%destroy()
   end subroutine

   subroutine tolerance_and_iterations()
      type(hol_chains) :: chains
      type(hol_report) :: report
      real(real64) :: r(3, 3), r_ref(3, 3), before(3, 3)
      integer :: stat
      call test("tolerance and iterations")
      call chains%create([1.0_real64, 1.0_real64, 1.0_real64])
      call chains%add([1, 2, 3], 1.0_real64)
      r_ref = reshape([0, 0, 0, 1, 0, 0, 1, 1, 0], [3, 3])
      r = r_ref
      r(1, 3) = 1.01_real64
      r(2, 3) = 1.1_real64
      before = r
      call chains%set_tolerance(0.5_real64)
      call chains%project_positions(r_ref, r, 1.0_real64, report=report)
      call check(report%n_corrected == 0 .and. all(same_bits(r, before)), "within the tolerance nothing is done")
      call check(report%molecule == 1 .and. report%bond == 2, "and the worst bond is told, from 1")
      call chains%set_tolerance(0.0_real64)
      call chains%set_max_iterations(1)
      call chains%project_positions(r_ref, r, 1.0_real64, stat=stat)
      call check(stat == HOL_ERR_NO_CONVERGENCE .and. all(same_bits(r, before)), "one iteration is not enough")
      call chains%set_max_iterations(50)
      call chains%project_positions(r_ref, r, 1.0_real64, report=report)
      call check(report%n_corrected == 1 .and. report%max_error < 16*eps, "fifty are")
      call chains%destroy()
   end subroutine

   ! The C functions themselves, with the handle of the chains.
   subroutine raw_interface()
      use, intrinsic :: iso_c_binding, only: c_null_ptr
      type(hol_chains) :: chains
      real(real64), target :: r(3, 2), v(3, 2), g(3, 2)
      integer(c_int) :: status
      call test("raw interface")
      r = reshape([-1, 0, 0, 1, 0, 0], [3, 2])
      v = reshape([0, -1, 0, 0, 1, 0], [3, 2])
      call chains%create([1.0_real64, 1.0_real64])
      call chains%add([1, 2], 2.0_real64)
      status = c_hol_forces(chains%c_handle(), c_loc(r), c_loc(v), c_null_ptr, c_null_ptr, c_null_ptr, c_loc(g), &
                            HOL_WRITE, c_null_ptr)
      call check(status == HOL_OK .and. abs(g(1, 1) - 1) < 4*eps .and. abs(g(1, 2) + 1) < 4*eps, "hol_forces")
      call chains%destroy()
   end subroutine

end program
