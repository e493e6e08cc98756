! What a call has done with each molecule.
module holonomic_outcomes
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   use holonomic_c, only: hol_chains_set_outcomes, hol_outcomes
   use holonomic_impose, only: chain_set_impose
   use holonomic_place, only: enough
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: chain_set_outcomes

   type, extends(chain_set_impose) :: chain_set_outcomes
   contains
      procedure :: set_outcomes
      procedure, private :: outcomes_32, outcomes_64
      generic :: outcomes => outcomes_32, outcomes_64
   end type

contains

   subroutine set_outcomes(self, keep, stat, errmsg)
      class(chain_set_outcomes), intent(inout) :: self
      logical, intent(in) :: keep
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      call problem%ask(hol_chains_set_outcomes(self%c_handle(), merge(1_c_int, 0_c_int, keep)))
      call settle(problem, "set_outcomes", stat, errmsg)
   end subroutine

   ! Of each molecule, in this thread's last call: a status as `stat`, and the number of iterations.
   recursive subroutine outcomes_32(self, status, iterations, stat, errmsg)
      class(chain_set_outcomes), intent(in) :: self
      integer(c_int), intent(inout), optional, contiguous, target :: status(:), iterations(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(c_ptr) :: to_status, to_iterations
      call problem%need_created(self%c_handle())
      to_status = c_null_ptr
      to_iterations = c_null_ptr
      if (present(status)) then
         if (enough("status", size(status, kind=c_int64_t), self%n_molecules(), "molecules", problem)) &
            to_status = c_loc(status)
      end if
      if (present(iterations)) then
         if (enough("iterations", size(iterations, kind=c_int64_t), self%n_molecules(), "molecules", problem)) &
            to_iterations = c_loc(iterations)
      end if
      if (problem%none()) call problem%ask(hol_outcomes(self%c_handle(), to_status, to_iterations))
      call settle(problem, "outcomes", stat, errmsg)
   end subroutine

   ! For programs whose default integers have eight bytes.
   recursive subroutine outcomes_64(self, status, iterations, stat, errmsg)
      class(chain_set_outcomes), intent(in) :: self
      integer(c_int64_t), intent(inout) :: status(:)
      integer(c_int64_t), intent(inout), optional :: iterations(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(c_int), allocatable :: short(:), rounds(:)
      integer :: own
      allocate (short(size(status)), source=int(status, c_int))
      allocate (rounds(self%n_molecules()), source=0_c_int)
      if (present(iterations)) then
         if (size(iterations) < size(rounds)) rounds = rounds(:size(iterations))
      end if
      if (present(stat)) then
         call self%outcomes_32(short, rounds, own, errmsg)
         stat = own
         if (own /= 0) return
      else
         call self%outcomes_32(short, rounds)
      end if
      status = short
      if (present(iterations)) iterations(:size(rounds)) = rounds
   end subroutine

end module
