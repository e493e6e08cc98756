! Options of the molecules, and what else of them a run may change between its steps.
module holonomic_settings
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_loc, c_null_ptr, c_ptr, c_signed_char
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   use holonomic_images, only: chain_set_images
   use holonomic_c, only: hol_chains_n_atoms, hol_chains_n_bonds, hol_chains_n_molecules, hol_chains_set_active, &
                          hol_chains_set_box, hol_chains_set_box_rate, hol_chains_set_checks, hol_chains_set_labels, &
                          hol_chains_set_lengths, hol_chains_set_masses, &
                          hol_chains_set_length_tolerance, hol_chains_set_max_iterations, &
                          hol_chains_set_memory_limit, hol_chains_set_reference_box, &
                          hol_chains_set_threads, hol_chains_set_tolerance, HOL_ERR_MEMORY
   use holonomic_place, only: enough, list_of, tensor
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_settings

   type, extends(chain_set_images) :: chain_set_settings
   contains
      procedure, private :: set_box_matrix, set_box_lengths, set_box_matrix_32, set_box_lengths_32
      generic :: set_box => set_box_matrix, set_box_lengths, set_box_matrix_32, set_box_lengths_32
      procedure, private :: set_reference_box_matrix, set_reference_box_lengths, set_reference_box_matrix_32, &
         set_reference_box_lengths_32
      generic :: set_reference_box => set_reference_box_matrix, set_reference_box_lengths, set_reference_box_matrix_32, &
         set_reference_box_lengths_32
      procedure, private :: set_box_rate_matrix, set_box_rate_32
      generic :: set_box_rate => set_box_rate_matrix, set_box_rate_32
      procedure, private :: set_checks_32, set_checks_64
      generic :: set_checks => set_checks_32, set_checks_64
      procedure, private :: set_labels_none, set_labels_32, set_labels_64
      generic :: set_labels => set_labels_none, set_labels_32, set_labels_64
      procedure :: set_threads
      procedure :: set_active
      procedure :: set_max_iterations
      ! Of 32 or 64 bits.
      procedure, private :: set_tolerance_32, set_tolerance_64, set_length_tolerance_32, set_length_tolerance_64
      procedure, private :: set_memory_limit_32, set_memory_limit_64
      procedure, private :: set_lengths_32, set_lengths_64, set_masses_32, set_masses_64
      generic :: set_tolerance => set_tolerance_32, set_tolerance_64
      generic :: set_length_tolerance => set_length_tolerance_32, set_length_tolerance_64
      generic :: set_memory_limit => set_memory_limit_32, set_memory_limit_64
      generic :: set_lengths => set_lengths_32, set_lengths_64
      generic :: set_masses => set_masses_32, set_masses_64
   end type

contains

   ! Column i is box vector i, or three edges; what is zero: not periodic along that axis. Without an argument: no box.
#define SET_MATRIX set_box_matrix
#define SET_MATRIX_32 set_box_matrix_32
#define SET_EDGES set_box_lengths
#define SET_EDGES_32 set_box_lengths_32
#define OF_C hol_chains_set_box
#define PROCEDURE_NAME "set_box"
#include "box.inc"
   ! Of the reference positions in project_positions. Without an argument: the same as that of set_box.
#define SET_MATRIX set_reference_box_matrix
#define SET_MATRIX_32 set_reference_box_matrix_32
#define SET_EDGES set_reference_box_lengths
#define SET_EDGES_32 set_reference_box_lengths_32
#define OF_C hol_chains_set_reference_box
#define PROCEDURE_NAME "set_reference_box"
#include "box.inc"
   pure function orthorhombic(lengths) result(box)
      real(real64), intent(in) :: lengths(3)
      real(real64) :: box(3, 3)
      integer :: i
      box = 0
      do i = 1, 3
         box(i, i) = lengths(i)
      end do
   end function

   ! d(box)/dt = matmul(L, box) and r' = v + matmul(L, r). Without an argument: none.
   subroutine set_box_rate_matrix(self, L, stat, errmsg)
      class(chain_set_settings), intent(inout) :: self
      real(real64), intent(in), optional :: L(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      real(real64), target :: rows(3, 3)  ! as C has them
      type(failure) :: problem
      rows = 0
      if (present(L)) rows = transpose(L)
      call problem%need_created(self%c_handle())
      call problem%ask(hol_chains_set_box_rate(self%c_handle(), tensor(rows)))
      call settle(problem, "set_box_rate", stat, errmsg)
   end subroutine

   subroutine set_box_rate_32(self, L, stat, errmsg)
      class(chain_set_settings), intent(inout) :: self
      real(real32), intent(in) :: L(3, 3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      call self%set_box_rate(real(L, real64), stat, errmsg)
   end subroutine

   ! Numbers of atoms and molecules for messages; of size 0 or absent: none.
   subroutine set_labels_64(self, atoms, molecules, stat, errmsg)
      class(chain_set_settings), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: atoms(:)
      integer(int64), intent(in), optional, contiguous, target :: molecules(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(c_ptr) :: at_atoms, at_molecules
      call problem%need_created(self%c_handle())
      at_atoms = labels_of(atoms, "atoms", hol_chains_n_atoms(self%c_handle()), problem)
      at_molecules = labels_of(molecules, "molecules", hol_chains_n_molecules(self%c_handle()), problem)
      if (problem%none()) call problem%ask(hol_chains_set_labels(self%c_handle(), at_atoms, at_molecules))
      call settle(problem, "set_labels", stat, errmsg)
   end subroutine

   subroutine set_labels_32(self, atoms, molecules, stat, errmsg)
      class(chain_set_settings), intent(inout) :: self
      integer(int32), intent(in) :: atoms(:)
      integer(int32), intent(in), optional :: molecules(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      if (present(molecules)) then
         call self%set_labels_64(int(atoms, int64), int(molecules, int64), stat=stat, errmsg=errmsg)
      else
         call self%set_labels_64(int(atoms, int64), stat=stat, errmsg=errmsg)
      end if
   end subroutine

   subroutine set_labels_none(self, stat, errmsg)
      class(chain_set_settings), intent(inout) :: self
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(int64) :: no_labels(0)
      call self%set_labels_64(no_labels, stat=stat, errmsg=errmsg)
   end subroutine

   type(c_ptr) function labels_of(labels, name, needed, problem)
      integer(int64), optional, contiguous, target :: labels(:)
      character(*), intent(in) :: name
      integer(c_int64_t), intent(in) :: needed
      type(failure), intent(inout) :: problem
      labels_of = c_null_ptr
      if (.not. present(labels)) return
      if (size(labels) == 0) return
      if (enough("the list of labels", size(labels, kind=c_int64_t), needed, name, problem)) labels_of = c_loc(labels)
   end function

   subroutine set_threads(self, n_threads, stat, errmsg)
      class(chain_set_settings), intent(inout) :: self
      integer, intent(in) :: n_threads
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      call problem%ask(hol_chains_set_threads(self%c_handle(), int(n_threads, c_int)))
      call settle(problem, "set_threads", stat, errmsg)
   end subroutine

   ! Without an argument all molecules are active.
   subroutine set_active(self, active, stat, errmsg)
      class(chain_set_settings), intent(inout) :: self
      logical, intent(in), optional :: active(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(c_signed_char), allocatable, target :: flags(:)
      type(failure) :: problem
      integer :: trouble
      call problem%need_created(self%c_handle())
      if (.not. present(active)) then
         call problem%ask(hol_chains_set_active(self%c_handle(), c_null_ptr))
      else if (enough("active", size(active, kind=c_int64_t), hol_chains_n_molecules(self%c_handle()), "molecules", problem)) then
         allocate (flags(max(1, size(active))), stat=trouble)
         if (trouble /= 0) then
            call problem%set(HOL_ERR_MEMORY, "out of memory")
         else
            flags(:size(active)) = merge(1_c_signed_char, 0_c_signed_char, active)
            call problem%ask(hol_chains_set_active(self%c_handle(), c_loc(flags)))
         end if
      end if
      call settle(problem, "set_active", stat, errmsg)
   end subroutine

#define INTEGERS 32
#define REALS 32
#define SET_CHECKS set_checks_32
#define SET_TOLERANCE set_tolerance_32
#define SET_LENGTH_TOLERANCE set_length_tolerance_32
#define SET_MEMORY_LIMIT set_memory_limit_32
#define SET_LENGTHS set_lengths_32
#define SET_MASSES set_masses_32
#include "settings.inc"
#define INTEGERS 64
#define REALS 64
#define SET_CHECKS set_checks_64
#define SET_TOLERANCE set_tolerance_64
#define SET_LENGTH_TOLERANCE set_length_tolerance_64
#define SET_MEMORY_LIMIT set_memory_limit_64
#define SET_LENGTHS set_lengths_64
#define SET_MASSES set_masses_64
#include "settings.inc"

   subroutine set_max_iterations(self, max_iterations, stat, errmsg)
      class(chain_set_settings), intent(inout) :: self
      integer, intent(in) :: max_iterations
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      call problem%ask(hol_chains_set_max_iterations(self%c_handle(), int(max_iterations, c_int)))
      call settle(problem, "set_max_iterations", stat, errmsg)
   end subroutine

   subroutine set_lengths_of(self, lengths, stat, errmsg)
      class(chain_set_settings), intent(inout) :: self
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(c_ptr) :: at_lengths
      call problem%need_created(self%c_handle())
      at_lengths = list_of(lengths, "lengths", hol_chains_n_bonds(self%c_handle()), "bonds", problem)
      if (problem%none()) call problem%ask(hol_chains_set_lengths(self%c_handle(), at_lengths))
      call settle(problem, "set_lengths", stat, errmsg)
   end subroutine

   subroutine set_masses_of(self, masses, stat, errmsg)
      class(chain_set_settings), intent(inout) :: self
      real(real64), intent(in), contiguous, target :: masses(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(c_ptr) :: at_masses
      call problem%need_created(self%c_handle())
      at_masses = list_of(masses, "masses", hol_chains_n_atoms(self%c_handle()), "atoms", problem)
      if (problem%none()) call problem%ask(hol_chains_set_masses(self%c_handle(), at_masses))
      call settle(problem, "set_masses", stat, errmsg)
   end subroutine

end module
