! Which atoms are joined by rigid bonds. Here type(hol_chains) begins: it is created and destroyed, and linear chains
! are added. The modules holonomic_bonds, holonomic_settings, holonomic_counts, holonomic_forces and so on extend the type,
! each by one ability; the module `holonomic` has the whole. Atoms, bonds and molecules are counted from 1.
module holonomic_chains
   use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int32, int64, real64
   use holonomic_c, only: hol_chains_add, hol_chains_add_block, hol_chains_copy, hol_chains_create, hol_chains_destroy, &
                          hol_chains_set_index_base, hol_error_location, HOL_ERR_VALUE
   use holonomic_ownership, only: ownership
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: chain_set, repeated

   type :: chain_set
      private
      type(c_ptr) :: handle = c_null_ptr
      type(ownership) :: owner
   contains
      procedure, private :: create_set
      generic :: create => create_set
      procedure :: copy_of
      procedure :: adopt
      procedure :: destroy
      procedure, private :: add_list_32, add_list_64, add_list_one_length_32, add_list_one_length_64
      procedure, private :: add_block_32, add_block_64, add_block_one_length_32, add_block_one_length_64
      ! add(atoms, lengths): one linear chain by its atoms. add(n_chains, n_bonds, first_atom, lengths): a block of them.
      generic :: add => add_list_32, add_list_64, add_list_one_length_32, add_list_one_length_64, &
         add_block_32, add_block_64, add_block_one_length_32, add_block_one_length_64
      procedure :: c_handle   ! for calls of the module holonomic_c
   end type

contains

   subroutine create_set(self, masses, stat, errmsg)
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

   subroutine add_list_64(self, atoms, lengths, stat, errmsg)
      class(chain_set), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: atoms(:)
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(c_int64_t) :: n_bonds
      call problem%need_created(self%handle)
      n_bonds = max(size(atoms, kind=c_int64_t) - 1, 0_c_int64_t)
      if (size(lengths, kind=c_int64_t) /= n_bonds) then
         call problem%set(HOL_ERR_VALUE, decimal(size(lengths, kind=c_int64_t))//" lengths were given for "// &
                          decimal(n_bonds)//" bonds")
      else if (n_bonds > 0) then
         call problem%ask(hol_chains_add(self%handle, n_bonds, c_loc(atoms), c_loc(lengths)))
      end if
      call settle(problem, "add", stat, errmsg)
   end subroutine

   subroutine add_list_32(self, atoms, lengths, stat, errmsg)
      class(chain_set), intent(inout) :: self
      integer(int32), intent(in) :: atoms(:)
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(int(atoms, int64), lengths, stat, errmsg)
   end subroutine

   subroutine add_list_one_length_64(self, atoms, lengths, stat, errmsg)
      class(chain_set), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: atoms(:)
      real(real64), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(atoms, repeated(lengths, size(atoms, kind=int64) - 1), stat, errmsg)
   end subroutine

   subroutine add_list_one_length_32(self, atoms, lengths, stat, errmsg)
      class(chain_set), intent(inout) :: self
      integer(int32), intent(in) :: atoms(:)
      real(real64), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(int(atoms, int64), repeated(lengths, size(atoms, kind=int64) - 1), stat, errmsg)
   end subroutine

   subroutine add_block_64(self, n_chains, n_bonds, first_atom, lengths, stat, errmsg)
      class(chain_set), intent(inout) :: self
      integer(int64), intent(in) :: n_chains, n_bonds, first_atom
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%handle)
      if (size(lengths, kind=int64) /= max(n_bonds, 0_int64)) then
         call problem%set(HOL_ERR_VALUE, decimal(size(lengths, kind=int64))//" lengths were given for "// &
                          decimal(n_bonds)//" bonds")
      else
         call problem%ask(hol_chains_add_block(self%handle, n_chains, n_bonds, first_atom, c_loc(lengths)))
      end if
      call settle(problem, "add", stat, errmsg)
   end subroutine

   subroutine add_block_32(self, n_chains, n_bonds, first_atom, lengths, stat, errmsg)
      class(chain_set), intent(inout) :: self
      integer(int32), intent(in) :: n_chains, n_bonds, first_atom
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(int(n_chains, int64), int(n_bonds, int64), int(first_atom, int64), lengths, stat, errmsg)
   end subroutine

   subroutine add_block_one_length_64(self, n_chains, n_bonds, first_atom, lengths, stat, errmsg)
      class(chain_set), intent(inout) :: self
      integer(int64), intent(in) :: n_chains, n_bonds, first_atom
      real(real64), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(n_chains, n_bonds, first_atom, repeated(lengths, n_bonds), stat, errmsg)
   end subroutine

   subroutine add_block_one_length_32(self, n_chains, n_bonds, first_atom, lengths, stat, errmsg)
      class(chain_set), intent(inout) :: self
      integer(int32), intent(in) :: n_chains, n_bonds, first_atom
      real(real64), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(int(n_chains, int64), int(n_bonds, int64), int(first_atom, int64), lengths, stat, errmsg)
   end subroutine

   pure recursive type(c_ptr) function c_handle(self)
      class(chain_set), intent(in) :: self
      c_handle = self%handle
   end function

   pure function repeated(length, n) result(lengths)
      real(real64), intent(in) :: length
      integer(int64), intent(in) :: n
      real(real64), allocatable :: lengths(:)
      allocate (lengths(max(n, 0_int64)), source=length)
   end function

end module
