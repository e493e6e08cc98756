! Factors of all molecules at one configuration, kept for any number of right-hand sides: force groups of several time steps
! (r-RESPA), terms that relax errors. As with type(hol_chains), the variable that was created owns what it has until its
! destroy, and copies don't. The set of molecules has to live as long.
module holonomic_factors
   use, intrinsic :: iso_c_binding, only: c_associated, c_int64_t, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use holonomic_c, only: hol_chains_n_atoms, hol_chains_n_bonds, hol_factors_create, hol_factors_destroy, &
                          hol_factors_forces_view, hol_factors_solve, hol_factors_solve_view, hol_factors_update_view, &
                          HOL_ERR_NULL, HOL_ERR_VALUE
   use holonomic_chains, only: hol_chains
   use holonomic_ownership, only: ownership
   use holonomic_place, only: list_of, mode_of, place, tensor
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: hol_factors

   type :: hol_factors
      private
      type(c_ptr) :: handle = c_null_ptr, chains = c_null_ptr
      type(ownership) :: owner
   contains
      procedure :: create, adopt, destroy
      procedure, private :: n_atoms, n_bonds
      procedure, private :: update_rows_32, update_rows_64, update_parts_32, update_parts_64
      generic :: update => update_rows_32, update_rows_64, update_parts_32, update_parts_64
      ! f is needed, v may be absent.
      procedure, private :: forces_rows_32, forces_rows_64, forces_parts_32, forces_parts_64
      generic :: forces => forces_rows_32, forces_rows_64, forces_parts_32, forces_parts_64
      ! solve(rhs, lambda), solve(rhs, lambda, g, add, virial); or several at once, rhs(n_bonds, n_rhs), with
      ! lambda(n_bonds, n_rhs), g(3, n_atoms, n_rhs) and virial(3, 3, n_rhs) of real64.
      procedure, private :: solve_alone, solve_rows_32, solve_rows_64, solve_parts_32, solve_parts_64, solve_several
      generic :: solve => solve_alone, solve_rows_32, solve_rows_64, solve_parts_32, solve_parts_64, solve_several
   end type

contains

#define ROWS 32
#include "factors.inc"
#define ROWS 64
#include "factors.inc"
#define PARTS 32
#include "factors.inc"
#define PARTS 64
#include "factors.inc"

   subroutine create(self, chains, stat, errmsg)
      class(hol_factors), intent(inout) :: self
      class(hol_chains), intent(in) :: chains
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      if (.not. c_associated(chains%c_handle())) &
         call problem%set(HOL_ERR_NULL, "create has not been called for the set of molecules")
      if (c_associated(self%handle)) call problem%set(HOL_ERR_VALUE, "these factors have been created already; "// &
                                                      "destroy them first")
      if (problem%none()) then
         call problem%ask(hol_factors_create(chains%c_handle(), self%handle))
         if (problem%none()) call self%owner%take()
         self%chains = chains%c_handle()
      end if
      call settle(problem, "create", stat, errmsg)
   end subroutine

   impure elemental subroutine destroy(self)
      class(hol_factors), intent(inout) :: self
      if (self%owner%is_here()) call hol_factors_destroy(self%handle)
      self%handle = c_null_ptr
      self%chains = c_null_ptr
      call self%owner%drop()
   end subroutine

   ! Owns the factors from now on. For a copy whose owner is gone without `destroy`.
   impure elemental subroutine adopt(self)
      class(hol_factors), intent(inout) :: self
      if (c_associated(self%handle)) call self%owner%take()
   end subroutine

   pure recursive integer(int64) function n_atoms(self)
      class(hol_factors), intent(in) :: self
      n_atoms = hol_chains_n_atoms(self%chains)
   end function

   pure recursive integer(int64) function n_bonds(self)
      class(hol_factors), intent(in) :: self
      n_bonds = hol_chains_n_bonds(self%chains)
   end function

   ! Without the forces on the atoms.
   recursive subroutine solve_alone(self, rhs, lambda, stat, errmsg)
      class(hol_factors), intent(in) :: self
      real(real64), intent(in), contiguous, target :: rhs(:)
      real(real64), intent(inout), contiguous, target :: lambda(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(c_ptr) :: at_rhs, at_lambda
      call problem%need_created(self%handle)
      at_rhs = list_of(rhs, "rhs", self%n_bonds(), "bonds", problem)
      at_lambda = list_of(lambda, "lambda", self%n_bonds(), "bonds", problem)
      if (problem%none()) call problem%ask(hol_factors_solve(self%handle, 1_c_int64_t, at_rhs, at_lambda, c_null_ptr, &
                                                             mode_of(), c_null_ptr))
      call settle(problem, "solve", stat, errmsg)
   end subroutine

   recursive subroutine solve_several(self, rhs, lambda, g, add, virial, stat, errmsg)
      class(hol_factors), intent(in) :: self
      real(real64), intent(in), contiguous, target :: rhs(:, :)
      real(real64), intent(inout), optional, contiguous, target :: lambda(:, :), g(:, :, :), virial(:, :, :)
      logical, intent(in), optional :: add
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(c_ptr) :: at_lambda, at_g, at_virial
      integer(c_int64_t) :: n_rhs
      n_rhs = size(rhs, 2, c_int64_t)
      call problem%need_created(self%handle)
      call need("rhs", size(rhs, 1, int64) == self%n_bonds(), "(n_bonds, n_rhs)", problem)
      at_lambda = c_null_ptr
      at_g = c_null_ptr
      at_virial = c_null_ptr
      if (present(lambda)) then
         call need("lambda", size(lambda, 1, int64) == self%n_bonds() .and. size(lambda, 2, int64) == n_rhs, &
                   "(n_bonds, n_rhs)", problem)
         at_lambda = c_loc(lambda)
      end if
      if (present(g)) then
         call need("g", size(g, 1) == 3 .and. size(g, 2, int64) == self%n_atoms() .and. size(g, 3, int64) == n_rhs, &
                   "(3, n_atoms, n_rhs)", problem)
         at_g = c_loc(g)
      end if
      if (present(virial)) then
         call need("virial", size(virial, 1) == 3 .and. size(virial, 2) == 3 .and. size(virial, 3, int64) == n_rhs, &
                   "(3, 3, n_rhs)", problem)
         at_virial = c_loc(virial)
      end if
      if (problem%none() .and. size(rhs) > 0) call problem%ask( &
         hol_factors_solve(self%handle, n_rhs, c_loc(rhs), at_lambda, at_g, mode_of(add), at_virial))
      call settle(problem, "solve", stat, errmsg)
   end subroutine

   ! Here nothing may be larger: the library counts on from one right-hand side to the next.
   recursive subroutine need(name, fits, shape, problem)
      character(*), intent(in) :: name, shape
      logical, intent(in) :: fits
      type(failure), intent(inout) :: problem
      if (.not. fits) call problem%set(HOL_ERR_VALUE, name//" must be "//shape)
   end subroutine

end module
