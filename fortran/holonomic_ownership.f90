! Who owns what a handle refers to: the variable in which it was created, known by where that variable stands. A copy stands
! elsewhere, however it was made: by assignment, alone or as a component at any depth, in an array, by `source=`, as a
! function's result. Nothing has to be done when one is made. (A defined assignment would have to be called for each of these;
! compilers leave it out for components, and arrays whose assignment is defined cannot grow by `list = [list, another]`.)
module holonomic_ownership
   use, intrinsic :: iso_c_binding, only: c_associated, c_loc, c_null_ptr, c_ptr
   implicit none
   private
   public :: ownership

   type :: ownership
      private
      type(c_ptr) :: place = c_null_ptr   ! where the owner's component of this type stands
   contains
      procedure :: take
      procedure :: drop
      procedure :: is_here
   end type

contains

   recursive subroutine take(self)
      class(ownership), intent(inout), target :: self
      self%place = c_loc(self%place)
   end subroutine

   recursive subroutine drop(self)
      class(ownership), intent(inout) :: self
      self%place = c_null_ptr
   end subroutine

   recursive logical function is_here(self)
      class(ownership), intent(in), target :: self
      is_here = c_associated(self%place, c_loc(self%place))
   end function

end module
