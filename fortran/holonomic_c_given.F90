! The C functions by which a set is copied and tells what it was given, declared for Fortran; part of the module holonomic_c.
module holonomic_c_given
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_ptr
   implicit none
   public
   private :: c_double, c_int, c_int64_t, c_ptr

   ! hol_bodies
   integer(c_int), parameter :: HOL_BODIES_FOUND = 0
   integer(c_int), parameter :: HOL_BODIES_GIVEN = 1

   ! hol_role
   integer(c_int), parameter :: HOL_ROLE_OWN = 0
   integer(c_int), parameter :: HOL_ROLE_BODY = 1
   integer(c_int), parameter :: HOL_ROLE_IMPLIED = 2
   integer(c_int), parameter :: HOL_ROLE_FIXED = 3

   interface

      function hol_chains_copy(chains, copy) bind(c) result(status)
         import :: c_int, c_ptr
         type(c_ptr), value :: chains
         type(c_ptr), intent(out) :: copy
         integer(c_int) :: status
      end function

      function hol_chains_set_length(chains, bond, length) bind(c) result(status)
         import :: c_double, c_int, c_int64_t, c_ptr
         type(c_ptr), value :: chains
         integer(c_int64_t), value :: bond
         real(c_double), value :: length
         integer(c_int) :: status
      end function

#define NAME hol_chains_set_bodies
#define ARGUMENTS chains, which
#define POINTERS chains
#define OPTIONS which
#include "c_function.inc"
#define NAME hol_chains_pairs
#define POINTERS chains, pairs
#include "c_function.inc"
#define NAME hol_chains_images
#define POINTERS chains, images
#include "c_function.inc"
#define NAME hol_chains_set_images
#define POINTERS chains, images
#include "c_function.inc"
#define NAME hol_chains_lengths
#define POINTERS chains, lengths
#include "c_function.inc"
#define NAME hol_chains_masses
#define POINTERS chains, masses
#include "c_function.inc"
#define NAME hol_chains_box
#define ARGUMENTS chains, which, box
#define POINTERS chains, box
#define OPTIONS which
#include "c_function.inc"
#define NAME hol_chains_roles
#define POINTERS chains, roles, removed
#include "c_function.inc"
#define NAME hol_chains_bodies
#define RESULT integer(c_int)
#include "c_query.inc"
#define NAME hol_chains_checks
#define RESULT integer(c_int)
#include "c_query.inc"
#define NAME hol_chains_index_base
#define RESULT integer(c_int)
#include "c_query.inc"
#define NAME hol_chains_length_tolerance
#define RESULT real(c_double)
#include "c_query.inc"
#define NAME hol_chains_max_iterations
#define RESULT integer(c_int)
#include "c_query.inc"
#define NAME hol_chains_memory_limit
#define RESULT integer(c_int64_t)
#include "c_query.inc"
#define NAME hol_chains_outcomes
#define RESULT integer(c_int)
#include "c_query.inc"
#define NAME hol_chains_threads
#define RESULT integer(c_int)
#include "c_query.inc"
#define NAME hol_chains_tolerance
#define RESULT real(c_double)
#include "c_query.inc"
#define NAME hol_chains_active
#define POINTERS chains, active
#include "c_function.inc"
#define NAME hol_chains_box_rate
#define POINTERS chains, L
#include "c_function.inc"
#define NAME hol_chains_labels
#define POINTERS chains, atoms, molecules
#include "c_function.inc"

   end interface

end module
