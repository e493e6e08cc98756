! Exact Lagrange multipliers and constraint forces of molecules with rigid bonds: the Fortran side of the library.
!
!     use holonomic
!     type(hol_chains) :: chains
!     call chains%create(masses)                                   ! 0 = held fixed
!     call chains%add(atoms=[1, 2, 3, 4], lengths=[1.54d0, 1.54d0, 1.54d0])       ! a linear chain, or
!     call chains%add(bonds=pairs, lengths=lengths)                ! (2, n): bonds in any order, molecules of any shape
!     call chains%forces(r, v, f, g=g, tension=tension)            ! g: the constraint forces
!     call chains%project_positions(r_ref, r, dt, v)               ! SHAKE, RATTLE's first half
!     call chains%project_velocities(r, v)                         ! RATTLE's second half
!     call chains%destroy()
!
! The arguments are those of the C functions of the same name (holonomic.h), in docs/fortran.md; everything is counted
! from 1. Every procedure has the optional arguments stat and errmsg of ALLOCATE.
module holonomic
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_loc
   use, intrinsic :: iso_fortran_env, only: int32, int64
   use holonomic_c, only: hol_report, hol_worst, HOL_OK, HOL_ERR_NULL, HOL_ERR_VALUE, HOL_ERR_INDEX, &
                          HOL_ERR_SHARED_ATOM, HOL_ERR_MEMORY, HOL_ERR_NOT_FINITE, HOL_ERR_DEGENERATE, &
                          HOL_ERR_NO_CONVERGENCE, HOL_ERR_NOT_DEFINITE, HOL_ERR_INTERNAL, HOL_ERR_LENGTHS, &
                          HOL_ERR_UNSUPPORTED, HOL_ERR_STATE, HOL_ERR_CALLBACK, HOL_BODIES_FOUND, HOL_BODIES_GIVEN, &
                          HOL_ROLE_OWN, HOL_ROLE_BODY, HOL_ROLE_IMPLIED, HOL_ROLE_FIXED, &
                          c_version_number => hol_version_number, &
                          HOL_NEVER, HOL_AT_START, HOL_ALWAYS, c_version => hol_version, c_status_name => hol_status_name, &
                          c_instruction_set => hol_instruction_set, c_error_location => hol_error_location, &
                          HOL_PHYSICAL, HOL_SHAPE_CHAIN, HOL_SHAPE_OTHER, HOL_SHAPE_RIGID, HOL_SHAPE_RING, &
                          HOL_SHAPE_TREE, &
                          HOL_SHAPE_TRIANGLE, HOL_UNIT_DIAGONAL
   use holonomic_chains, only: hol_chains
   use holonomic_equimomental, only: equimomental_points
   use holonomic_factors, only: hol_factors
   use holonomic_inverse, only: hol_inverse
   use holonomic_status, only: text_of
   use holonomic_tridiagonal, only: inverse_band, inverse_entry, log_det, partition_of_equal_masses, &
                                    partition_of_masses, pivots, solve
   implicit none
   private
   public :: hol_chains, hol_factors, hol_inverse, hol_report, hol_worst
   public :: hol_version, hol_version_number, hol_status_name, hol_instruction_set, hol_error_location
   public :: hol_tridiagonal_pivots, hol_tridiagonal_log_det, hol_tridiagonal_solve, hol_tridiagonal_inverse_entry, &
             hol_tridiagonal_inverse_band, hol_partition_function, hol_equimomental_points
   public :: HOL_OK, HOL_ERR_NULL, HOL_ERR_VALUE, HOL_ERR_INDEX, HOL_ERR_SHARED_ATOM, HOL_ERR_MEMORY, &
             HOL_ERR_NOT_FINITE, HOL_ERR_DEGENERATE, HOL_ERR_NO_CONVERGENCE, HOL_ERR_NOT_DEFINITE, HOL_ERR_INTERNAL, &
             HOL_ERR_LENGTHS, HOL_ERR_UNSUPPORTED, HOL_ERR_STATE, HOL_ERR_CALLBACK, HOL_BODIES_FOUND, HOL_BODIES_GIVEN, &
             HOL_ROLE_OWN, HOL_ROLE_BODY, HOL_ROLE_IMPLIED, HOL_ROLE_FIXED, &
             HOL_NEVER, HOL_AT_START, HOL_ALWAYS, HOL_PHYSICAL, HOL_UNIT_DIAGONAL, HOL_SHAPE_CHAIN, &
             HOL_SHAPE_TREE, HOL_SHAPE_RING, HOL_SHAPE_TRIANGLE, HOL_SHAPE_OTHER, &
             HOL_SHAPE_RIGID

   interface hol_tridiagonal_pivots
      procedure :: pivots
   end interface

   interface hol_tridiagonal_log_det
      procedure :: log_det
   end interface

   interface hol_tridiagonal_solve
      procedure :: solve
   end interface

   interface hol_tridiagonal_inverse_entry
      procedure :: inverse_entry
   end interface

   interface hol_tridiagonal_inverse_band
      procedure :: inverse_band
   end interface

   interface hol_equimomental_points
      procedure :: equimomental_points
   end interface

   interface hol_partition_function
      procedure :: partition_of_masses, partition_of_equal_masses
   end interface

   ! Names as in C, for procedures of Fortran.
   interface hol_version
      procedure :: version
   end interface

   interface hol_version_number
      procedure :: version_number
   end interface

   interface hol_status_name
      procedure :: status_name_32, status_name_64
   end interface

   interface hol_instruction_set
      procedure :: instruction_set
   end interface

   interface hol_error_location
      procedure :: error_location
   end interface

contains

   function version() result(text)
      character(:), allocatable :: text
      text = text_of(c_version())
   end function

   ! 10000 major + 100 minor + patch.
   integer function version_number()
      version_number = int(c_version_number())
   end function

   function status_name_32(status) result(text)
      integer(int32), intent(in) :: status
      character(:), allocatable :: text
      text = text_of(c_status_name(int(status, c_int)))
   end function

   function status_name_64(status) result(text)
      integer(int64), intent(in) :: status
      character(:), allocatable :: text
      text = text_of(c_status_name(int(status, c_int)))
   end function

   function instruction_set() result(text)
      character(:), allocatable :: text
      text = text_of(c_instruction_set())
   end function

   ! Where this thread's last failure inside the library was; -1: does not apply.
   subroutine error_location(molecule, bond, atom, n_bad)
      integer(int64), intent(out), optional :: molecule, bond, atom, n_bad
      integer(c_int64_t), target :: at(4)
      at = -1
      call c_error_location(c_loc(at(1)), c_loc(at(2)), c_loc(at(3)), c_loc(at(4)))
      if (present(molecule)) molecule = at(1)
      if (present(bond)) bond = at(2)
      if (present(atom)) atom = at(3)
      if (present(n_bad)) n_bad = at(4)
   end subroutine

end module
