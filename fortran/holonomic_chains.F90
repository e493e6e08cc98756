! type(hol_chains): which atoms are joined by rigid bonds, and all that can be asked of them. The type lists its procedures;
! each group of them stands in a file of its own, chains_*.inc, and what they have for several kinds and layouts in templates
! that those include. (One type, not one that other modules extend: compilers write the tables of each type that a program
! sees into every file that uses it.) Atoms, bonds and molecules are counted from 1.
module holonomic_chains
   use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr, c_signed_char
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   use holonomic_c
   use holonomic_ownership, only: ownership
   use holonomic_status, only: decimal, failure, settle
   use holonomic_place, only: box_of, enough, flag_of, list_of, mode_of, number_at, place, report_at, tensor
   implicit none
   private
   public :: hol_chains

   ! Molecules with rigid bonds. The variable that was created owns them until its destroy: there is no finalizer. A copy
   ! refers to the same molecules, owns nothing, and must not be used after the owner's destroy, but to be destroyed itself.
   type :: hol_chains
      private
      type(c_ptr) :: handle = c_null_ptr
      type(ownership) :: owner
   contains
      procedure, private :: create_32, create_64   ! masses of either precision
      generic :: create => create_32, create_64
      procedure :: copy_of
      procedure :: adopt
      procedure :: destroy
      procedure :: c_handle   ! for calls of the module holonomic_c

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

      procedure, private :: add_with_images_32_32, add_with_images_32_64, add_with_images_64_32, add_with_images_64_64
      procedure, private :: set_images_32, set_images_64, images_32, images_64
      ! add_with_images(bonds, lengths, images): images(3, n_bonds), by which box vectors the second atom of a bond is moved.
      generic :: add_with_images => add_with_images_32_32, add_with_images_32_64, add_with_images_64_32, &
         add_with_images_64_64
      ! Of all bonds of the set; 0 for those that were added without.
      generic :: set_images => set_images_32, set_images_64
      generic :: images => images_32, images_64

      procedure, private :: set_box_matrix, set_box_lengths, set_box_matrix_32, set_box_lengths_32
      generic :: set_box => set_box_matrix, set_box_lengths, set_box_matrix_32, set_box_lengths_32
      procedure, private :: set_reference_box_matrix, set_reference_box_lengths, set_reference_box_matrix_32, &
         set_reference_box_lengths_32
      generic :: set_reference_box => set_reference_box_matrix, set_reference_box_lengths, set_reference_box_matrix_32, &
         set_reference_box_lengths_32
      procedure, private :: set_box_rate_matrix, set_box_rate_32
      generic :: set_box_rate => set_box_rate_matrix, set_box_rate_32
      procedure, private :: set_checks_32, set_checks_64
      generic :: set_checks => set_checks_32, set_checks_64
      procedure, private :: set_labels_none, set_labels_32, set_labels_64
      generic :: set_labels => set_labels_none, set_labels_32, set_labels_64
      procedure :: set_threads
      procedure :: set_active
      procedure :: set_max_iterations
      ! Of 32 or 64 bits.
      procedure, private :: set_tolerance_32, set_tolerance_64, set_length_tolerance_32, set_length_tolerance_64
      procedure, private :: set_memory_limit_32, set_memory_limit_64
      procedure, private :: set_lengths_32, set_lengths_64, set_masses_32, set_masses_64
      generic :: set_tolerance => set_tolerance_32, set_tolerance_64
      generic :: set_length_tolerance => set_length_tolerance_32, set_length_tolerance_64
      generic :: set_memory_limit => set_memory_limit_32, set_memory_limit_64
      generic :: set_lengths => set_lengths_32, set_lengths_64
      generic :: set_masses => set_masses_32, set_masses_64

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

      procedure, private :: forces_rows_32, forces_rows_64, forces_parts_32, forces_parts_64
      procedure, private :: add_forces_rows_32, add_forces_rows_64, add_forces_parts_32, add_forces_parts_64
      ! The constraint forces by themselves, and the same added to f in place.
      generic :: forces => forces_rows_32, forces_rows_64, forces_parts_32, forces_parts_64
      generic :: add_forces => add_forces_rows_32, add_forces_rows_64, add_forces_parts_32, add_forces_parts_64

      procedure, private :: solve_rows_32, solve_rows_64, solve_parts_32, solve_parts_64
      generic :: solve => solve_rows_32, solve_rows_64, solve_parts_32, solve_parts_64

      procedure, private :: reactions_rows_32, reactions_rows_64, reactions_parts_32, reactions_parts_64
      ! bond_virial (6, n_bonds): xx xy xz yy yz zz. reference: the positions belong to the box of set_reference_box.
      generic :: reactions => reactions_rows_32, reactions_rows_64, reactions_parts_32, reactions_parts_64

      procedure, private :: velocities_rows_32, velocities_rows_64, velocities_parts_32, velocities_parts_64
      generic :: project_velocities => velocities_rows_32, velocities_rows_64, velocities_parts_32, velocities_parts_64

      procedure, private :: positions_rows_32, positions_rows_64, positions_parts_32, positions_parts_64
      procedure, private :: positions_rows_32_short, positions_parts_32_short   ! dt of single precision, too
      generic :: project_positions => positions_rows_32, positions_rows_64, positions_parts_32, positions_parts_64, &
         positions_rows_32_short, positions_parts_32_short

      procedure, private :: along_rows_32, along_rows_64, along_parts_32, along_parts_64
      procedure, private :: along_rows_32_short, along_parts_32_short   ! dt of single precision, too
      generic :: project_positions_along => along_rows_32, along_rows_64, along_parts_32, along_parts_64, &
         along_rows_32_short, along_parts_32_short
      procedure :: reference_error

      ! reference: r belongs to the box of set_reference_box.
      procedure, private :: check_rows_32, check_rows_64, check_parts_32, check_parts_64
      generic :: check => check_rows_32, check_rows_64, check_parts_32, check_parts_64

      procedure, private :: violation_rows_32, violation_rows_64, violation_parts_32, violation_parts_64
      generic :: violation => violation_rows_32, violation_rows_64, violation_parts_32, violation_parts_64

      procedure, private :: residuals_rows_32, residuals_rows_64, residuals_parts_32, residuals_parts_64
      generic :: residuals => residuals_rows_32, residuals_rows_64, residuals_parts_32, residuals_parts_64

      procedure, private :: impose_rows_32, impose_rows_64, impose_parts_32, impose_parts_64
      generic :: impose => impose_rows_32, impose_rows_64, impose_parts_32, impose_parts_64

      procedure :: set_outcomes
      procedure, private :: outcomes_32, outcomes_64
      generic :: outcomes => outcomes_32, outcomes_64

      procedure, private :: metric_rows_32, metric_rows_64, metric_parts_32, metric_parts_64
      generic :: metric => metric_rows_32, metric_rows_64, metric_parts_32, metric_parts_64
   end type

contains

   subroutine create_64(self, masses, stat, errmsg)
      class(hol_chains), intent(inout) :: self
      real(real64), intent(in), contiguous, target :: masses(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(c_int64_t), target :: atom
      real(real64), target :: no_mass(1)
      integer(c_int) :: status
      if (c_associated(self%handle)) then
         call problem%set(HOL_ERR_VALUE, "this variable has been created already; destroy it first")
      else
         no_mass = 0
         if (size(masses) == 0) then
            status = hol_chains_create(0_c_int64_t, c_loc(no_mass), self%handle)
         else
            status = hol_chains_create(size(masses, kind=c_int64_t), c_loc(masses), self%handle)
         end if
         if (status == HOL_ERR_VALUE) then
            ! The C function has no index base yet, and its message would count the atoms from 0.
            call hol_error_location(c_null_ptr, c_null_ptr, c_loc(atom), c_null_ptr)
            if (atom >= 0) call problem%set(status, "the mass of atom "//decimal(atom + 1)// &
                                            " is negative, not a number or too small")
         end if
         call problem%ask(status)
         if (problem%none()) call problem%ask(hol_chains_set_index_base(self%handle, 1_c_int))
         if (problem%none()) call self%owner%take()
      end if
      call settle(problem, "create", stat, errmsg)
   end subroutine

   subroutine create_32(self, masses, stat, errmsg)
      class(hol_chains), intent(inout) :: self
      real(real32), intent(in) :: masses(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%create(real(masses, real64), stat, errmsg)
   end subroutine

   ! Molecules of its own, as those of another variable are now, with its options: to be changed apart from them.
   subroutine copy_of(self, other, stat, errmsg)
      class(hol_chains), intent(inout) :: self
      class(hol_chains), intent(in) :: other
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(other%handle)
      if (c_associated(self%handle)) &
         call problem%set(HOL_ERR_VALUE, "this variable has been created already; destroy it first")
      if (problem%none()) call problem%ask(hol_chains_copy(other%handle, self%handle))
      if (problem%none()) call self%owner%take()
      call settle(problem, "copy_of", stat, errmsg)
   end subroutine

   ! A copy only forgets the molecules: they belong to the variable that created them.
   impure elemental subroutine destroy(self)
      class(hol_chains), intent(inout) :: self
      if (self%owner%is_here()) call hol_chains_destroy(self%handle)
      self%handle = c_null_ptr
      call self%owner%drop()
   end subroutine

   ! Owns the molecules from now on. For a copy whose owner is gone without `destroy`.
   impure elemental subroutine adopt(self)
      class(hol_chains), intent(inout) :: self
      if (c_associated(self%handle)) call self%owner%take()
   end subroutine

   pure recursive type(c_ptr) function c_handle(self)
      class(hol_chains), intent(in) :: self
      c_handle = self%handle
   end function

#include "chains_bonds.inc"
#include "chains_rigid.inc"
#include "chains_linear.inc"
#include "chains_images.inc"
#include "chains_settings.inc"
#include "chains_counts.inc"
#include "chains_given.inc"
#include "chains_forces.inc"
#include "chains_solve.inc"
#include "chains_reactions.inc"
#include "chains_velocities.inc"
#include "chains_positions.inc"
#include "chains_along.inc"
#include "chains_check.inc"
#include "chains_violation.inc"
#include "chains_residuals.inc"
#include "chains_impose.inc"
#include "chains_outcomes.inc"
#include "chains_metric.inc"

end module
