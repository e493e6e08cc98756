! Linear relations among atoms, sum c_i r_i = 0: sites by a base, atoms that are one point, centroids. Each procedure takes
! integers and reals of 32 or 64 bits.
module holonomic_linear
   use, intrinsic :: iso_c_binding, only: c_int64_t, c_loc, c_ptr
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   use holonomic_c, only: hol_chains_add_linear, hol_chains_add_linear_molecules, HOL_ERR_VALUE
   use holonomic_rigid, only: chain_set_rigid, take_bonds
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: chain_set_linear

   type, extends(chain_set_rigid) :: chain_set_linear
   contains
      procedure, private :: add_linear_32_32, add_linear_32_64, add_linear_64_32, add_linear_64_64
      procedure, private :: add_linear_molecules_32_32, add_linear_molecules_32_64, add_linear_molecules_64_32, &
         add_linear_molecules_64_64
      ! add_linear(atoms, coefficients, [sizes], [bonds, lengths]): a relation among these atoms, whose coefficients add up
      ! to 0; with sizes several, one after the other. bonds(2, n_bonds) are those of the molecules that relations make.
      generic :: add_linear => add_linear_32_32, add_linear_32_64, add_linear_64_32, add_linear_64_64
      ! add_linear_molecules(n_molecules, n_atoms, first_atom, atoms, coefficients, [sizes], [bonds, lengths]): the same in
      ! each of these molecules, whose atoms are counted from 1.
      generic :: add_linear_molecules => add_linear_molecules_32_32, add_linear_molecules_32_64, &
         add_linear_molecules_64_32, add_linear_molecules_64_64
   end type

contains

#define SET_OF_GROUPS chain_set_linear
#define VALUES coefficients
#define OF_VALUES (:)
#define INTEGERS 32
#define REALS 32
#define ADD_GROUPS add_linear_32_32
#define ADD_MOLECULES add_linear_molecules_32_32
#include "groups.inc"
#define INTEGERS 32
#define REALS 64
#define ADD_GROUPS add_linear_32_64
#define ADD_MOLECULES add_linear_molecules_32_64
#include "groups.inc"
#define INTEGERS 64
#define REALS 32
#define ADD_GROUPS add_linear_64_32
#define ADD_MOLECULES add_linear_molecules_64_32
#include "groups.inc"
#define INTEGERS 64
#define REALS 64
#define ADD_GROUPS add_linear_64_64
#define ADD_MOLECULES add_linear_molecules_64_64
#include "groups.inc"

   ! In molecules(3): their number, their atoms and the first one; or once.
   subroutine add_all(self, atoms, coefficients, sizes, bonds, lengths, molecules, stat, errmsg)
      class(chain_set_linear), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: atoms(:)
      real(real64), intent(in), contiguous, target :: coefficients(:)
      integer(int64), intent(in), optional :: sizes(:)
      integer(int64), intent(in), contiguous, optional, target :: bonds(:, :)
      real(real64), intent(in), contiguous, optional, target :: lengths(:)
      integer(int64), intent(in), optional :: molecules(3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(int64), allocatable, target :: relations(:)
      type(failure) :: problem
      type(c_ptr) :: pairs, of_pairs
      integer(c_int64_t) :: n_bonds
      call problem%need_created(self%c_handle())
      if (present(sizes)) then
         allocate (relations, source=sizes)
      else
         allocate (relations(1), source=size(atoms, kind=int64))
      end if
      if (size(coefficients) /= size(atoms) .or. sum(relations) /= size(atoms)) then
         call problem%set(HOL_ERR_VALUE, decimal(size(coefficients, kind=c_int64_t))//" coefficients were given, and sizes "// &
                          "that add up to "//decimal(sum(relations))//", for "// &
                          decimal(size(atoms, kind=c_int64_t))//" atoms")
      else
         call take_bonds(bonds, lengths, n_bonds, pairs, of_pairs, problem)
      end if
      if (problem%none() .and. present(molecules)) then
         call problem%ask(hol_chains_add_linear_molecules(self%c_handle(), molecules(1), molecules(2), molecules(3), &
                                                          size(relations, kind=c_int64_t), c_loc(relations), &
                                                          c_loc(atoms), c_loc(coefficients), n_bonds, pairs, of_pairs))
      else if (problem%none()) then
         call problem%ask(hol_chains_add_linear(self%c_handle(), size(relations, kind=c_int64_t), c_loc(relations), &
                                                c_loc(atoms), c_loc(coefficients), n_bonds, pairs, of_pairs))
      end if
      call settle(problem, trim(merge("add_linear_molecules", "add_linear          ", present(molecules))), stat, errmsg)
   end subroutine

end module
