! Numbers in default reals, and what a set tells of what it was given.
program test_given
   use, intrinsic :: iso_fortran_env, only: int64
   use holonomic
   implicit none
   type(hol_chains) :: c, d
   real :: box(3) = 9.0
   integer :: i, roles(4)
   integer(int64) :: removed(3), pairs(2, 4)
   double precision :: lengths(4)
   call c%create([(1.0, i=1, 8)])
   call c%add([1, 2, 3], [1.0, 1.5])
   call c%add(1, 1, 4, 1.0)
   call c%add(reshape([6, 7], [2, 1]), [1.25])
   call c%set_box(box)
   call c%set_tolerance(1e-6)
   call c%set_lengths([1.0, 1.0, 1.0, 1.25])
   call d%copy_of(c)
   call d%set_length(4, 2d0)
   call d%roles(roles, removed)
   call d%bond_pairs(pairs)
   call d%bond_lengths(lengths)
   if (any(roles /= HOL_ROLE_OWN) .or. sum(removed) /= 4) error stop "roles"
   if (pairs(1, 4) /= 6 .or. d%n_molecules() /= 3) error stop "pairs"
   if (abs(lengths(2) - 1) > 0 .or. abs(lengths(4) - 2) > 0) error stop "lengths"
   call c%bond_lengths(lengths)
   if (abs(lengths(4) - 1.25d0) > 0) error stop "a copy is changed apart"
   call d%destroy()
   call c%destroy()
end program
