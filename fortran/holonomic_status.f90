! How a failure reaches the caller: `stat` and `errmsg` as in ALLOCATE. If `stat` is present the procedure returns, with
! a hol_status in it (0 on success) and the reason in `errmsg`, which a success leaves alone; if `stat` is absent a
! failure stops the program with the reason.
module holonomic_status
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_null_char, c_f_pointer, c_int, c_int64_t, c_ptr, c_size_t
   use holonomic_c, only: hol_error_message, hol_error_remember, HOL_ERR_NULL, HOL_OK
   implicit none
   private
   public :: failure, settle, text_of, decimal, named

   ! The first thing found wrong with the arguments of a call, or what the library said about it.
   ! The message is of fixed length, as C's is: there may be no memory left for another. Undefined while there is none.
   type :: failure
      integer(c_int) :: status = HOL_OK
      logical :: is_own = .false.   ! found here, and not by the library
      character(640) :: message
   contains
      procedure :: none
      procedure :: set
      procedure :: need_created
      procedure :: ask
   end type

   interface
      function c_strlen(text) bind(c, name="strlen") result(n)
         import :: c_ptr, c_size_t
         type(c_ptr), value :: text
         integer(c_size_t) :: n
      end function
   end interface

contains

   recursive logical function none(self)
      class(failure), intent(in) :: self
      none = self%status == HOL_OK
   end function

   recursive subroutine set(self, status, message)
      class(failure), intent(inout) :: self
      integer(c_int), intent(in) :: status
      character(*), intent(in) :: message
      if (.not. self%none()) return
      self%status = status
      self%is_own = .true.
      self%message = message
   end subroutine

   ! To be called first: of what C then says about NULL nothing is kept.
   recursive subroutine need_created(self, handle)
      class(failure), intent(inout) :: self
      type(c_ptr), intent(in) :: handle
      if (.not. c_associated(handle)) call self%set(HOL_ERR_NULL, "create has not been called")
   end subroutine

   ! Takes over the status of a C function, and its message if it failed, without the name of that function: `settle`
   ! names the procedure that the caller knows.
   recursive subroutine ask(self, status)
      class(failure), intent(inout) :: self
      integer(c_int), intent(in) :: status
      character(kind=c_char), pointer :: letters(:)
      type(c_ptr) :: text
      integer :: i, behind
      if (status == HOL_OK .or. .not. self%none()) return
      self%status = status
      self%message = ""
      text = hol_error_message()
      call c_f_pointer(text, letters, [c_strlen(text)])
      do i = 1, min(size(letters), len(self%message))
         self%message(i:i) = letters(i)
      end do
      behind = verify(self%message, "abcdefghijklmnopqrstuvwxyz_")
      if (self%message(:4) /= "hol_" .or. self%message(behind:behind + 1) /= ": ") return
      self%message = self%message(behind + 2:)
   end subroutine

   ! The end of every procedure; `procedure` is its name, which stands before the message.
   recursive subroutine settle(problem, procedure, stat, errmsg)
      type(failure), intent(in) :: problem
      character(*), intent(in) :: procedure
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      character(len(problem%message) + 40) :: text   ! not an expression: there may be no memory left for one
      integer :: n, ignored
      if (present(stat)) stat = int(problem%status)
      if (problem%none()) return
      n = len(procedure)
      text = procedure
      text(n + 1:n + 2) = ": "
      text(n + 3:) = problem%message
      if (problem%is_own) ignored = hol_error_remember(problem%status, trim(text)//c_null_char)
      if (.not. present(stat)) error stop "holonomic: "//trim(text)
      if (present(errmsg)) errmsg = text
   end subroutine

   ! A Fortran copy of a C string.
   recursive function text_of(address) result(text)
      type(c_ptr), intent(in) :: address
      character(:), allocatable :: text
      character(kind=c_char), pointer :: letters(:)
      integer :: i
      call c_f_pointer(address, letters, [c_strlen(address)])
      allocate (character(size(letters)) :: text)
      do i = 1, size(letters)
         text(i:i) = letters(i)
      end do
   end function

   ! The name of an array of a component, where `pattern` has a star for it.
   pure recursive function named(pattern, component) result(name)
      character(*), intent(in) :: pattern, component
      character(:), allocatable :: name
      integer :: at
      at = index(pattern, "*")
      name = pattern
      if (at > 0) name = pattern(:at - 1)//component//pattern(at + 1:)
   end function

   pure recursive function decimal(n) result(text)
      integer(c_int64_t), intent(in) :: n
      character(:), allocatable :: text
      character(20) :: digits
      write (digits, "(i0)") n
      text = trim(digits)
   end function

end module
