! A set as it was given: copies of it, its bonds, lengths, masses and boxes, and what became of each bond.
module holonomic_given
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_loc, c_null_ptr, c_ptr, c_signed_char
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   use holonomic_c, only: hol_chains_active, hol_chains_bodies, hol_chains_box, hol_chains_box_rate, hol_chains_checks, &
                          hol_chains_labels, hol_chains_length_tolerance, hol_chains_lengths, hol_chains_masses, &
                          hol_chains_max_iterations, hol_chains_memory_limit, hol_chains_outcomes, hol_chains_pairs, &
                          hol_chains_roles, hol_chains_set_bodies, hol_chains_set_length, hol_chains_threads, &
                          hol_chains_tolerance, HOL_ERR_VALUE
   use holonomic_counts, only: chain_set_counts
   use holonomic_place, only: box_of, enough, tensor
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_given

   type, extends(chain_set_counts) :: chain_set_given
   contains
      procedure, private :: set_bodies_32, set_bodies_64
      generic :: set_bodies => set_bodies_32, set_bodies_64
      ! What was set, or is the default.
      procedure :: bodies, checks, threads, keeps_outcomes, max_iterations, tolerance, length_tolerance, memory_limit
      procedure :: active
      procedure, private :: box_rate_32, box_rate_64, labels_32, labels_64
      generic :: box_rate => box_rate_32, box_rate_64
      generic :: labels => labels_32, labels_64
      ! Integers and reals of 32 or 64 bits.
      procedure, private :: set_length_32_32, set_length_32_64, set_length_64_32, set_length_64_64
      procedure, private :: bond_pairs_32, bond_pairs_64, bond_lengths_32, bond_lengths_64, atom_masses_32, atom_masses_64, &
         box_32, box_64
      ! A new length of one bond, by its number in the arrays per bond.
      generic :: set_length => set_length_32_32, set_length_32_64, set_length_64_32, set_length_64_64
      generic :: bond_pairs => bond_pairs_32, bond_pairs_64
      generic :: bond_lengths => bond_lengths_32, bond_lengths_64
      generic :: atom_masses => atom_masses_32, atom_masses_64
      generic :: box => box_32, box_64
      procedure, private :: roles_alone, roles_and_removed
      generic :: roles => roles_alone, roles_and_removed
   end type

contains

#define INTEGERS 32
#define REALS 32
#define SET_LENGTH set_length_32_32
#include "given.inc"
#define INTEGERS 32
#define REALS 64
#define SET_LENGTH set_length_32_64
#include "given.inc"
#define INTEGERS 64
#define REALS 32
#define SET_LENGTH set_length_64_32
#include "given.inc"
#define INTEGERS 64
#define REALS 64
#define SET_LENGTH set_length_64_64
#include "given.inc"
#define INTEGERS 32
#define REALS 32
#define SET_BODIES set_bodies_32
#define BOND_PAIRS bond_pairs_32
#define BOND_LENGTHS bond_lengths_32
#define ATOM_MASSES atom_masses_32
#define BOX box_32
#define BOX_RATE box_rate_32
#define LABELS labels_32
#include "given_arrays.inc"
#define INTEGERS 64
#define REALS 64
#define SET_BODIES set_bodies_64
#define BOND_PAIRS bond_pairs_64
#define BOND_LENGTHS bond_lengths_64
#define ATOM_MASSES atom_masses_64
#define BOX box_64
#define BOX_RATE box_rate_64
#define LABELS labels_64
#include "given_arrays.inc"

   pure recursive integer function bodies(self)
      class(chain_set_given), intent(in) :: self
      bodies = int(hol_chains_bodies(self%c_handle()))
   end function

   pure recursive integer function checks(self)
      class(chain_set_given), intent(in) :: self
      checks = int(hol_chains_checks(self%c_handle()))
   end function

   pure recursive integer function threads(self)
      class(chain_set_given), intent(in) :: self
      threads = int(hol_chains_threads(self%c_handle()))
   end function

   pure recursive integer function max_iterations(self)
      class(chain_set_given), intent(in) :: self
      max_iterations = int(hol_chains_max_iterations(self%c_handle()))
   end function

   pure recursive real(real64) function tolerance(self)
      class(chain_set_given), intent(in) :: self
      tolerance = hol_chains_tolerance(self%c_handle())
   end function

   pure recursive real(real64) function length_tolerance(self)
      class(chain_set_given), intent(in) :: self
      length_tolerance = hol_chains_length_tolerance(self%c_handle())
   end function

   pure recursive integer(int64) function memory_limit(self)
      class(chain_set_given), intent(in) :: self
      memory_limit = hol_chains_memory_limit(self%c_handle())
   end function

   pure recursive logical function keeps_outcomes(self)
      class(chain_set_given), intent(in) :: self
      keeps_outcomes = hol_chains_outcomes(self%c_handle()) /= 0
   end function

   ! Which molecules are active.
   subroutine active(self, is_active, stat, errmsg)
      class(chain_set_given), intent(in) :: self
      logical, intent(inout) :: is_active(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(c_signed_char), allocatable, target :: found(:)
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (enough("is_active", size(is_active, kind=c_int64_t), self%n_molecules(), "molecules", problem)) then
         allocate (found(self%n_molecules()))
         if (size(found) > 0) call problem%ask(hol_chains_active(self%c_handle(), c_loc(found)))
         if (problem%none()) is_active(:size(found)) = found /= 0
      end if
      call settle(problem, "active", stat, errmsg)
   end subroutine

   ! HOL_ROLE_.. of every bond, and how many freedoms the constraints of each molecule remove.
   subroutine roles_and_removed(self, roles, removed, stat, errmsg)
      class(chain_set_given), intent(in) :: self
      integer, intent(inout) :: roles(:)
      integer(int64), intent(inout), contiguous, target :: removed(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(c_int), allocatable, target :: found(:)
      call problem%need_created(self%c_handle())
      if (enough("roles", size(roles, kind=c_int64_t), self%n_bonds(), "bonds", problem) .and. &
          enough("removed", size(removed, kind=c_int64_t), self%n_molecules(), "molecules", problem) .and. &
          problem%none()) then
         allocate (found(max(1_c_int64_t, self%n_bonds())))
         call problem%ask(hol_chains_roles(self%c_handle(), c_loc(found), at(removed)))
         if (problem%none()) roles(:self%n_bonds()) = found(:self%n_bonds())
      end if
      call settle(problem, "roles", stat, errmsg)
   end subroutine

   subroutine roles_alone(self, roles, stat, errmsg)
      class(chain_set_given), intent(in) :: self
      integer, intent(inout) :: roles(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(int64), allocatable :: removed(:)
      allocate (removed(self%n_molecules()))
      call self%roles(roles, removed, stat, errmsg)
   end subroutine

   type(c_ptr) function at(list)
      integer(int64), intent(inout), contiguous, target :: list(:)
      at = c_null_ptr
      if (size(list) > 0) at = c_loc(list)
   end function

end module
