! The TIP4P/2005 model of water (Abascal and Vega 2005, DOI 10.1063/1.2121687) in a periodic cube: Lennard-Jones between
! oxygens, charges at the hydrogens and at a site M without mass on the bisector of the angle. Charges act by the damped and
! shifted force of Fennell and Gezelter (2006, DOI 10.1063/1.2206581) in place of an Ewald sum, and the Lennard-Jones force is
! shifted likewise, so that energies and forces are continuous at the cutoff. Nothing here knows of the library.
!
! Units: length A, time fs, mass g/mol, so that energies are in g/mol A^2/fs^2 = 10^4 kJ/mol. The atoms of molecule m are
! 4 m - 3 (oxygen), 4 m - 2 and 4 m - 1 (hydrogen), 4 m (site).
module tip4p_2005
   use, intrinsic :: iso_fortran_env, only: dp => real64
   implicit none
   private
   public :: pair_forces, place_molecules, thermal_velocities

   real(dp), parameter, public :: kj_per_mol = 1e-4_dp            ! one kJ/mol in energy units
   real(dp), parameter, public :: boltzmann = 8.314462618e-7_dp   ! energy/K
   real(dp), parameter, public :: mass(4) = [15.9994_dp, 1.008_dp, 1.008_dp, 0.0_dp]
   real(dp), parameter :: pi = acos(-1.0_dp)
   real(dp), parameter :: oh = 0.9572_dp, angle = 104.52_dp*pi/180, om = 0.1546_dp
   ! What a molecule looks like.
   real(dp), parameter, public :: places(3, 4) = reshape([0.0_dp, 0.0_dp, 0.0_dp, &
      oh*cos(angle/2), oh*sin(angle/2), 0.0_dp, oh*cos(angle/2), -oh*sin(angle/2), 0.0_dp, om, 0.0_dp, 0.0_dp], [3, 4])
   real(dp), parameter :: sigma = 3.1589_dp, epsilon = 93.2_dp*boltzmann
   real(dp), parameter :: coulomb = 1389.35458_dp*kj_per_mol      ! e^2/(4 pi epsilon_0), energy A
   real(dp), parameter :: charge(4) = [0.0_dp, 0.5564_dp, 0.5564_dp, -1.1128_dp]
   real(dp), parameter :: damping = 0.2_dp                        ! 1/A

contains

   ! Energy, and forces also on the sites.
   subroutine pair_forces(box, cutoff, r, f, energy)
      real(dp), intent(in) :: box, cutoff, r(:, :)
      real(dp), intent(out) :: f(:, :), energy
      real(dp) :: d(3), square, distance, edge, slope_at_edge, lj_edge, lj_slope
      integer :: m, l, a, b
      edge = erfc(damping*cutoff)/cutoff
      slope_at_edge = edge/cutoff + 2*damping/sqrt(pi)*exp(-(damping*cutoff)**2)/cutoff
      lj_edge = lennard_jones(cutoff)
      lj_slope = lennard_jones_slope(cutoff)
      f = 0
      energy = 0
      do m = 1, size(r, 2), 4
         do l = m + 4, size(r, 2), 4
            d = r(:, m) - r(:, l)
            d = d - box*anint(d/box)
            square = dot_product(d, d)
            if (square >= (cutoff + 2*oh)**2) cycle   ! no atoms of the two are within the cutoff
            if (square < cutoff**2) then
               distance = sqrt(square)
               energy = energy + lennard_jones(distance) - lj_edge + lj_slope*(distance - cutoff)
               call add(m, l, (lennard_jones_slope(distance) - lj_slope)/distance*d)
            end if
            do a = 2, 4
               do b = 2, 4
                  d = r(:, m + a - 1) - r(:, l + b - 1)
                  d = d - box*anint(d/box)
                  square = dot_product(d, d)
                  if (square < cutoff**2) call add_charges(charge(a)*charge(b)*coulomb)
               end do
            end do
         end do
      end do
   contains
      subroutine add_charges(strength)
         real(dp), intent(in) :: strength
         real(dp) :: tail
         distance = sqrt(square)
         tail = erfc(damping*distance)/distance
         energy = energy + strength*(tail - edge + slope_at_edge*(distance - cutoff))
         call add(m + a - 1, l + b - 1, strength/distance*(tail/distance + 2*damping/sqrt(pi) &
                                                            *exp(-(damping*distance)**2)/distance - slope_at_edge)*d)
      end subroutine

      subroutine add(i, j, force)
         integer, intent(in) :: i, j
         real(dp), intent(in) :: force(3)
         f(:, i) = f(:, i) + force
         f(:, j) = f(:, j) - force
      end subroutine
   end subroutine

   pure real(dp) function lennard_jones(distance)
      real(dp), intent(in) :: distance
      lennard_jones = 4*epsilon*(sigma/distance)**6*((sigma/distance)**6 - 1)
   end function

   ! - dU/dr
   pure real(dp) function lennard_jones_slope(distance)
      real(dp), intent(in) :: distance
      lennard_jones_slope = 24*epsilon*(sigma/distance)**6*(2*(sigma/distance)**6 - 1)/distance
   end function

   ! On a cubic lattice, each turned at random.
   subroutine place_molecules(box, r)
      real(dp), intent(in) :: box
      real(dp), intent(out) :: r(:, :)
      real(dp) :: axes(3, 3)
      integer :: m, cells
      cells = 1
      do while (cells**3 < size(r, 2)/4)
         cells = cells + 1
      end do
      do m = 0, size(r, 2)/4 - 1
         axes(:, 1) = direction()
         axes(:, 2) = direction()
         axes(:, 2) = axes(:, 2) - dot_product(axes(:, 1), axes(:, 2))*axes(:, 1)
         axes(:, 2) = axes(:, 2)/norm2(axes(:, 2))
         axes(:, 3) = 0   ! the molecule is flat
         r(:, 4*m + 1:4*m + 4) = matmul(axes, places) + &
            spread((box/cells)*[mod(m, cells), mod(m/cells, cells), m/cells**2], 2, 4)
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

   ! Of free atoms; projected onto the constraints they are those of rigid molecules. What sites have does not matter.
   subroutine thermal_velocities(temperature, v)
      real(dp), intent(in) :: temperature
      real(dp), intent(out) :: v(:, :)
      real(dp) :: a(3), b(3), its_mass
      integer :: i
      do i = 1, size(v, 2)
         call random_number(a)
         call random_number(b)
         its_mass = max(mass(1 + mod(i - 1, 4)), mass(2))
         v(:, i) = sqrt(-2*log(1 - a)*boltzmann*temperature/its_mass)*cos(2*pi*b)
      end do
   end subroutine

end module
