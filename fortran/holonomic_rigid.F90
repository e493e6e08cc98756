! Rigid bodies: any number of atoms held as one whole, massless sites among them, and bonds at them. Each procedure takes
! integers and reals of 32 or 64 bits.
module holonomic_rigid
   use, intrinsic :: iso_c_binding, only: c_int64_t, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   use holonomic_c, only: hol_chains_add_rigid, hol_chains_add_rigid_molecules, HOL_ERR_VALUE
   use holonomic_bonds, only: chain_set_bonds
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: chain_set_rigid, take_bonds

   type, extends(chain_set_bonds) :: chain_set_rigid
   contains
      procedure, private :: add_rigid_32_32, add_rigid_32_64, add_rigid_64_32, add_rigid_64_64
      procedure, private :: add_rigid_molecules_32_32, add_rigid_molecules_32_64, add_rigid_molecules_64_32, &
         add_rigid_molecules_64_64
      ! add_rigid(atoms, places, [sizes], [bonds, lengths]): a body of these atoms, whose reference coordinates are
      ! places(3, n); with sizes several bodies, one after the other in atoms and places. bonds(2, n_bonds) join them with
      ! each other, with other atoms or with fixed ones. An atom of mass 0 in a body is a massless site.
      generic :: add_rigid => add_rigid_32_32, add_rigid_32_64, add_rigid_64_32, add_rigid_64_64
      ! add_rigid_molecules(n_molecules, n_atoms, first_atom, atoms, places, [sizes], [bonds, lengths]): the same in each
      ! of n_molecules molecules of n_atoms consecutive atoms; atoms and bonds are counted within the molecule.
      generic :: add_rigid_molecules => add_rigid_molecules_32_32, add_rigid_molecules_32_64, add_rigid_molecules_64_32, &
         add_rigid_molecules_64_64
   end type

contains

#define SET_OF_GROUPS chain_set_rigid
#define VALUES places
#define OF_VALUES (:, :)
#define INTEGERS 32
#define REALS 32
#define ADD_GROUPS add_rigid_32_32
#define ADD_MOLECULES add_rigid_molecules_32_32
#include "groups.inc"
#define INTEGERS 32
#define REALS 64
#define ADD_GROUPS add_rigid_32_64
#define ADD_MOLECULES add_rigid_molecules_32_64
#include "groups.inc"
#define INTEGERS 64
#define REALS 32
#define ADD_GROUPS add_rigid_64_32
#define ADD_MOLECULES add_rigid_molecules_64_32
#include "groups.inc"
#define INTEGERS 64
#define REALS 64
#define ADD_GROUPS add_rigid_64_64
#define ADD_MOLECULES add_rigid_molecules_64_64
#include "groups.inc"

   ! Of the molecule, or with `molecules` of each of that many, of so many atoms, from that atom on.
   subroutine add_all(self, atoms, places, sizes, bonds, lengths, molecules, stat, errmsg)
      class(chain_set_rigid), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: atoms(:)
      real(real64), intent(in), contiguous, target :: places(:, :)
      integer(int64), intent(in), optional :: sizes(:)
      integer(int64), intent(in), contiguous, optional, target :: bonds(:, :)
      real(real64), intent(in), contiguous, optional, target :: lengths(:)
      integer(int64), intent(in), optional :: molecules(3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(int64), allocatable, target :: bodies(:)
      type(failure) :: problem
      type(c_ptr) :: pairs, of_pairs
      integer(c_int64_t) :: n_bonds
      call problem%need_created(self%c_handle())
      if (present(sizes)) then
         allocate (bodies, source=sizes)
      else
         allocate (bodies(1), source=size(atoms, kind=int64))
      end if
      if (size(places, 1) /= 3 .or. size(places, 2) /= size(atoms)) then
         call problem%set(HOL_ERR_VALUE, "places must be (3, "//decimal(size(atoms, kind=c_int64_t))//"), not ("// &
                          decimal(size(places, 1, c_int64_t))//", "//decimal(size(places, 2, c_int64_t))//")")
      else if (sum(bodies) /= size(atoms)) then
         call problem%set(HOL_ERR_VALUE, "sizes add up to "//decimal(sum(bodies))//" atoms, "// &
                          decimal(size(atoms, kind=c_int64_t))//" were given")
      else
         call take_bonds(bonds, lengths, n_bonds, pairs, of_pairs, problem)
      end if
      if (problem%none()) then
         if (present(molecules)) then
            call problem%ask(hol_chains_add_rigid_molecules(self%c_handle(), molecules(1), molecules(2), molecules(3), &
                                                            size(bodies, kind=c_int64_t), c_loc(bodies), c_loc(atoms), &
                                                            c_loc(places), n_bonds, pairs, of_pairs))
         else
            call problem%ask(hol_chains_add_rigid(self%c_handle(), size(bodies, kind=c_int64_t), c_loc(bodies), &
                                                  c_loc(atoms), c_loc(places), n_bonds, pairs, of_pairs))
         end if
      end if
      call settle(problem, trim(merge("add_rigid_molecules", "add_rigid          ", present(molecules))), stat, errmsg)
   end subroutine

   ! Bonds at groups as C has them: null pointers where there are none. If they don't go together, `problem` says why.
   subroutine take_bonds(bonds, lengths, n_bonds, pairs, of_pairs, problem)
      integer(int64), intent(in), contiguous, optional, target :: bonds(:, :)
      real(real64), intent(in), contiguous, optional, target :: lengths(:)
      integer(c_int64_t), intent(out) :: n_bonds
      type(c_ptr), intent(out) :: pairs, of_pairs
      type(failure), intent(inout) :: problem
      n_bonds = 0
      pairs = c_null_ptr
      of_pairs = c_null_ptr
      if (present(bonds) .neqv. present(lengths)) &
         call problem%set(HOL_ERR_VALUE, "bonds and lengths must be given together")
      if (.not. (present(bonds) .and. present(lengths))) return
      if (size(bonds, 1) /= 2 .or. size(bonds, 2) /= size(lengths)) then
         call problem%set(HOL_ERR_VALUE, "bonds must be (2, "//decimal(size(lengths, kind=c_int64_t))//")")
      else if (size(lengths) > 0) then
         n_bonds = size(bonds, 2, c_int64_t)
         pairs = c_loc(bonds)
         of_pairs = c_loc(lengths)
      end if
   end subroutine

end module
