! A first configuration: molecules on a cubic lattice, turned at random, and velocities of a temperature.
module water_start
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use water_spce, only: boltzmann, hh, mass, oh
   implicit none
   private
   public :: place_molecules, thermal_velocities

contains

   subroutine place_molecules(box, r)
      real(dp), intent(in) :: box
      real(dp), intent(out) :: r(:, :)
      real(dp) :: u(3), side(3), middle(3)
      integer :: m, cells
      cells = 1
      do while (cells**3 < size(r, 2)/3)
         cells = cells + 1
      end do
      do m = 0, size(r, 2)/3 - 1
         u = direction()
         side = direction()
         side = side - dot_product(side, u)*u
         side = side/norm2(side)
         r(:, 3*m + 1) = (box/cells)*[mod(m, cells), mod(m/cells, cells), m/cells**2]
         middle = r(:, 3*m + 1) + sqrt(oh**2 - (hh/2)**2)*u   ! between the hydrogens
         r(:, 3*m + 2) = middle + hh/2*side
         r(:, 3*m + 3) = middle - hh/2*side
      end do
   end subroutine

   function direction() result(u)
      real(dp) :: u(3)
      do
         call random_number(u)
         u = 2*u - 1
         if (norm2(u) < 1 .and. norm2(u) > 0.1_dp) exit
      end do
      u = u/norm2(u)
   end function

   ! Of free atoms; projected onto the constraints they are those of rigid molecules.
   subroutine thermal_velocities(temperature, v)
      real(dp), intent(in) :: temperature
      real(dp), intent(out) :: v(:, :)
      real(dp) :: a(3), b(3)
      integer :: i
      do i = 1, size(v, 2)
         call random_number(a)
         call random_number(b)
         v(:, i) = sqrt(-2*log(1 - a)*boltzmann*temperature/mass(1 + mod(i - 1, 3)))*cos(2*acos(-1.0_dp)*b)
      end do
   end subroutine

end module
