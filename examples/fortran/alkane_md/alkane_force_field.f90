! Applied forces of a united-atom n-alkane, TraPPE-UA (Martin and Siepmann 1998, DOI 10.1021/jp972543+), as a molecular
! dynamics code has them. The bonds are rigid and the library's business; nothing here knows of it.
!
!     angles        U = k/2 (theta - theta0)^2
!     torsions      U = c1 (1 + cos phi) + c2 (1 - cos 2 phi) + c3 (1 + cos 3 phi), trans at phi = pi
!     other pairs   U = 4 epsilon ((sigma/r)^12 - (sigma/r)^6) between atoms four or more bonds apart
module alkane_force_field
   use alkane_units, only: dp, boltzmann
   implicit none
   private
   public :: force_field, set_up_force_field, potential_energy

   real(dp), parameter, public :: bond_length = 1.54_dp
   real(dp), parameter :: pi = acos(-1.0_dp)
   real(dp), parameter :: k_angle = 62500*boltzmann, theta0 = 114*pi/180
   real(dp), parameter :: c1 = 355.03_dp*boltzmann, c2 = -68.19_dp*boltzmann, c3 = 791.32_dp*boltzmann

   type :: force_field
      real(dp), allocatable :: mass(:), epsilon(:), sigma(:)
   end type

contains

   ! Groups by their names; `unknown` is the number of the first atom that is none of them, or 0.
   subroutine set_up_force_field(names, field, unknown)
      character(*), intent(in) :: names(:)
      type(force_field), intent(out) :: field
      integer, intent(out) :: unknown
      integer :: i
      allocate (field%mass(size(names)), field%epsilon(size(names)), field%sigma(size(names)))
      unknown = 0
      do i = 1, size(names)
         select case (names(i))
         case ("CH3")
            field%mass(i) = 15.035_dp
            field%epsilon(i) = 98*boltzmann
            field%sigma(i) = 3.75_dp
         case ("CH2")
            field%mass(i) = 14.027_dp
            field%epsilon(i) = 46*boltzmann
            field%sigma(i) = 3.95_dp
         case default
            unknown = i
            return
         end select
      end do
   end subroutine

   ! The energy, and in f the forces.
   function potential_energy(field, r, f) result(energy)
      type(force_field), intent(in) :: field
      real(dp), intent(in) :: r(:, :)
      real(dp), intent(out) :: f(:, :)
      real(dp) :: energy
      integer :: i, j, n
      n = size(r, 2)
      f = 0
      energy = 0
      do i = 1, n - 2
         call add_angle(r(:, i:i + 2), f(:, i:i + 2), energy)
      end do
      do i = 1, n - 3
         call add_torsion(r(:, i:i + 3), f(:, i:i + 3), energy)
      end do
      do i = 1, n - 4
         do j = i + 4, n
            call add_pair(sqrt(field%epsilon(i)*field%epsilon(j)), (field%sigma(i) + field%sigma(j))/2, &
                          r(:, i), r(:, j), f(:, i), f(:, j), energy)
         end do
      end do
   end function

   subroutine add_angle(r, f, energy)
      real(dp), intent(in) :: r(3, 3)
      real(dp), intent(inout) :: f(3, 3), energy
      real(dp) :: a(3), b(3), length_a, length_b, cosine, theta, slope, f1(3), f3(3)
      a = r(:, 1) - r(:, 2)
      b = r(:, 3) - r(:, 2)
      length_a = norm2(a)
      length_b = norm2(b)
      cosine = dot_product(a, b)/(length_a*length_b)
      theta = acos(max(-1.0_dp, min(1.0_dp, cosine)))
      energy = energy + k_angle/2*(theta - theta0)**2
      ! - dU/d(cos theta); the gradient of the cosine follows.
      slope = k_angle*(theta - theta0)/sqrt(1 - cosine**2)
      f1 = slope*(b/length_b - cosine*a/length_a)/length_a
      f3 = slope*(a/length_a - cosine*b/length_b)/length_b
      f(:, 1) = f(:, 1) + f1
      f(:, 2) = f(:, 2) - f1 - f3
      f(:, 3) = f(:, 3) + f3
   end subroutine

   ! Gradient of the dihedral angle as in Blondel and Karplus 1996, DOI
   ! 10.1002/(SICI)1096-987X(19960715)17:9<1132::AID-JCC5>3.0.CO;2-T: it has no singularity at cis and trans.
   subroutine add_torsion(r, f, energy)
      real(dp), intent(in) :: r(3, 4)
      real(dp), intent(inout) :: f(3, 4), energy
      real(dp) :: b1(3), b2(3), b3(3), a(3), b(3), aa, bb, length, phi, slope, f1(3), f4(3), shift(3)
      b1 = r(:, 1) - r(:, 2)
      b2 = r(:, 2) - r(:, 3)
      b3 = r(:, 4) - r(:, 3)
      a = cross(b1, b2)
      b = cross(b3, b2)
      aa = dot_product(a, a)
      bb = dot_product(b, b)
      length = norm2(b2)
      phi = atan2(dot_product(cross(b, a), b2)/length, dot_product(a, b))
      energy = energy + c1*(1 + cos(phi)) + c2*(1 - cos(2*phi)) + c3*(1 + cos(3*phi))
      slope = -c1*sin(phi) + 2*c2*sin(2*phi) - 3*c3*sin(3*phi)
      f1 = slope*length/aa*a
      f4 = -slope*length/bb*b
      shift = slope*(dot_product(b1, b2)/(aa*length)*a - dot_product(b3, b2)/(bb*length)*b)
      f(:, 1) = f(:, 1) + f1
      f(:, 2) = f(:, 2) - f1 - shift
      f(:, 3) = f(:, 3) - f4 + shift
      f(:, 4) = f(:, 4) + f4
   end subroutine

   subroutine add_pair(epsilon, sigma, r1, r2, f1, f2, energy)
      real(dp), intent(in) :: epsilon, sigma, r1(3), r2(3)
      real(dp), intent(inout) :: f1(3), f2(3), energy
      real(dp) :: d(3), inverse, sixth, force(3)
      d = r1 - r2
      inverse = 1/dot_product(d, d)
      sixth = (sigma**2*inverse)**3
      energy = energy + 4*epsilon*sixth*(sixth - 1)
      force = 24*epsilon*sixth*(2*sixth - 1)*inverse*d
      f1 = f1 + force
      f2 = f2 - force
   end subroutine

   pure function cross(a, b) result(c)
      real(dp), intent(in) :: a(3), b(3)
      real(dp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function

end module
