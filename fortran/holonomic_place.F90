! Where the caller's arrays per atom stand in memory. Nothing is copied: the view that C gets has the address of the
! first element and the distance to the next, as the array's descriptor tells, so that sections such as r(:, ::2) or
! r(:3, :) do as they are. (Separate x, y, z of which each has a stride of its own are the exception: they are copied
! before and given back after. Some compilers also copy what their descriptors can't express, such as atoms%x.)
module holonomic_place
   use, intrinsic :: iso_c_binding, only: c_int, c_int32_t, c_int64_t, c_int8_t, c_intptr_t, c_loc, c_null_ptr, c_ptr, c_size_t
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_report, hol_view, HOL_ADD, HOL_BOX, HOL_DOUBLE, HOL_ERR_MEMORY, HOL_ERR_NULL, HOL_ERR_VALUE, &
                          HOL_FLOAT, HOL_REFERENCE_BOX, HOL_WRITE
   use holonomic_status, only: decimal, failure, named
   implicit none
   private
   public :: place, enough, list_of, number_at, tensor, report_at, mode_of, box_of, flag_of

   ! One component of all atoms.
   type :: line
      integer(c_intptr_t) :: first = 0   ! address
      integer(c_intptr_t) :: stride = 0  ! bytes
      integer(c_int64_t) :: extent = -1  ! -1: the caller gave no such array
   end type

   ! What stands in for x, y and z whose strides differ.
   type :: copies
      type(line) :: originals(3)
      integer(c_int8_t), allocatable :: elements(:, :, :)  ! (bytes of an element, n_atoms, 2 or 3)
   end type

   ! Small, for a call makes several: each starts as a copy of the initial values.
   type :: place
      logical :: given = .false.
      type(hol_view) :: view
      type(copies), allocatable, private :: copy
   contains
      ! rows_*(n_atoms, problem, name, array): an array (3, n) or (2, n).
      ! parts_*(n_atoms, problem, name, x, y, z): separate arrays, where a * in the name stands for x, y and z.
      ! A last argument: vectors per bond, "bonds", instead of per atom.
      procedure :: rows_32, rows_64, parts_32, parts_64
      procedure :: address
      procedure :: give_back   ! after the call, for arrays that it writes
      procedure, private :: put, put_nothing
   end type

   interface
      function c_memcpy(to, from, n) bind(c, name="memcpy") result(same)
         import :: c_intptr_t, c_size_t
         integer(c_intptr_t), value :: to, from
         integer(c_size_t), value :: n
         integer(c_intptr_t) :: same
      end function
   end interface

contains

   ! Of the view, for C; NULL if the caller gave no such array.
   recursive type(c_ptr) function address(self)
      class(place), intent(in), target :: self
      address = c_null_ptr
      if (self%given) address = c_loc(self%view)
   end function

#define WP real32
#define ELEMENT HOL_FLOAT
#define FIND_ROWS rows_32
#define FIND_PARTS parts_32
#define LINE_OF line_of_32
#include "place.inc"
#define WP real64
#define ELEMENT HOL_DOUBLE
#define FIND_ROWS rows_64
#define FIND_PARTS parts_64
#define LINE_OF line_of_64
#include "place.inc"

   recursive logical function has_rows(n_rows, extent, n_atoms, name, problem, what)
      integer, intent(in) :: n_rows
      integer(c_int64_t), intent(in) :: extent, n_atoms
      character(*), intent(in) :: name
      type(failure), intent(inout) :: problem
      character(*), intent(in), optional :: what
      has_rows = (n_rows == 3 .or. n_rows == 2) .and. extent >= n_atoms
      if (has_rows) return
      if (n_rows /= 3 .and. n_rows /= 2) call problem%set(HOL_ERR_VALUE, "the first dimension of "//name// &
                                                          " must be 3 (or 2), not "//decimal(int(n_rows, c_int64_t)))
      call too_few(name, extent, n_atoms, things(what), problem)
   end function

   ! What an array has one vector for each of.
   recursive function things(what)
      character(*), intent(in), optional :: what
      character(5) :: things
      things = "atoms"
      if (present(what)) things = what
   end function

   ! Without atoms there is nothing to point at, but NULL would mean that the array is not there.
   recursive subroutine put_nothing(self, n_parts)
      class(place), intent(inout), target :: self
      integer, intent(in) :: n_parts
      self%view%x = c_loc(self%view)
      self%view%y = c_loc(self%view)
      if (n_parts == 3) self%view%z = c_loc(self%view)
   end subroutine

   recursive integer(c_int64_t) function distance(from, to)
      type(c_ptr), intent(in) :: from, to
      distance = transfer(to, distance) - transfer(from, distance)
   end function

   recursive subroutine put(self, n_atoms, problem, name, element, x, y, z, what)
      class(place), intent(inout), target :: self
      integer(c_int64_t), intent(in) :: n_atoms
      type(failure), intent(inout) :: problem
      character(*), intent(in) :: name
      integer(c_int32_t), intent(in) :: element
      type(line), intent(in) :: x, y, z
      character(*), intent(in), optional :: what
      type(line) :: lines(3)
      integer :: part, n_parts
      lines(1) = x
      lines(2) = y
      lines(3) = z
      if (all(lines%extent < 0)) return
      if (x%extent < 0 .or. y%extent < 0) then
         call problem%set(HOL_ERR_NULL, named(name, "x")//" and "//named(name, "y")//" must be given together")
         return
      end if
      n_parts = merge(3, 2, z%extent >= 0)
      do part = 1, n_parts
         if (lines(part)%extent >= n_atoms) cycle
         call too_few(named(name, "xyz"(part:part)), lines(part)%extent, n_atoms, things(what), problem)
         return
      end do
      self%given = .true.
      self%view%element = element
      self%view%stride = x%stride
      if (n_atoms == 0) then
         call self%put_nothing(n_parts)
      else if (any(lines(:n_parts)%stride /= x%stride) .and. n_atoms > 1) then
         call take_copy(self, lines, n_atoms, n_parts, problem)
      else
         self%view%x = transfer(x%first, c_null_ptr)
         self%view%y = transfer(y%first, c_null_ptr)
         if (n_parts == 3) self%view%z = transfer(z%first, c_null_ptr)
      end if
   end subroutine

   ! C works on the copy; the places of the originals are kept for give_back.
   recursive subroutine take_copy(self, lines, n_atoms, n_parts, problem)
      class(place), intent(inout), target :: self
      type(line), intent(in) :: lines(3)
      integer(c_int64_t), intent(in) :: n_atoms
      integer, intent(in) :: n_parts
      type(failure), intent(inout) :: problem
      integer :: bytes, stat
      bytes = merge(8, 4, self%view%element == HOL_DOUBLE)
      allocate (self%copy, stat=stat)
      if (stat == 0) allocate (self%copy%elements(bytes, n_atoms, n_parts), stat=stat)
      if (stat /= 0) then
         call problem%set(HOL_ERR_MEMORY, "out of memory for copies of x, y and z, whose strides differ")
         return
      end if
      self%copy%originals = lines
      call move_elements(lines, self%copy%elements, back=.false.)
      self%view%stride = bytes
      self%view%x = c_loc(self%copy%elements(1, 1, 1))
      self%view%y = c_loc(self%copy%elements(1, 1, 2))
      if (n_parts == 3) self%view%z = c_loc(self%copy%elements(1, 1, 3))
   end subroutine

   recursive subroutine give_back(self)
      class(place), intent(in), target :: self
      if (allocated(self%copy)) call move_elements(self%copy%originals, self%copy%elements, back=.true.)
   end subroutine

   recursive subroutine move_elements(lines, copy, back)
      type(line), intent(in) :: lines(3)
      integer(c_int8_t), contiguous, target :: copy(:, :, :)
      logical, intent(in) :: back
      integer(c_intptr_t) :: theirs, ours, same
      integer(c_int64_t) :: atom
      integer :: part
      do part = 1, size(copy, 3)
         do atom = 1, size(copy, 2, c_int64_t)
            theirs = lines(part)%first + (atom - 1)*lines(part)%stride
            ours = transfer(c_loc(copy(1, atom, part)), ours)
            if (back) then
               same = c_memcpy(theirs, ours, size(copy, 1, c_size_t))
            else
               same = c_memcpy(ours, theirs, size(copy, 1, c_size_t))
            end if
         end do
      end do
   end subroutine

   ! Whether an array has the elements that are needed; more do no harm, as in codes that dimension for the worst case.
   recursive logical function enough(name, extent, needed, what, problem)
      character(*), intent(in) :: name, what
      integer(c_int64_t), intent(in) :: extent, needed
      type(failure), intent(inout) :: problem
      enough = extent >= needed
      if (.not. enough) call too_few(name, extent, needed, what, problem)
   end function

   recursive subroutine too_few(name, extent, needed, what, problem)
      character(*), intent(in) :: name, what
      integer(c_int64_t), intent(in) :: extent, needed
      type(failure), intent(inout) :: problem
      call problem%set(HOL_ERR_VALUE, name//" has "//decimal(extent)//" elements, too few for "//decimal(needed)//" "//what)
   end subroutine

   ! Of an array per bond or per molecule, after a check of its size; NULL if the caller gave none.
   recursive type(c_ptr) function list_of(array, name, needed, what, problem)
      real(real64), optional, contiguous, target :: array(:)
      character(*), intent(in) :: name, what
      integer(c_int64_t), intent(in) :: needed
      type(failure), intent(inout) :: problem
      list_of = c_null_ptr
      if (.not. present(array)) return
      if (enough(name, size(array, kind=c_int64_t), needed, what, problem)) list_of = c_loc(array)
   end function

   recursive type(c_ptr) function number_at(number)
      real(real64), optional, target :: number
      number_at = c_null_ptr
      if (present(number)) number_at = c_loc(number)
   end function

   recursive type(c_ptr) function tensor(matrix)
      real(real64), optional, target :: matrix(3, 3)
      tensor = c_null_ptr
      if (present(matrix)) tensor = c_loc(matrix)
   end function

   recursive type(c_ptr) function report_at(report)
      type(hol_report), optional, target :: report
      report_at = c_null_ptr
      if (present(report)) report_at = c_loc(report)
   end function

   ! C's numbers for an option that is .true., or is .false. or absent.
   pure recursive integer(c_int) function mode_of(add)
      logical, intent(in), optional :: add
      mode_of = HOL_WRITE
      if (present(add)) mode_of = merge(HOL_ADD, HOL_WRITE, add)
   end function

   pure recursive integer(c_int) function box_of(reference)
      logical, intent(in), optional :: reference
      box_of = HOL_BOX
      if (present(reference)) box_of = merge(HOL_REFERENCE_BOX, HOL_BOX, reference)
   end function

   pure recursive integer(c_int) function flag_of(guess)
      logical, intent(in), optional :: guess
      flag_of = 0
      if (present(guess)) flag_of = merge(1_c_int, 0_c_int, guess)
   end function

end module
