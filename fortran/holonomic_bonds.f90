! Molecules of any shape by their bonds: the library finds what holds together. Each procedure takes default or 64-bit
! integers, and the length of each bond or one for all.
module holonomic_bonds
   use, intrinsic :: iso_c_binding, only: c_int64_t, c_loc
   use, intrinsic :: iso_fortran_env, only: int32, int64, real64
   use holonomic_c, only: hol_chains_add_bonds, hol_chains_add_molecules, HOL_ERR_VALUE
   use holonomic_chains, only: chain_set, repeated
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: chain_set_bonds

   type, extends(chain_set) :: chain_set_bonds
   contains
      procedure, private :: add_bonds_32, add_bonds_64, add_bonds_one_length_32, add_bonds_one_length_64
      procedure, private :: add_molecules_32, add_molecules_64, add_molecules_one_length_32, add_molecules_one_length_64
      ! add(bonds, lengths): bonds(2, n_bonds), the two atoms of each.
      generic :: add => add_bonds_32, add_bonds_64, add_bonds_one_length_32, add_bonds_one_length_64
      ! add_molecules(n_molecules, n_atoms, first_atom, bonds, lengths): the same bonds in each of n_molecules molecules
      ! of n_atoms consecutive atoms; bonds(2, n_bonds) are counted within the molecule.
      generic :: add_molecules => add_molecules_32, add_molecules_64, add_molecules_one_length_32, &
         add_molecules_one_length_64
   end type

contains

   ! Whether these are bonds with a length each; if not, `problem` says why.
   logical function sizes_agree(bonds, lengths, problem)
      integer(int64), intent(in) :: bonds(:, :)
      real(real64), intent(in) :: lengths(:)
      type(failure), intent(inout) :: problem
      if (size(bonds, 1) /= 2) then
         call problem%set(HOL_ERR_VALUE, "the first dimension of bonds must be 2, not "// &
                          decimal(size(bonds, 1, c_int64_t)))
      else if (size(lengths) /= size(bonds, 2)) then
         call problem%set(HOL_ERR_VALUE, decimal(size(lengths, kind=c_int64_t))//" lengths were given for "// &
                          decimal(size(bonds, 2, c_int64_t))//" bonds")
      end if
      sizes_agree = problem%none()
   end function

   subroutine add_bonds_64(self, bonds, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: bonds(:, :)
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (sizes_agree(bonds, lengths, problem)) &
         call problem%ask(hol_chains_add_bonds(self%c_handle(), size(bonds, 2, c_int64_t), c_loc(bonds), &
                                               c_loc(lengths)))
      call settle(problem, "add", stat, errmsg)
   end subroutine

   subroutine add_bonds_32(self, bonds, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int32), intent(in) :: bonds(:, :)
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(int(bonds, int64), lengths, stat, errmsg)
   end subroutine

   subroutine add_bonds_one_length_64(self, bonds, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: bonds(:, :)
      real(real64), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(bonds, repeated(lengths, size(bonds, 2, int64)), stat, errmsg)
   end subroutine

   subroutine add_bonds_one_length_32(self, bonds, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int32), intent(in) :: bonds(:, :)
      real(real64), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(int(bonds, int64), repeated(lengths, size(bonds, 2, int64)), stat, errmsg)
   end subroutine

   subroutine add_molecules_64(self, n_molecules, n_atoms, first_atom, bonds, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int64), intent(in) :: n_molecules, n_atoms, first_atom
      integer(int64), intent(in), contiguous, target :: bonds(:, :)
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (sizes_agree(bonds, lengths, problem)) &
         call problem%ask(hol_chains_add_molecules(self%c_handle(), n_molecules, n_atoms, first_atom, &
                                                   size(bonds, 2, c_int64_t), c_loc(bonds), c_loc(lengths)))
      call settle(problem, "add_molecules", stat, errmsg)
   end subroutine

   subroutine add_molecules_32(self, n_molecules, n_atoms, first_atom, bonds, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int32), intent(in) :: n_molecules, n_atoms, first_atom
      integer(int32), intent(in) :: bonds(:, :)
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add_molecules(int(n_molecules, int64), int(n_atoms, int64), int(first_atom, int64), int(bonds, int64), &
                              lengths, stat, errmsg)
   end subroutine

   subroutine add_molecules_one_length_64(self, n_molecules, n_atoms, first_atom, bonds, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int64), intent(in) :: n_molecules, n_atoms, first_atom
      integer(int64), intent(in), contiguous, target :: bonds(:, :)
      real(real64), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add_molecules(n_molecules, n_atoms, first_atom, bonds, repeated(lengths, size(bonds, 2, int64)), stat, &
                              errmsg)
   end subroutine

   subroutine add_molecules_one_length_32(self, n_molecules, n_atoms, first_atom, bonds, lengths, stat, errmsg)
      class(chain_set_bonds), intent(inout) :: self
      integer(int32), intent(in) :: n_molecules, n_atoms, first_atom
      integer(int32), intent(in) :: bonds(:, :)
      real(real64), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add_molecules(int(n_molecules, int64), int(n_atoms, int64), int(first_atom, int64), int(bonds, int64), &
                              repeated(lengths, size(bonds, 2, int64)), stat, errmsg)
   end subroutine

end module
