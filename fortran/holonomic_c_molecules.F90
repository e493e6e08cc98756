! The part of the C interface that says what is bonded and how it is treated; use the module holonomic_c, which has all
! parts.
module holonomic_c_molecules
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_ptr, c_signed_char
   implicit none
   public
   private :: c_double, c_int, c_int64_t, c_ptr

   ! hol_shape
   integer(c_int), parameter :: HOL_SHAPE_CHAIN = 0
   integer(c_int), parameter :: HOL_SHAPE_TREE = 1
   integer(c_int), parameter :: HOL_SHAPE_RING = 2
   integer(c_int), parameter :: HOL_SHAPE_TRIANGLE = 3
   integer(c_int), parameter :: HOL_SHAPE_OTHER = 4
   integer(c_int), parameter :: HOL_SHAPE_RIGID = 5

   interface

      function hol_chains_create(n_atoms, masses, chains) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         integer(c_int64_t), value :: n_atoms
         type(c_ptr), value :: masses
         type(c_ptr), intent(out) :: chains
         integer(c_int) :: status
      end function

      subroutine hol_chains_destroy(chains) bind(c)
         import :: c_ptr
         type(c_ptr), value :: chains
      end subroutine

      function hol_chains_add(chains, n_bonds, atoms, lengths) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: n_bonds
         type(c_ptr), value :: atoms, lengths
         integer(c_int) :: status
      end function

      function hol_chains_add_block(chains, n_chains, n_bonds, first_atom, lengths) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: n_chains, n_bonds, first_atom
         type(c_ptr), value :: lengths
         integer(c_int) :: status
      end function

      function hol_chains_add_bonds(chains, n_bonds, pairs, lengths) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: n_bonds
         type(c_ptr), value :: pairs, lengths
         integer(c_int) :: status
      end function

      function hol_chains_add_molecules(chains, n_molecules, n_atoms, &
         first_atom, n_bonds, pairs, lengths) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: n_molecules, n_atoms, first_atom, n_bonds
         type(c_ptr), value :: pairs, lengths
         integer(c_int) :: status
      end function

      function hol_chains_add_rigid(chains, n_bodies, sizes, atoms, places, n_bonds, pairs, lengths) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: n_bodies
         type(c_ptr), value :: sizes, atoms, places
         integer(c_int64_t), value :: n_bonds
         type(c_ptr), value :: pairs, lengths
         integer(c_int) :: status
      end function

      function hol_chains_add_rigid_molecules(chains, n_molecules, n_atoms, first_atom, n_bodies, sizes, atoms, places, &
         n_bonds, pairs, lengths) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: n_molecules, n_atoms, first_atom, n_bodies
         type(c_ptr), value :: sizes, atoms, places
         integer(c_int64_t), value :: n_bonds
         type(c_ptr), value :: pairs, lengths
         integer(c_int) :: status
      end function

      function hol_chains_add_bonds_with_images(chains, n_bonds, pairs, lengths, images) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: n_bonds
         type(c_ptr), value :: pairs, lengths, images
         integer(c_int) :: status
      end function

      function hol_chains_add_linear(chains, n_relations, sizes, atoms, coefficients, n_bonds, pairs, lengths) bind(c) &
         result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: n_relations
         type(c_ptr), value :: sizes, atoms, coefficients
         integer(c_int64_t), value :: n_bonds
         type(c_ptr), value :: pairs, lengths
         integer(c_int) :: status
      end function

      function hol_chains_add_linear_molecules(chains, n_molecules, n_atoms, first_atom, n_relations, sizes, atoms, &
         coefficients, n_bonds, pairs, lengths) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: n_molecules, n_atoms, first_atom, n_relations
         type(c_ptr), value :: sizes, atoms, coefficients
         integer(c_int64_t), value :: n_bonds
         type(c_ptr), value :: pairs, lengths
         integer(c_int) :: status
      end function

#define NAME hol_chains_set_lengths
#define POINTERS chains, lengths
#include "c_function.inc"
#define NAME hol_chains_set_masses
#define POINTERS chains, masses
#include "c_function.inc"
#define NAME hol_chains_set_index_base
#define ARGUMENTS chains, base
#define POINTERS chains
#define OPTIONS base
#include "c_function.inc"
#define NAME hol_chains_set_box
#define TWIN hol_chains_set_reference_box
#define POINTERS chains, box
#include "c_function.inc"
#define NAME hol_chains_set_box_rate
#define POINTERS chains, L
#include "c_function.inc"
#define NAME hol_chains_set_checks
#define ARGUMENTS chains, when
#define POINTERS chains
#define OPTIONS when
#include "c_function.inc"
#define NAME hol_chains_check
#define TWIN hol_chains_check_view
#define ARGUMENTS chains, r, box
#define POINTERS chains, r
#define OPTIONS box
#include "c_function.inc"
#define NAME hol_chains_set_labels
#define POINTERS chains, atoms, molecules
#include "c_function.inc"
#define NAME hol_chains_set_threads
#define ARGUMENTS chains, n_threads
#define POINTERS chains
#define OPTIONS n_threads
#include "c_function.inc"
#define NAME hol_chains_set_outcomes
#define ARGUMENTS chains, keep
#define POINTERS chains
#define OPTIONS keep
#include "c_function.inc"
#define NAME hol_outcomes
#define POINTERS chains, statuses, iterations
#include "c_function.inc"
#define NAME hol_chains_set_active
#define POINTERS chains, active
#include "c_function.inc"
#define NAME hol_chains_set_tolerance
#define TWIN hol_chains_set_length_tolerance
#define ARGUMENTS chains, tolerance
#define POINTERS chains
#define REALS tolerance
#include "c_function.inc"

      function hol_chains_adjustment(chains, largest, bond) bind(c) result(status)
         import :: c_double, c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         real(c_double), intent(out) :: largest
         integer(c_int64_t), intent(out) :: bond
         integer(c_int) :: status
      end function

      function hol_chains_held_sites(chains, held) bind(c) result(status)
         import :: c_int, c_ptr, c_signed_char
         type(c_ptr), value :: chains
         integer(c_signed_char), intent(out) :: held(*)
         integer(c_int) :: status
      end function

      function hol_chains_implied(chains, implied) bind(c) result(status)
         import :: c_int, c_ptr, c_signed_char
         type(c_ptr), value :: chains
         integer(c_signed_char), intent(out) :: implied(*)
         integer(c_int) :: status
      end function

      function hol_chains_set_memory_limit(chains, bytes) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: bytes
         integer(c_int) :: status
      end function

#define NAME hol_chains_set_max_iterations
#define ARGUMENTS chains, max_iterations
#define POINTERS chains
#define OPTIONS max_iterations
#include "c_function.inc"
#define NAME hol_chains_n_atoms
#define RESULT integer(c_int64_t)
#include "c_query.inc"
#define NAME hol_chains_n_molecules
#define RESULT integer(c_int64_t)
#include "c_query.inc"
#define NAME hol_chains_n_bonds
#define RESULT integer(c_int64_t)
#include "c_query.inc"
#define NAME hol_chains_offsets
#define POINTERS chains, offsets
#include "c_function.inc"

      function hol_chains_atoms(chains, molecule, atoms) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: molecule
         type(c_ptr), value :: atoms
         integer(c_int) :: status
      end function

      pure function hol_chains_n_of_shape(chains, shape) bind(c) result(n)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int), value :: shape
         integer(c_int64_t) :: n
      end function

#define NAME hol_chains_n_kinds
#define RESULT integer(c_int64_t)
#include "c_query.inc"

      function hol_chains_molecule(chains, molecule, shape, n_atoms, n_bonds) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: molecule
         type(c_ptr), value :: shape, n_atoms, n_bonds
         integer(c_int) :: status
      end function

      function hol_chains_bonds(chains, molecule, bonds) bind(c) result(status)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: molecule
         type(c_ptr), value :: bonds
         integer(c_int) :: status
      end function

#define NAME hol_chains_molecules_of_bonds
#define POINTERS chains, molecules
#include "c_function.inc"

      pure function hol_chains_degrees_of_freedom(chains, dimensions) bind(c) result(n)
         import :: c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int), value :: dimensions
         integer(c_int64_t) :: n
      end function

#define NAME hol_chains_memory
#define RESULT integer(c_int64_t)
#include "c_query.inc"

   end interface

end module
