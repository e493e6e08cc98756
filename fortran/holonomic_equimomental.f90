! Mass points in place of a rigid body that is given by its inertia tensor.
module holonomic_equimomental
   use, intrinsic :: iso_c_binding, only: c_int64_t, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: real64
   use holonomic_c, only: hol_equimomental_points
   use holonomic_place, only: tensor
   use holonomic_status, only: failure, settle
   implicit none
   private
   public :: equimomental_points

contains

   ! n_points elements of masses and columns of places are written. centre: the origin by default.
   recursive subroutine equimomental_points(mass, inertia, n_points, masses, places, centre, stat, errmsg)
      real(real64), intent(in) :: mass
      real(real64), intent(in), target :: inertia(3, 3)
      integer, intent(out) :: n_points
      real(real64), intent(inout), target :: masses(4), places(3, 4)
      real(real64), intent(in), optional, target :: centre(3)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      integer(c_int64_t), target :: n
      type(c_ptr) :: middle
      type(failure) :: problem
      n = 0
      middle = c_null_ptr
      if (present(centre)) middle = c_loc(centre)
      call problem%ask(hol_equimomental_points(mass, middle, tensor(inertia), c_loc(n), c_loc(masses), c_loc(places)))
      n_points = int(n)
      call settle(problem, "hol_equimomental_points", stat, errmsg)
   end subroutine

end module
