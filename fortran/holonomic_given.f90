! A set as it was given: copies of it, its bonds, lengths, masses and boxes, and what became of each bond.
module holonomic_given
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use holonomic_c, only: hol_chains_box, hol_chains_lengths, hol_chains_masses, hol_chains_pairs, hol_chains_roles, &
                          hol_chains_set_bodies, hol_chains_set_length, HOL_BOX, HOL_ERR_VALUE, HOL_REFERENCE_BOX
   use holonomic_counts, only: chain_set_counts
   use holonomic_place, only: enough, list_of, tensor
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_given

   type, extends(chain_set_counts) :: chain_set_given
   contains
      procedure :: set_bodies
      procedure :: set_length
      procedure :: bond_pairs
      procedure :: bond_lengths
      procedure :: atom_masses
      procedure :: box
      procedure, private :: roles_alone, roles_and_removed
      generic :: roles => roles_alone, roles_and_removed
   end type

contains

   ! HOL_BODIES_FOUND (the default) or HOL_BODIES_GIVEN: whether distances that depend on each other become bodies.
   subroutine set_bodies(self, which, stat, errmsg)
      class(chain_set_given), intent(inout) :: self
      integer, intent(in) :: which
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (problem%none()) call problem%ask(hol_chains_set_bodies(self%c_handle(), int(which, c_int)))
      call settle(problem, "set_bodies", stat, errmsg)
   end subroutine

   ! A new length of one bond, by its number in the arrays per bond.
   subroutine set_length(self, bond, length, stat, errmsg)
      class(chain_set_given), intent(inout) :: self
      integer, intent(in) :: bond
      real(real64), intent(in) :: length
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (problem%none()) call problem%ask(hol_chains_set_length(self%c_handle(), int(bond, c_int64_t), length))
      call settle(problem, "set_length", stat, errmsg)
   end subroutine

   ! The two atoms of every bond, pairs(2, n_bonds).
   subroutine bond_pairs(self, pairs, stat, errmsg)
      class(chain_set_given), intent(in) :: self
      integer(int64), intent(inout), contiguous, target :: pairs(:, :)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (size(pairs, 1) /= 2) call problem%set(HOL_ERR_VALUE, "the array of pairs must be (2, n_bonds)")
      if (enough("pairs", size(pairs, 2, c_int64_t), self%n_bonds(), "bonds", problem) .and. problem%none()) then
         if (size(pairs) > 0) call problem%ask(hol_chains_pairs(self%c_handle(), c_loc(pairs)))
      end if
      call settle(problem, "bond_pairs", stat, errmsg)
   end subroutine

   subroutine bond_lengths(self, lengths, stat, errmsg)
      class(chain_set_given), intent(in) :: self
      real(real64), intent(inout), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(c_ptr) :: at_lengths
      call problem%need_created(self%c_handle())
      at_lengths = list_of(lengths, "lengths", self%n_bonds(), "bonds", problem)
      if (problem%none()) call problem%ask(hol_chains_lengths(self%c_handle(), at_lengths))
      call settle(problem, "bond_lengths", stat, errmsg)
   end subroutine

   subroutine atom_masses(self, masses, stat, errmsg)
      class(chain_set_given), intent(in) :: self
      real(real64), intent(inout), contiguous, target :: masses(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(c_ptr) :: at_masses
      call problem%need_created(self%c_handle())
      at_masses = list_of(masses, "masses", self%n_atoms(), "atoms", problem)
      if (problem%none()) call problem%ask(hol_chains_masses(self%c_handle(), at_masses))
      call settle(problem, "atom_masses", stat, errmsg)
   end subroutine

   ! The box, or that of the reference, as it was given: column i is box vector i, zeros if there is none.
   subroutine box(self, vectors, reference, stat, errmsg)
      class(chain_set_given), intent(in) :: self
      real(real64), intent(inout), target :: vectors(3, 3)
      logical, intent(in), optional :: reference
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(kind(HOL_BOX)) :: which
      call problem%need_created(self%c_handle())
      which = HOL_BOX
      if (present(reference)) which = merge(HOL_REFERENCE_BOX, HOL_BOX, reference)
      if (problem%none()) call problem%ask(hol_chains_box(self%c_handle(), which, tensor(vectors)))
      call settle(problem, "box", stat, errmsg)
   end subroutine

   ! HOL_ROLE_.. of every bond, and how many freedoms the constraints of each molecule remove.
   subroutine roles_and_removed(self, roles, removed, stat, errmsg)
      class(chain_set_given), intent(in) :: self
      integer, intent(inout) :: roles(:)
      integer(int64), intent(inout), contiguous, target :: removed(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(c_int), allocatable, target :: found(:)
      call problem%need_created(self%c_handle())
      if (enough("roles", size(roles, kind=c_int64_t), self%n_bonds(), "bonds", problem) .and. &
          enough("removed", size(removed, kind=c_int64_t), self%n_molecules(), "molecules", problem) .and. &
          problem%none()) then
         allocate (found(max(1_c_int64_t, self%n_bonds())))
         call problem%ask(hol_chains_roles(self%c_handle(), c_loc(found), at(removed)))
         if (problem%none()) roles(:self%n_bonds()) = found(:self%n_bonds())
      end if
      call settle(problem, "roles", stat, errmsg)
   end subroutine

   subroutine roles_alone(self, roles, stat, errmsg)
      class(chain_set_given), intent(in) :: self
      integer, intent(inout) :: roles(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(int64), allocatable :: removed(:)
      allocate (removed(self%n_molecules()))
      call self%roles_and_removed(roles, removed, stat, errmsg)
   end subroutine

   type(c_ptr) function at(list)
      integer(int64), intent(inout), contiguous, target :: list(:)
      at = c_null_ptr
      if (size(list) > 0) at = c_loc(list)
   end function

end module
