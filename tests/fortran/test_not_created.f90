! Chains and inverses that were not created: every procedure says so, and writes nothing.
program test_not_created
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use checks, only: check, finish, same_bits, test
   use holonomic
   implicit none

   integer, parameter :: n = 4
   type(hol_chains) :: none
   type(hol_inverse) :: inverse
   type(hol_worst) :: worst
   real(real64), dimension(3, n) :: r = 1, v = 1, f = 1, r_ref = 1
   real(real64) :: lambda(n) = -7
   character(200) :: message
   integer(int64) :: list(n)
   integer :: stat

   call test("chains that were not created")
   call none%forces(r, lambda=lambda, stat=stat, errmsg=message)
   call expect_not_created("forces")
   call none%add_forces(r, f=f, lambda=lambda, stat=stat, errmsg=message)
   call expect_not_created("add_forces")
   call none%project_velocities(r, v, stat=stat, errmsg=message)
   call expect_not_created("project_velocities")
   call none%project_positions(r_ref, r, 0.1_real64, stat=stat, errmsg=message)
   call expect_not_created("project_positions")
   call none%violation(r, worst=worst, stat=stat, errmsg=message)
   call expect_not_created("violation")
   call none%metric(r, log_det=lambda, stat=stat, errmsg=message)
   call expect_not_created("metric")
   call none%add([1, 2], 1.0_real64, stat, message)
   call expect_not_created("add")
   call none%add(1, 1, 1, 1.0_real64, stat, message)
   call expect_not_created("add")
   call none%set_box(stat=stat, errmsg=message)
   call expect_not_created("set_box")
   call none%set_box([1.0_real64, 1.0_real64, 1.0_real64], stat, message)
   call expect_not_created("set_box")
   call none%set_threads(1, stat, message)
   call expect_not_created("set_threads")
   call none%set_active([.true.], stat, message)
   call expect_not_created("set_active")
   call none%set_tolerance(0.0_real64, stat, message)
   call expect_not_created("set_tolerance")
   call none%set_max_iterations(5, stat, message)
   call expect_not_created("set_max_iterations")
   call none%add_linear([1, 2], [1.0_real64, -1.0_real64], stat=stat, errmsg=message)
   call expect_not_created("add_linear")
   call none%add_linear_molecules(1, 2, 1, [1, 2], [1.0_real64, -1.0_real64], stat=stat, errmsg=message)
   call expect_not_created("add_linear_molecules")
   call none%set_length_tolerance(1e-3_real64, stat, message)
   call expect_not_created("set_length_tolerance")
   call none%set_memory_limit(5, stat, message)
   call expect_not_created("set_memory_limit")
   call none%offsets(list, stat, message)
   call expect_not_created("offsets")
   call none%atoms(list, stat, message)
   call expect_not_created("atoms")
   call inverse%create(none, 1, r, stat, message)
   call check(stat == HOL_ERR_NULL .and. message == "create: create has not been called for the set of molecules", "an inverse")
   call inverse%condition(lambda(1), stat, message)
   call expect_not_created("condition")
   call inverse%entry(1, 1, lambda(1), stat=stat, errmsg=message)
   call expect_not_created("entry")
   call inverse%error_bound(lambda, stat=stat, errmsg=message)
   call expect_not_created("error_bound")
   call check(none%n_bonds() == 0 .and. none%degrees_of_freedom() == -1, "counts")
   call none%destroy()
   call check(all(same_bits(lambda, -7.0_real64)), "nothing was written")
   call finish()

contains

   subroutine expect_not_created(procedure)
      character(*), intent(in) :: procedure
      call check(stat == HOL_ERR_NULL .and. message == procedure//": create has not been called", procedure)
   end subroutine

end program
