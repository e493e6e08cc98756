! The same with masses, lengths and boxes of single precision, as codes have them that keep all numbers in default reals: they
! are converted. Arrays per atom of the verbs are taken in single precision by these themselves.
module holonomic_single
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   use holonomic_given, only: chain_set_given
   implicit none
   private
   public :: chain_set_single

   type, extends(chain_set_given) :: chain_set_single
   contains
      procedure, private :: single_add_list_32, single_add_block_32, single_add_bonds_32, &
         single_add_list_one_length_32, single_add_block_one_length_32, single_add_bonds_one_length_32, &
         single_add_list_64, single_add_block_64, single_add_bonds_64, &
         single_add_list_one_length_64, single_add_block_one_length_64, single_add_bonds_one_length_64
      generic :: add => single_add_list_32, single_add_block_32, single_add_bonds_32, &
         single_add_list_one_length_32, single_add_block_one_length_32, single_add_bonds_one_length_32, &
         single_add_list_64, single_add_block_64, single_add_bonds_64, &
         single_add_list_one_length_64, single_add_block_one_length_64, single_add_bonds_one_length_64
      procedure, private :: single_add_molecules_32, single_add_molecules_one_length_32, single_add_molecules_64, &
         single_add_molecules_one_length_64
      generic :: add_molecules => single_add_molecules_32, single_add_molecules_one_length_32, single_add_molecules_64, &
         single_add_molecules_one_length_64
      procedure, private :: single_set_lengths_short
      generic :: set_lengths => single_set_lengths_short
      procedure, private :: single_set_masses_short
      generic :: set_masses => single_set_masses_short
      procedure, private :: single_set_box_matrix_short, single_set_box_lengths_short
      generic :: set_box => single_set_box_matrix_short, single_set_box_lengths_short
      procedure, private :: single_set_reference_box_matrix_short, single_set_reference_box_lengths_short
      generic :: set_reference_box => single_set_reference_box_matrix_short, single_set_reference_box_lengths_short
      procedure, private :: single_set_box_rate_short
      generic :: set_box_rate => single_set_box_rate_short
      procedure, private :: single_set_tolerance_short
      generic :: set_tolerance => single_set_tolerance_short
      procedure, private :: single_create
      generic :: create => single_create
   end type

contains

   subroutine single_add_list_32(self, atoms, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int32), intent(in) :: atoms(:)
      real(real32), intent(in) :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(atoms, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_block_32(self, n_chains, n_bonds, first_atom, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int32), intent(in) :: n_chains, n_bonds, first_atom
      real(real32), intent(in) :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(n_chains, n_bonds, first_atom, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_bonds_32(self, bonds, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int32), intent(in) :: bonds(:, :)
      real(real32), intent(in) :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(bonds, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_molecules_32(self, n_molecules, n_atoms, first_atom, bonds, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int32), intent(in) :: n_molecules, n_atoms, first_atom
      integer(int32), intent(in) :: bonds(:, :)
      real(real32), intent(in) :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add_molecules(n_molecules, n_atoms, first_atom, bonds, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_list_one_length_32(self, atoms, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int32), intent(in) :: atoms(:)
      real(real32), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(atoms, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_block_one_length_32(self, n_chains, n_bonds, first_atom, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int32), intent(in) :: n_chains, n_bonds, first_atom
      real(real32), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(n_chains, n_bonds, first_atom, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_bonds_one_length_32(self, bonds, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int32), intent(in) :: bonds(:, :)
      real(real32), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(bonds, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_molecules_one_length_32(self, n_molecules, n_atoms, first_atom, bonds, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int32), intent(in) :: n_molecules, n_atoms, first_atom
      integer(int32), intent(in) :: bonds(:, :)
      real(real32), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add_molecules(n_molecules, n_atoms, first_atom, bonds, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_list_64(self, atoms, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int64), intent(in) :: atoms(:)
      real(real32), intent(in) :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(atoms, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_block_64(self, n_chains, n_bonds, first_atom, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int64), intent(in) :: n_chains, n_bonds, first_atom
      real(real32), intent(in) :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(n_chains, n_bonds, first_atom, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_bonds_64(self, bonds, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int64), intent(in) :: bonds(:, :)
      real(real32), intent(in) :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(bonds, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_molecules_64(self, n_molecules, n_atoms, first_atom, bonds, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int64), intent(in) :: n_molecules, n_atoms, first_atom
      integer(int64), intent(in) :: bonds(:, :)
      real(real32), intent(in) :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add_molecules(n_molecules, n_atoms, first_atom, bonds, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_list_one_length_64(self, atoms, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int64), intent(in) :: atoms(:)
      real(real32), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(atoms, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_block_one_length_64(self, n_chains, n_bonds, first_atom, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int64), intent(in) :: n_chains, n_bonds, first_atom
      real(real32), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(n_chains, n_bonds, first_atom, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_bonds_one_length_64(self, bonds, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int64), intent(in) :: bonds(:, :)
      real(real32), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add(bonds, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_add_molecules_one_length_64(self, n_molecules, n_atoms, first_atom, bonds, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      integer(int64), intent(in) :: n_molecules, n_atoms, first_atom
      integer(int64), intent(in) :: bonds(:, :)
      real(real32), intent(in) :: lengths
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%add_molecules(n_molecules, n_atoms, first_atom, bonds, real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_set_lengths_short(self, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      real(real32), intent(in) :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%set_lengths(real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_set_masses_short(self, masses, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      real(real32), intent(in) :: masses(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%set_masses(real(masses, real64), stat, errmsg)
   end subroutine

   subroutine single_set_box_matrix_short(self, box, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      real(real32), intent(in) :: box(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%set_box(real(box, real64), stat, errmsg)
   end subroutine

   subroutine single_set_box_lengths_short(self, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      real(real32), intent(in) :: lengths(3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%set_box(real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_set_reference_box_matrix_short(self, box, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      real(real32), intent(in) :: box(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%set_reference_box(real(box, real64), stat, errmsg)
   end subroutine

   subroutine single_set_reference_box_lengths_short(self, lengths, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      real(real32), intent(in) :: lengths(3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%set_reference_box(real(lengths, real64), stat, errmsg)
   end subroutine

   subroutine single_set_box_rate_short(self, L, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      real(real32), intent(in) :: L(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%set_box_rate(real(L, real64), stat, errmsg)
   end subroutine

   subroutine single_set_tolerance_short(self, tolerance, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      real(real32), intent(in) :: tolerance
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%set_tolerance(real(tolerance, real64), stat, errmsg)
   end subroutine

   subroutine single_create(self, masses, stat, errmsg)
      class(chain_set_single), intent(inout) :: self
      real(real32), intent(in) :: masses(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%create(real(masses, real64), stat, errmsg)
   end subroutine

end module
