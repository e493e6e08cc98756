! Position level along given bond vectors: hol_project_positions_along with arrays of any layout.
module holonomic_along
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use holonomic_c, only: hol_project_positions_along_view, hol_reference_error, hol_report
   use holonomic_place, only: flag_of, list_of, place, report_at, tensor
   use holonomic_positions, only: chain_set_positions
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_along

   type, extends(chain_set_positions) :: chain_set_along
   contains
      procedure, private :: along_rows_32, along_rows_64, along_parts_32, along_parts_64
      procedure, private :: along_rows_32_short, along_parts_32_short   ! dt of single precision, too
      generic :: project_positions_along => along_rows_32, along_rows_64, along_parts_32, along_parts_64, &
         along_rows_32_short, along_parts_32_short
      procedure :: reference_error
   end type

contains

   ! The largest |b.b - a^2| / a^2 of the last reference that a call has compared with the lengths, and where.
   subroutine reference_error(self, error, molecule, bond, stat, errmsg)
      class(chain_set_along), intent(in) :: self
      real(real64), intent(inout), target :: error
      integer(int64), intent(inout), optional :: molecule, bond
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64), target :: place_of(2)
      call problem%need_created(self%c_handle())
      if (problem%none()) call problem%ask(hol_reference_error(self%c_handle(), c_loc(error), c_loc(place_of(1)), &
                                                               c_loc(place_of(2))))
      if (problem%none() .and. present(molecule)) molecule = place_of(1)
      if (problem%none() .and. present(bond)) bond = place_of(2)
      call settle(problem, "reference_error", stat, errmsg)
   end subroutine

#define ROWS 32
#define TIME real64
#define PROJECT along_rows_32
#include "along.inc"
#define ROWS 64
#define TIME real64
#define PROJECT along_rows_64
#include "along.inc"
#define PARTS 32
#define TIME real64
#define PROJECT along_parts_32
#include "along.inc"
#define PARTS 64
#define TIME real64
#define PROJECT along_parts_64
#include "along.inc"
#define ROWS 32
#define TIME real32
#define PROJECT along_rows_32_short
#include "along.inc"
#define PARTS 32
#define TIME real32
#define PROJECT along_parts_32_short
#include "along.inc"

end module
