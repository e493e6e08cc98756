! What the molecules consist of.
module holonomic_counts
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_loc, c_null_ptr, c_signed_char
   use, intrinsic :: iso_fortran_env, only: int32, int64, real64
   use holonomic_c, only: hol_chains_adjustment, hol_chains_atoms, hol_chains_bonds, hol_chains_degrees_of_freedom, &
                          hol_chains_held_sites, hol_chains_implied, hol_chains_memory, hol_chains_molecule, &
                          hol_chains_molecules_of_bonds, &
                          hol_chains_n_atoms, hol_chains_n_bonds, &
                          hol_chains_n_molecules, hol_chains_n_kinds, hol_chains_n_of_shape, hol_chains_offsets
   use holonomic_place, only: enough
   use holonomic_settings, only: chain_set_settings
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_counts

   type, extends(chain_set_settings) :: chain_set_counts
   contains
      procedure :: n_atoms
      procedure :: n_molecules
      procedure :: n_bonds
      procedure :: degrees_of_freedom
      procedure :: memory
      procedure, private :: n_of_shape_32, n_of_shape_64
      generic :: n_of_shape => n_of_shape_32, n_of_shape_64
      procedure :: n_kinds
      procedure :: adjustment
      procedure :: held_sites
      procedure :: implied
      ! Lists of default or 64-bit integers.
      procedure, private :: offsets_32, offsets_64, molecules_of_bonds_32, molecules_of_bonds_64
      ! Where the bonds of each molecule follow one another, as in a set of linear chains alone:
      ! first_bond(n_molecules + 1): molecule m has the bonds first_bond(m) .. first_bond(m + 1) - 1 of arrays per bond.
      generic :: offsets => offsets_32, offsets_64
      ! The molecule of every bond, list(n_bonds); -1 for a bond between two fixed atoms, which belongs to none.
      generic :: molecules_of_bonds => molecules_of_bonds_32, molecules_of_bonds_64
      procedure, private :: molecule_32, molecule_64, atoms_of_all_32, atoms_of_all_64
      procedure, private :: atoms_32_32, atoms_32_64, atoms_64_32, atoms_64_64
      procedure, private :: bonds_32_32, bonds_32_64, bonds_64_32, bonds_64_64
      ! Of one molecule by its number.
      generic :: molecule => molecule_32, molecule_64
      generic :: bonds => bonds_32_32, bonds_32_64, bonds_64_32, bonds_64_64
      ! Of one molecule or of all, molecule after molecule: list(n_bonds + n_molecules) suffices; those of a linear chain in
      ! order, those of others ascending. If all are linear chains, chain c begins at element first_bond(c) + c - 1.
      generic :: atoms => atoms_of_all_32, atoms_of_all_64, atoms_32_32, atoms_32_64, atoms_64_32, atoms_64_64
   end type

contains

   pure recursive integer(int64) function n_atoms(self)
      class(chain_set_counts), intent(in) :: self
      n_atoms = hol_chains_n_atoms(self%c_handle())
   end function

   pure recursive integer(int64) function n_molecules(self)
      class(chain_set_counts), intent(in) :: self
      n_molecules = hol_chains_n_molecules(self%c_handle())
   end function

   pure recursive integer(int64) function n_bonds(self)
      class(chain_set_counts), intent(in) :: self
      n_bonds = hol_chains_n_bonds(self%c_handle())
   end function

   ! Of all atoms; three dimensions by default. A conserved total momentum is not subtracted.
   pure recursive integer(int64) function degrees_of_freedom(self, dimensions)
      class(chain_set_counts), intent(in) :: self
      integer, intent(in), optional :: dimensions
      integer(c_int) :: d
      d = 3
      if (present(dimensions)) d = int(dimensions, c_int)
      degrees_of_freedom = hol_chains_degrees_of_freedom(self%c_handle(), d)
   end function

   ! Bytes that the molecules occupy.
   pure recursive integer(int64) function memory(self)
      class(chain_set_counts), intent(in) :: self
      memory = hol_chains_memory(self%c_handle())
   end function

   ! Different kinds of molecules: of the same shape, masses and lengths.
   pure recursive integer(int64) function n_kinds(self)
      class(chain_set_counts), intent(in) :: self
      n_kinds = hol_chains_n_kinds(self%c_handle())
   end function

   ! By which part of it the length of a rigid group was adjusted that was adjusted most, and its bond; -1: none was.
   recursive subroutine adjustment(self, largest, bond, stat, errmsg)
      class(chain_set_counts), intent(in) :: self
      real(real64), intent(out) :: largest
      integer(int64), intent(out), optional :: bond
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(c_int64_t) :: number
      type(failure) :: problem
      largest = 0
      number = -1
      call problem%need_created(self%c_handle())
      call problem%ask(hol_chains_adjustment(self%c_handle(), largest, number))
      if (present(bond)) bond = number
      call settle(problem, "adjustment", stat, errmsg)
   end subroutine

   ! Atoms of mass 0 that bonds tie to something rigid: it is held in space by them. A massless site belongs into a body.
   recursive subroutine held_sites(self, is_held, stat, errmsg)
      class(chain_set_counts), intent(in) :: self
      logical, intent(inout) :: is_held(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(c_signed_char), allocatable :: bytes(:)
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (enough("is_held", size(is_held, kind=int64), self%n_atoms(), "atoms", problem)) then
         allocate (bytes(max(1_int64, self%n_atoms())))
         call problem%ask(hol_chains_held_sites(self%c_handle(), bytes))
         if (problem%none()) is_held(:self%n_atoms()) = bytes(:self%n_atoms()) /= 0
      end if
      call settle(problem, "held_sites", stat, errmsg)
   end subroutine

   ! Which distances others imply: they are in no equation.
   recursive subroutine implied(self, is_implied, stat, errmsg)
      class(chain_set_counts), intent(in) :: self
      logical, intent(inout) :: is_implied(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(c_signed_char), allocatable :: bytes(:)
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (enough("is_implied", size(is_implied, kind=int64), self%n_bonds(), "bonds", problem)) then
         allocate (bytes(max(1_int64, self%n_bonds())))
         call problem%ask(hol_chains_implied(self%c_handle(), bytes))
         if (problem%none()) is_implied(:self%n_bonds()) = bytes(:self%n_bonds()) /= 0
      end if
      call settle(problem, "implied", stat, errmsg)
   end subroutine

   ! Shape (HOL_SHAPE_...) and size of one molecule.
   recursive subroutine molecule_64(self, number, shape, n_atoms, n_bonds, stat, errmsg)
      class(chain_set_counts), intent(in) :: self
      integer(int64), intent(in) :: number
      integer, intent(inout), optional :: shape
      integer(int64), intent(inout), optional :: n_atoms, n_bonds
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(c_int), target :: what
      integer(c_int64_t), target :: atoms, bonds
      call problem%need_created(self%c_handle())
      call problem%ask(hol_chains_molecule(self%c_handle(), number, c_loc(what), c_loc(atoms), c_loc(bonds)))
      if (problem%none()) then
         if (present(shape)) shape = int(what)
         if (present(n_atoms)) n_atoms = atoms
         if (present(n_bonds)) n_bonds = bonds
      end if
      call settle(problem, "molecule", stat, errmsg)
   end subroutine

   recursive subroutine molecule_32(self, number, shape, n_atoms, n_bonds, stat, errmsg)
      class(chain_set_counts), intent(in) :: self
      integer(int32), intent(in) :: number
      integer, intent(inout), optional :: shape
      integer(int64), intent(inout), optional :: n_atoms, n_bonds
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%molecule(int(number, int64), shape, n_atoms, n_bonds, stat, errmsg)
   end subroutine

#define INTEGERS 32
#define N_OF_SHAPE n_of_shape_32
#define OFFSETS offsets_32
#define MOLECULES_OF_BONDS molecules_of_bonds_32
#define ATOMS_OF_ALL atoms_of_all_32
#include "counts.inc"
#define INTEGERS 64
#define N_OF_SHAPE n_of_shape_64
#define OFFSETS offsets_64
#define MOLECULES_OF_BONDS molecules_of_bonds_64
#define ATOMS_OF_ALL atoms_of_all_64
#include "counts.inc"
#define NUMBERS int32
#define INTEGERS 32
#define ATOMS atoms_32_32
#define BONDS bonds_32_32
#include "counts_of_one.inc"
#define NUMBERS int32
#define INTEGERS 64
#define ATOMS atoms_32_64
#define BONDS bonds_32_64
#include "counts_of_one.inc"
#define NUMBERS int64
#define INTEGERS 32
#define ATOMS atoms_64_32
#define BONDS bonds_64_32
#include "counts_of_one.inc"
#define NUMBERS int64
#define INTEGERS 64
#define ATOMS atoms_64_64
#define BONDS bonds_64_64
#include "counts_of_one.inc"

end module
