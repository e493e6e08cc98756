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

      function hol_chains_set_bodies(chains, which) bind(c) result(status)
         import :: c_int, c_ptr
         type(c_ptr), value :: chains
         integer(c_int), value :: which
         integer(c_int) :: status
      end function

      function hol_chains_pairs(chains, pairs) bind(c) result(status)
         import :: c_int, c_ptr
         type(c_ptr), value :: chains, pairs
         integer(c_int) :: status
      end function

      function hol_chains_lengths(chains, lengths) bind(c) result(status)
         import :: c_int, c_ptr
         type(c_ptr), value :: chains, lengths
         integer(c_int) :: status
      end function

      function hol_chains_masses(chains, masses) bind(c) result(status)
         import :: c_int, c_ptr
         type(c_ptr), value :: chains, masses
         integer(c_int) :: status
      end function

      function hol_chains_box(chains, which, box) bind(c) result(status)
         import :: c_int, c_ptr
         type(c_ptr), value :: chains
         integer(c_int), value :: which
         type(c_ptr), value :: box
         integer(c_int) :: status
      end function

      function hol_chains_roles(chains, roles, removed) bind(c) result(status)
         import :: c_int, c_ptr
         type(c_ptr), value :: chains, roles, removed
         integer(c_int) :: status
      end function

   end interface

end module
