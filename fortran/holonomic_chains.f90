! Which atoms are joined by rigid bonds. Here type(hol_chains) begins: it is created, copied and destroyed. The modules holonomic_bonds, holonomic_settings, holonomic_counts, holonomic_forces and so on extend the type,
! each by one ability; the module `holonomic` has the whole. Atoms, bonds and molecules are counted from 1.
module holonomic_chains
   use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use holonomic_c, only: hol_chains_copy, hol_chains_create, hol_chains_destroy, hol_chains_set_index_base, &
                          hol_error_location, HOL_ERR_VALUE
   use holonomic_ownership, only: ownership
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: chain_set

   type :: chain_set
      private
      type(c_ptr) :: handle = c_null_ptr
      type(ownership) :: owner
   contains
      procedure, private :: create_32, create_64   ! masses of either precision
      generic :: create => create_32, create_64
      procedure :: copy_of
      procedure :: adopt
      procedure :: destroy
      procedure :: c_handle   ! for calls of the module holonomic_c
   end type

contains

   subroutine create_64(self, masses, stat, errmsg)
      class(chain_set), intent(inout) :: self
      real(real64), intent(in), contiguous, target :: masses(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(c_int64_t), target :: atom
      real(real64), target :: no_mass(1)
      integer(c_int) :: status
      if (c_associated(self%handle)) then
         call problem%set(HOL_ERR_VALUE, "this variable has been created already; destroy it first")
      else
         no_mass = 0
         if (size(masses) == 0) then
            status = hol_chains_create(0_c_int64_t, c_loc(no_mass), self%handle)
         else
            status = hol_chains_create(size(masses, kind=c_int64_t), c_loc(masses), self%handle)
         end if
         if (status == HOL_ERR_VALUE) then
            ! The C function has no index base yet, and its message would count the atoms from 0.
            call hol_error_location(c_null_ptr, c_null_ptr, c_loc(atom), c_null_ptr)
            if (atom >= 0) call problem%set(status, "the mass of atom "//decimal(atom + 1)// &
                                            " is negative, not a number or too small")
         end if
         call problem%ask(status)
         if (problem%none()) call problem%ask(hol_chains_set_index_base(self%handle, 1_c_int))
         if (problem%none()) call self%owner%take()
      end if
      call settle(problem, "create", stat, errmsg)
   end subroutine

   subroutine create_32(self, masses, stat, errmsg)
      class(chain_set), intent(inout) :: self
      real(real32), intent(in) :: masses(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%create(real(masses, real64), stat, errmsg)
   end subroutine

   ! Molecules of its own, as those of another variable are now, with its options: to be changed apart from them.
   subroutine copy_of(self, other, stat, errmsg)
      class(chain_set), intent(inout) :: self
      class(chain_set), intent(in) :: other
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(other%handle)
      if (c_associated(self%handle)) &
         call problem%set(HOL_ERR_VALUE, "this variable has been created already; destroy it first")
      if (problem%none()) call problem%ask(hol_chains_copy(other%handle, self%handle))
      if (problem%none()) call self%owner%take()
      call settle(problem, "copy_of", stat, errmsg)
   end subroutine

   ! A copy only forgets the molecules: they belong to the variable that created them.
   impure elemental subroutine destroy(self)
      class(chain_set), intent(inout) :: self
      if (self%owner%is_here()) call hol_chains_destroy(self%handle)
      self%handle = c_null_ptr
      call self%owner%drop()
   end subroutine

   ! Owns the molecules from now on. For a copy whose owner is gone without `destroy`.
   impure elemental subroutine adopt(self)
      class(chain_set), intent(inout) :: self
      if (c_associated(self%handle)) call self%owner%take()
   end subroutine

   pure recursive type(c_ptr) function c_handle(self)
      class(chain_set), intent(in) :: self
      c_handle = self%handle
   end function

end module
