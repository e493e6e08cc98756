! What is bonded to what: linear chains by their atoms, alone or in blocks, and molecules of any shape by their bonds, of which
! the library finds what holds together. Integers and lengths have 32 or 64 bits; a length is given for each bond or one for all.
module holonomic_bonds
   use, intrinsic :: iso_c_binding, only: c_int64_t, c_loc
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   use holonomic_c, only: hol_chains_add, hol_chains_add_block, hol_chains_add_bonds, hol_chains_add_molecules, HOL_ERR_VALUE
   use holonomic_chains, only: chain_set
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: chain_set_bonds

   type, extends(chain_set) :: chain_set_bonds
   contains
      procedure, private :: add_chain_32_32, add_chain_32_64, add_chain_64_32, add_chain_64_64, add_chain_32_32_one, &
         add_chain_32_64_one, add_chain_64_32_one, add_chain_64_64_one
      procedure, private :: add_block_32_32, add_block_32_64, add_block_64_32, add_block_64_64, add_block_32_32_one, &
         add_block_32_64_one, add_block_64_32_one, add_block_64_64_one
      procedure, private :: add_bonds_32_32, add_bonds_32_64, add_bonds_64_32, add_bonds_64_64, add_bonds_32_32_one, &
         add_bonds_32_64_one, add_bonds_64_32_one, add_bonds_64_64_one
      procedure, private :: add_molecules_32_32, add_molecules_32_64, add_molecules_64_32, add_molecules_64_64, &
         add_molecules_32_32_one, add_molecules_32_64_one, add_molecules_64_32_one, add_molecules_64_64_one
      ! add(atoms, lengths): one linear chain by its atoms. add(n_chains, n_bonds, first_atom, lengths): a block of them.
      ! add(bonds, lengths): bonds(2, n_bonds), the two atoms of each.
      generic :: add => add_chain_32_32, add_chain_32_64, add_chain_64_32, add_chain_64_64, add_chain_32_32_one, &
         add_chain_32_64_one, add_chain_64_32_one, add_chain_64_64_one
      generic :: add => add_block_32_32, add_block_32_64, add_block_64_32, add_block_64_64, add_block_32_32_one, &
         add_block_32_64_one, add_block_64_32_one, add_block_64_64_one
      generic :: add => add_bonds_32_32, add_bonds_32_64, add_bonds_64_32, add_bonds_64_64, add_bonds_32_32_one, &
         add_bonds_32_64_one, add_bonds_64_32_one, add_bonds_64_64_one
      ! add_molecules(n_molecules, n_atoms, first_atom, bonds, lengths): the same bonds in each of n_molecules molecules
      ! of n_atoms consecutive atoms; bonds(2, n_bonds) are counted within the molecule.
      generic :: add_molecules => add_molecules_32_32, add_molecules_32_64, add_molecules_64_32, add_molecules_64_64, &
         add_molecules_32_32_one, add_molecules_32_64_one, add_molecules_64_32_one, add_molecules_64_64_one
   end type

contains

#define INTEGERS 32
#define REALS 32
#define ADD_CHAIN add_chain_32_32
#define ADD_BLOCK add_block_32_32
#define ADD_BONDS add_bonds_32_32
#define ADD_MOLECULES add_molecules_32_32
#include "bonds.inc"
#define INTEGERS 32
#define REALS 64
#define ADD_CHAIN add_chain_32_64
#define ADD_BLOCK add_block_32_64
#define ADD_BONDS add_bonds_32_64
#define ADD_MOLECULES add_molecules_32_64
#include "bonds.inc"
#define INTEGERS 64
#define REALS 32
#define ADD_CHAIN add_chain_64_32
#define ADD_BLOCK add_block_64_32
#define ADD_BONDS add_bonds_64_32
#define ADD_MOLECULES add_molecules_64_32
#include "bonds.inc"
#define INTEGERS 64
#define REALS 64
#define ADD_CHAIN add_chain_64_64
#define ADD_BLOCK add_block_64_64
#define ADD_BONDS add_bonds_64_64
#define ADD_MOLECULES add_molecules_64_64
#include "bonds.inc"
#define INTEGERS 32
#define REALS 32
#define ONE_LENGTH
#define ADD_CHAIN add_chain_32_32_one
#define ADD_BLOCK add_block_32_32_one
#define ADD_BONDS add_bonds_32_32_one
#define ADD_MOLECULES add_molecules_32_32_one
#include "bonds.inc"
#define INTEGERS 32
#define REALS 64
#define ONE_LENGTH
#define ADD_CHAIN add_chain_32_64_one
#define ADD_BLOCK add_block_32_64_one
#define ADD_BONDS add_bonds_32_64_one
#define ADD_MOLECULES add_molecules_32_64_one
#include "bonds.inc"
#define INTEGERS 64
#define REALS 32
#define ONE_LENGTH
#define ADD_CHAIN add_chain_64_32_one
#define ADD_BLOCK add_block_64_32_one
#define ADD_BONDS add_bonds_64_32_one
#define ADD_MOLECULES add_molecules_64_32_one
#include "bonds.inc"
#define INTEGERS 64
#define REALS 64
#define ONE_LENGTH
#define ADD_CHAIN add_chain_64_64_one
#define ADD_BLOCK add_block_64_64_one
#define ADD_BONDS add_bonds_64_64_one
#define ADD_MOLECULES add_molecules_64_64_one
#include "bonds.inc"

   subroutine add_chain(self, atoms, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: atoms(:)
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(c_int64_t) :: n_bonds
      call problem%need_created(self%c_handle())
      n_bonds = max(size(atoms, kind=c_int64_t) - 1, 0_c_int64_t)
      if (size(lengths, kind=c_int64_t) /= n_bonds) then
         call problem%set(HOL_ERR_VALUE, decimal(size(lengths, kind=c_int64_t))//" lengths were given for "// &
                          decimal(n_bonds)//" bonds")
      else if (n_bonds > 0) then
         call problem%ask(hol_chains_add(self%c_handle(), n_bonds, c_loc(atoms), c_loc(lengths)))
      end if
      call settle(problem, "add", stat, errmsg)
   end subroutine

   subroutine add_block(self, n_chains, n_bonds, first_atom, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int64), intent(in) :: n_chains, n_bonds, first_atom
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (size(lengths, kind=int64) /= max(n_bonds, 0_int64)) then
         call problem%set(HOL_ERR_VALUE, decimal(size(lengths, kind=int64))//" lengths were given for "// &
                          decimal(n_bonds)//" bonds")
      else
         call problem%ask(hol_chains_add_block(self%c_handle(), n_chains, n_bonds, first_atom, c_loc(lengths)))
      end if
      call settle(problem, "add", stat, errmsg)
   end subroutine

   subroutine add_bonds(self, bonds, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: bonds(:, :)
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (sizes_agree(bonds, lengths, problem)) &
         call problem%ask(hol_chains_add_bonds(self%c_handle(), size(bonds, 2, c_int64_t), c_loc(bonds), &
                                               c_loc(lengths)))
      call settle(problem, "add", stat, errmsg)
   end subroutine

   subroutine add_molecules(self, n_molecules, n_atoms, first_atom, bonds, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int64), intent(in) :: n_molecules, n_atoms, first_atom
      integer(int64), intent(in), contiguous, target :: bonds(:, :)
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (sizes_agree(bonds, lengths, problem)) &
         call problem%ask(hol_chains_add_molecules(self%c_handle(), n_molecules, n_atoms, first_atom, &
                                                   size(bonds, 2, c_int64_t), c_loc(bonds), c_loc(lengths)))
      call settle(problem, "add_molecules", stat, errmsg)
   end subroutine

   ! Whether these are bonds with a length each; if not, `problem` says why.
   logical function sizes_agree(bonds, lengths, problem)
      integer(int64), intent(in) :: bonds(:, :)
      real(real64), intent(in) :: lengths(:)
      type(failure), intent(inout) :: problem
      if (size(bonds, 1) /= 2) then
         call problem%set(HOL_ERR_VALUE, "the first dimension of bonds must be 2, not "// &
                          decimal(size(bonds, 1, c_int64_t)))
      else if (size(lengths) /= size(bonds, 2)) then
         call problem%set(HOL_ERR_VALUE, decimal(size(lengths, kind=c_int64_t))//" lengths were given for "// &
                          decimal(size(bonds, 2, c_int64_t))//" bonds")
      end if
      sizes_agree = problem%none()
   end function

   pure function repeated(length, n) result(lengths)
      real(real64), intent(in) :: length
      integer(int64), intent(in) :: n
      real(real64), allocatable :: lengths(:)
      allocate (lengths(max(n, 0_int64)), source=length)
   end function

end module
