! Linear relations among atoms, sum c_i r_i = 0: sites by a base, atoms that are one point, centroids. Each procedure takes
! default or 64-bit integers.
module holonomic_linear
   use, intrinsic :: iso_c_binding, only: c_int64_t, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int32, int64, real64
   use holonomic_c, only: hol_chains_add_linear, hol_chains_add_linear_molecules, HOL_ERR_VALUE
   use holonomic_rigid, only: chain_set_rigid
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: chain_set_linear

   type, extends(chain_set_rigid) :: chain_set_linear
   contains
      procedure, private :: add_linear_32, add_linear_64, add_linear_molecules_32, add_linear_molecules_64
      ! add_linear(atoms, coefficients, [sizes], [bonds, lengths]): a relation among these atoms, whose coefficients add up
      ! to 0; with sizes several, one after the other. bonds(2, n_bonds) are those of the molecules that relations make.
      generic :: add_linear => add_linear_32, add_linear_64
      ! add_linear_molecules(n_molecules, n_atoms, first_atom, atoms, coefficients, [sizes], [bonds, lengths]): the same in
      ! each of these molecules, whose atoms are counted from 1.
      generic :: add_linear_molecules => add_linear_molecules_32, add_linear_molecules_64
   end type

contains

   subroutine add_linear_64(self, atoms, coefficients, sizes, bonds, lengths, stat, errmsg)
      class(chain_set_linear), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: atoms(:)
      real(real64), intent(in), contiguous, target :: coefficients(:)
      integer(int64), intent(in), optional :: sizes(:)
      integer(int64), intent(in), contiguous, optional, target :: bonds(:, :)
      real(real64), intent(in), contiguous, optional, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(int64), allocatable, target :: relations(:)
      type(failure) :: problem
      type(c_ptr) :: pairs, of_pairs
      integer(c_int64_t) :: n_bonds
      call problem%need_created(self%c_handle())
      call take_relations(atoms, coefficients, sizes, bonds, lengths, relations, n_bonds, pairs, of_pairs, problem)
      if (problem%none()) &
         call problem%ask(hol_chains_add_linear(self%c_handle(), size(relations, kind=c_int64_t), c_loc(relations), &
                                                c_loc(atoms), c_loc(coefficients), n_bonds, pairs, of_pairs))
      call settle(problem, "add_linear", stat, errmsg)
   end subroutine

   subroutine add_linear_molecules_64(self, n_molecules, n_atoms, first_atom, atoms, coefficients, sizes, bonds, lengths, &
                                      stat, errmsg)
      class(chain_set_linear), intent(inout) :: self
      integer(int64), intent(in) :: n_molecules, n_atoms, first_atom
      integer(int64), intent(in), contiguous, target :: atoms(:)
      real(real64), intent(in), contiguous, target :: coefficients(:)
      integer(int64), intent(in), optional :: sizes(:)
      integer(int64), intent(in), contiguous, optional, target :: bonds(:, :)
      real(real64), intent(in), contiguous, optional, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(int64), allocatable, target :: relations(:)
      type(failure) :: problem
      type(c_ptr) :: pairs, of_pairs
      integer(c_int64_t) :: n_bonds
      call problem%need_created(self%c_handle())
      call take_relations(atoms, coefficients, sizes, bonds, lengths, relations, n_bonds, pairs, of_pairs, problem)
      if (problem%none()) &
         call problem%ask(hol_chains_add_linear_molecules(self%c_handle(), n_molecules, n_atoms, first_atom, &
                                                          size(relations, kind=c_int64_t), c_loc(relations), c_loc(atoms), &
                                                          c_loc(coefficients), n_bonds, pairs, of_pairs))
      call settle(problem, "add_linear_molecules", stat, errmsg)
   end subroutine

   subroutine take_relations(atoms, coefficients, sizes, bonds, lengths, relations, n_bonds, pairs, of_pairs, problem)
      integer(int64), intent(in) :: atoms(:)
      real(real64), intent(in) :: coefficients(:)
      integer(int64), intent(in), optional :: sizes(:)
      integer(int64), intent(in), contiguous, optional, target :: bonds(:, :)
      real(real64), intent(in), contiguous, optional, target :: lengths(:)
      integer(int64), allocatable, intent(out) :: relations(:)
      integer(c_int64_t), intent(out) :: n_bonds
      type(c_ptr), intent(out) :: pairs, of_pairs
      type(failure), intent(inout) :: problem
      if (present(sizes)) then
         allocate (relations, source=sizes)
      else
         allocate (relations, source=[size(atoms, kind=int64)])
      end if
      n_bonds = 0
      pairs = c_null_ptr
      of_pairs = c_null_ptr
      if (size(coefficients) /= size(atoms) .or. sum(relations) /= size(atoms)) then
         call problem%set(HOL_ERR_VALUE, decimal(size(coefficients, kind=c_int64_t))//" coefficients were given, and sizes "// &
                          "that add up to "//decimal(sum(relations))//", for "// &
                          decimal(size(atoms, kind=c_int64_t))//" atoms")
      else if (present(bonds) .neqv. present(lengths)) then
         call problem%set(HOL_ERR_VALUE, "bonds and lengths must be given together")
      else if (present(bonds)) then
         if (size(bonds, 1) /= 2 .or. size(bonds, 2) /= size(lengths)) then
            call problem%set(HOL_ERR_VALUE, "bonds must be (2, "//decimal(size(lengths, kind=c_int64_t))//")")
         else if (size(lengths) > 0) then
            n_bonds = size(bonds, 2, c_int64_t)
            pairs = c_loc(bonds)
            of_pairs = c_loc(lengths)
         end if
      end if
   end subroutine

   subroutine add_linear_32(self, atoms, coefficients, sizes, bonds, lengths, stat, errmsg)
      class(chain_set_linear), intent(inout) :: self
      integer(int32), intent(in) :: atoms(:)
      real(real64), intent(in), contiguous, target :: coefficients(:)
      integer(int32), intent(in), optional :: sizes(:), bonds(:, :)
      real(real64), intent(in), contiguous, optional, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(int64), allocatable :: relations(:), pairs(:, :)
      if (present(sizes)) allocate (relations, source=int(sizes, int64))
      if (present(bonds)) allocate (pairs, source=int(bonds, int64))
      call self%add_linear(int(atoms, int64), coefficients, relations, pairs, lengths, stat, errmsg) ! unallocated: absent
   end subroutine

   subroutine add_linear_molecules_32(self, n_molecules, n_atoms, first_atom, atoms, coefficients, sizes, bonds, lengths, &
                                      stat, errmsg)
      class(chain_set_linear), intent(inout) :: self
      integer(int32), intent(in) :: n_molecules, n_atoms, first_atom, atoms(:)
      real(real64), intent(in), contiguous, target :: coefficients(:)
      integer(int32), intent(in), optional :: sizes(:), bonds(:, :)
      real(real64), intent(in), contiguous, optional, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(int64), allocatable :: relations(:), pairs(:, :)
      if (present(sizes)) allocate (relations, source=int(sizes, int64))
      if (present(bonds)) allocate (pairs, source=int(bonds, int64))
      call self%add_linear_molecules(int(n_molecules, int64), int(n_atoms, int64), int(first_atom, int64), &
                                     int(atoms, int64), coefficients, relations, pairs, lengths, stat, errmsg)
   end subroutine

end module
