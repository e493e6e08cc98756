! Copies of variables that own something, however they are made: they refer to the same molecules, and in whichever order
! they are destroyed, what they refer to is released once, by the variable in which it was created.
module copied_types
   use holonomic
   implicit none
   type :: part
      type(hol_chains) :: chains
      type(hol_inverse) :: inverse
   end type
   type :: whole
      integer :: before = 3
      type(part) :: inner
      integer :: after = 4
   end type
   type, extends(whole) :: whole_and_more
      type(part) :: second
   end type
   type :: many
      type(part) :: fixed(2)
      type(part), allocatable :: one
      type(whole), allocatable :: list(:)
   end type
end module

program test_copies
   use, intrinsic :: iso_fortran_env, only: real64
   use checks, only: check, finish, test
   use copied_types
   implicit none
   real(real64) :: r(3, 3)

   r = reshape([0, 0, 0, 1, 0, 0, 1, 1, 0], [3, 3])
   call variables()
   call components()
   call components_of_components()
   call arrays()
   call growing_lists()
   call allocatable_variables()
   call allocatable_components()
   call polymorphic_variables()
   call results_of_functions()
   call keeping_and_going_back()
   call exchanging()
   call finish()

contains

   subroutine make(it)
      type(part), intent(inout) :: it
      call it%chains%create([1.0_real64, 1.0_real64, 1.0_real64])
      call it%chains%add([1, 2, 3], 1.0_real64)
      call it%inverse%create(it%chains, 1, r)
   end subroutine

   impure elemental subroutine destroy(it)
      type(part), intent(inout) :: it
      call it%inverse%destroy()
      call it%chains%destroy()
   end subroutine

   impure elemental subroutine adopt(it)
      type(part), intent(inout) :: it
      call it%inverse%adopt()
      call it%chains%adopt()
   end subroutine

   elemental logical function works(it)
      type(part), intent(in) :: it
      works = it%chains%n_bonds() == 2 .and. it%inverse%n_bonds() == 2
   end function

   elemental logical function empty(it)
      type(part), intent(in) :: it
      empty = it%chains%n_bonds() == 0 .and. it%inverse%n_bonds() == 0
   end function

   subroutine variables()
      type(part) :: it
      type(hol_chains) :: copy
      type(hol_inverse) :: copy_of_inverse
      call test("a variable")
      call make(it)
      copy = it%chains
      copy = copy
      copy_of_inverse = it%inverse
      call copy%destroy()
      call copy_of_inverse%destroy()
      call check(copy%n_bonds() == 0 .and. works(it), "the copy is forgotten alone")
      copy = it%chains
      copy_of_inverse = it%inverse
      call destroy(it)
      call copy%destroy()
      call copy_of_inverse%destroy()
      call check(empty(it) .and. copy%n_bonds() == 0, "the owner goes first")
   end subroutine

   subroutine components()
      type(part) :: a, b
      call test("a component")
      call make(a)
      b = a
      call check(works(b), "the copy works")
      call destroy(b)
      call check(empty(b) .and. works(a), "the copy is forgotten alone")
      b = a
      call destroy(a)
      call destroy(b)
      call check(empty(a) .and. empty(b), "the owner goes first")
   end subroutine

   subroutine components_of_components()
      type(whole) :: a, b
      call test("a component of a component")
      call make(a%inner)
      b = a
      call destroy(b%inner)
      call check(works(a%inner) .and. b%after == 4, "the copy is forgotten alone")
      b = whole(1, a%inner, 2)
      call destroy(b%inner)
      call check(works(a%inner), "what a constructor made, too")
      b = a
      call destroy(a%inner)
      call destroy(b%inner)
      call check(empty(a%inner) .and. empty(b%inner), "the owner goes first")
   end subroutine

   subroutine arrays()
      type(part) :: owners(3), copies(3)
      type(whole) :: a(2), b(2)
      integer :: i
      call test("arrays")
      do i = 1, 3
         call make(owners(i))
      end do
      copies = owners
      copies(2:3) = owners(1:2)
      copies(3:1:-1) = copies
      call destroy(copies)
      call check(all(works(owners)), "elements")
      copies = owners(1)
      call destroy(copies)
      call check(all(works(owners)), "one for all")
      do i = 1, 2
         a(i)%inner = owners(i)
      end do
      b = a
      call destroy(a%inner)
      call check(all(works(owners)) .and. all(works(b%inner)), "components of elements")
      call destroy(b(2:1:-1)%inner)
      call destroy(owners)
      call destroy(copies)
      call check(all(empty(owners)), "the owners go")
   end subroutine

   subroutine growing_lists()
      type(whole), allocatable :: list(:), longer(:)
      type(hol_chains), allocatable :: chains(:)
      type(whole) :: one
      integer :: i
      call test("a list that grows")
      call make(one%inner)
      allocate (list(0), chains(0))
      do i = 1, 5
         list = [list, one]
         chains = [chains, one%inner%chains]
      end do
      call check(size(list) == 5 .and. size(chains) == 5 .and. all(works(list%inner)), "copies in it")
      call destroy(list%inner)
      call chains%destroy()
      call check(works(one%inner), "are forgotten alone")
      call destroy(one%inner)

      deallocate (list)
      allocate (list(1))
      call make(list(1)%inner)
      allocate (longer(3))
      longer(1:1) = list
      call move_alloc(longer, list)
      call adopt(list%inner)
      call make(list(2)%inner)
      call make(list(3)%inner)
      call check(all(works(list%inner)), "owners in it are moved with it")
      call destroy(list%inner)
      call check(all(empty(list%inner)), "and own what they had")
   end subroutine

   subroutine allocatable_variables()
      type(whole), allocatable :: a, b, c
      call test("allocatable variables")
      allocate (a)
      call make(a%inner)
      b = a
      allocate (c, source=a)
      call check(works(b%inner) .and. works(c%inner), "copies work")
      call destroy(b%inner)
      call destroy(c%inner)
      call check(works(a%inner), "they are forgotten alone")
      call move_alloc(a, b)
      call destroy(b%inner)
      call check(empty(b%inner), "what was moved still owns")
   end subroutine

   subroutine allocatable_components()
      type(many) :: a, b
      integer :: i
      call test("allocatable components")
      allocate (a%one, a%list(2))
      call make(a%one)
      do i = 1, 2
         call make(a%fixed(i))
         call make(a%list(i)%inner)
      end do
      b = a
      call check(all(works(b%fixed)) .and. works(b%one) .and. all(works(b%list%inner)), "copies work")
      call destroy_many(b)
      call check(all(works(a%fixed)) .and. works(a%one) .and. all(works(a%list%inner)), "they are forgotten alone")
      b = a
      call destroy_many(a)
      call destroy_many(b)
      call check(all(empty(a%fixed)) .and. all(empty(b%list%inner)), "the owners go first")
   end subroutine

   subroutine destroy_many(it)
      type(many), intent(inout) :: it
      call destroy(it%fixed)
      call destroy(it%one)
      call destroy(it%list%inner)
   end subroutine

   subroutine polymorphic_variables()
      class(whole), allocatable :: a, b
      call test("polymorphic variables")
      allocate (whole_and_more :: a)
      select type (a)
      type is (whole_and_more)
         call make(a%inner)
         call make(a%second)
      end select
      allocate (b, source=a)
      call destroy_all(b)
      call check(works(a%inner), "the copy is forgotten alone")
      deallocate (b)
      allocate (b, source=a)
      call destroy_all(a)
      call destroy_all(b)
      call check(empty(a%inner) .and. empty(b%inner), "the owner goes first")
   end subroutine

   subroutine destroy_all(it)
      class(whole), intent(inout) :: it
      call destroy(it%inner)
      select type (it)
      type is (whole_and_more)
         call destroy(it%second)
      end select
   end subroutine

   function made() result(it)
      type(whole) :: it
      call make(it%inner)
   end function

   function same(it)
      type(whole), intent(in) :: it
      type(whole) :: same
      same = it
   end function

   subroutine results_of_functions()
      type(whole) :: a, b
      call test("results of functions")
      a = made()
      call adopt(a%inner)
      call check(works(a%inner), "one that was made there works")
      b = same(a)
      call destroy(b%inner)
      call check(works(a%inner), "a copy that was made there is forgotten alone")
      call destroy(a%inner)
      call adopt(a%inner)
      call destroy(a%inner)
      call check(empty(a%inner), "adopting nothing does no harm")
   end subroutine

   subroutine keeping_and_going_back()
      type(whole) :: now, kept
      integer :: i
      call test("a state that is kept")
      call make(now%inner)
      do i = 1, 3
         kept = now
         now%before = i
         now = kept
      end do
      call destroy(kept%inner)
      call check(works(now%inner) .and. now%before == 3, "is gone back to")
      call destroy(now%inner)
      call check(empty(now%inner), "and the variable still owns")
   end subroutine

   subroutine exchanging()
      type(whole) :: a, b, c
      call test("two that change places")
      call make(a%inner)
      call make(b%inner)
      c = a
      a = b
      b = c
      call check(works(a%inner) .and. works(b%inner), "work")
      call adopt(a%inner)
      call adopt(b%inner)
      call destroy(c%inner)
      call check(works(a%inner) .and. works(b%inner), "and own what they have")
      call destroy(a%inner)
      call destroy(b%inner)
   end subroutine

end program
