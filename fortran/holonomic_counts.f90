! What the chains consist of.
module holonomic_counts
   use, intrinsic :: iso_c_binding, only: c_int, c_loc
   use, intrinsic :: iso_fortran_env, only: int64
   use holonomic_c, only: hol_chains_atoms, hol_chains_degrees_of_freedom, hol_chains_memory, hol_chains_n_atoms, &
                          hol_chains_n_bonds, hol_chains_n_chains, hol_chains_offsets, HOL_ERR_MEMORY
   use holonomic_place, only: enough
   use holonomic_settings, only: chain_set_settings
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_counts

   type, extends(chain_set_settings) :: chain_set_counts
   contains
      procedure :: n_atoms
      procedure :: n_chains
      procedure :: n_bonds
      procedure :: degrees_of_freedom
      procedure :: memory
      procedure :: offsets
      procedure :: atoms
   end type

contains

   pure recursive integer(int64) function n_atoms(self)
      class(chain_set_counts), intent(in) :: self
      n_atoms = hol_chains_n_atoms(self%c_handle())
   end function

   pure recursive integer(int64) function n_chains(self)
      class(chain_set_counts), intent(in) :: self
      n_chains = hol_chains_n_chains(self%c_handle())
   end function

   pure recursive integer(int64) function n_bonds(self)
      class(chain_set_counts), intent(in) :: self
      n_bonds = hol_chains_n_bonds(self%c_handle())
   end function

   ! Of all atoms; three dimensions by default. A conserved total momentum is not subtracted.
   pure recursive integer(int64) function degrees_of_freedom(self, dimensions)
      class(chain_set_counts), intent(in) :: self
      integer, intent(in), optional :: dimensions
      integer(c_int) :: d
      d = 3
      if (present(dimensions)) d = int(dimensions, c_int)
      degrees_of_freedom = hol_chains_degrees_of_freedom(self%c_handle(), d)
   end function

   ! Bytes that the chains occupy.
   pure recursive integer(int64) function memory(self)
      class(chain_set_counts), intent(in) :: self
      memory = hol_chains_memory(self%c_handle())
   end function

   ! first_bond(n_chains + 1): chain c has the bonds first_bond(c) .. first_bond(c + 1) - 1 of arrays per bond.
   recursive subroutine offsets(self, first_bond, stat, errmsg)
      class(chain_set_counts), intent(in) :: self
      integer(int64), intent(inout), contiguous, target :: first_bond(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (enough("offsets", size(first_bond, kind=int64), self%n_chains() + 1, "chains and the end", problem)) &
         call problem%ask(hol_chains_offsets(self%c_handle(), c_loc(first_bond)))
      call settle(problem, "offsets", stat, errmsg)
   end subroutine

   ! list(n_bonds + n_chains): the atoms of all chains, chain after chain, each in order. Chain c begins at element
   ! first_bond(c) + c - 1.
   recursive subroutine atoms(self, list, stat, errmsg)
      class(chain_set_counts), intent(in) :: self
      integer(int64), intent(inout), contiguous, target :: list(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(int64), allocatable, target :: first_bond(:)
      integer(int64) :: chain
      integer :: trouble
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (enough("atoms", size(list, kind=int64), self%n_bonds() + self%n_chains(), "atoms", problem)) then
         allocate (first_bond(self%n_chains() + 1), stat=trouble)
         if (trouble /= 0) then
            call problem%set(HOL_ERR_MEMORY, "out of memory")
         else
            call problem%ask(hol_chains_offsets(self%c_handle(), c_loc(first_bond)))
            do chain = 1, self%n_chains()
               if (problem%none()) call problem%ask(hol_chains_atoms(self%c_handle(), chain, &
                                                                      c_loc(list(first_bond(chain) + chain - 1))))
            end do
         end if
      end if
      call settle(problem, "atoms", stat, errmsg)
   end subroutine

end module
