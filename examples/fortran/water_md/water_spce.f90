! The SPC/E model of water (Berendsen, Grigera and Straatsma 1987, DOI 10.1021/j100308a038) in a periodic cube. Charges act
! by the damped and shifted force of Fennell and Gezelter (2006, DOI 10.1063/1.2206581), and the Lennard-Jones force is
! shifted likewise, so that energies and forces are continuous at the cutoff. Nothing here knows of the library.
!
! Units: length A, time fs, mass g/mol, so that energies are in g/mol A^2/fs^2 = 10^4 kJ/mol. The atoms of molecule m are
! 3 m - 2 (oxygen), 3 m - 1 and 3 m (hydrogen).
module water_spce
   use, intrinsic :: iso_fortran_env, only: dp => real64
   implicit none
   private
   public :: pair_forces

   real(dp), parameter, public :: kj_per_mol = 1e-4_dp            ! one kJ/mol in energy units
   real(dp), parameter, public :: boltzmann = 8.314462618e-7_dp   ! energy/K
   real(dp), parameter, public :: bar = 6.02214076e-9_dp         ! one bar in energy units per A^3
   real(dp), parameter, public :: oh = 1.0_dp, hh = 2*sin(acos(-1/3.0_dp)/2)   ! the angle is that of a tetrahedron
   real(dp), parameter, public :: mass(3) = [15.9994_dp, 1.008_dp, 1.008_dp]
   real(dp), parameter :: sigma = 3.166_dp, epsilon = 0.650_dp*kj_per_mol
   real(dp), parameter :: coulomb = 1389.35458_dp*kj_per_mol      ! e^2/(4 pi epsilon_0), energy A
   real(dp), parameter :: charge(3) = [-0.8476_dp, 0.4238_dp, 0.4238_dp]
   real(dp), parameter :: damping = 0.2_dp                        ! 1/A
   real(dp), parameter :: pi = acos(-1.0_dp)

contains

   ! Energy, forces, and sum over pairs of d . f.
   subroutine pair_forces(box, cutoff, r, f, energy, virial)
      real(dp), intent(in) :: box, cutoff, r(:, :)
      real(dp), intent(out) :: f(:, :), energy, virial
      real(dp) :: d(3), square
      integer :: m, l
      f = 0
      energy = 0
      virial = 0
      do m = 1, size(r, 2), 3
         do l = m + 3, size(r, 2), 3
            d = r(:, m) - r(:, l)
            d = d - box*anint(d/box)
            square = dot_product(d, d)
            if (square >= (cutoff + 2*oh)**2) cycle   ! no atoms of the two are within the cutoff
            if (square < cutoff**2) call add_dispersion()
            call add_charges()
         end do
      end do
   contains
      subroutine add_dispersion()
         real(dp) :: sixth, at_cutoff, slope, slope_at_cutoff, distance
         distance = sqrt(square)
         sixth = (sigma**2/square)**3
         slope = 24*epsilon*sixth*(2*sixth - 1)/distance          ! - dU/dr
         at_cutoff = (sigma/cutoff)**6
         slope_at_cutoff = 24*epsilon*at_cutoff*(2*at_cutoff - 1)/cutoff
         energy = energy + 4*epsilon*(sixth*(sixth - 1) - at_cutoff*(at_cutoff - 1)) + slope_at_cutoff*(distance - cutoff)
         call add_pair(m, l, d, distance, slope - slope_at_cutoff)
      end subroutine

      subroutine add_charges()
         real(dp) :: e(3), distance, strength, edge, slope_at_edge
         integer :: a, b
         edge = erfc(damping*cutoff)/cutoff
         slope_at_edge = edge/cutoff + 2*damping/sqrt(pi)*exp(-(damping*cutoff)**2)/cutoff
         do a = 1, 3
            do b = 1, 3
               e = r(:, m + a - 1) - r(:, l + b - 1)
               e = e - box*anint(e/box)
               distance = dot_product(e, e)
               if (distance >= cutoff**2) cycle
               distance = sqrt(distance)
               strength = coulomb*charge(a)*charge(b)
               energy = energy + strength*(erfc(damping*distance)/distance - edge + slope_at_edge*(distance - cutoff))
               call add_pair(m + a - 1, l + b - 1, e, distance, strength*(erfc(damping*distance)/distance**2 &
                             + 2*damping/sqrt(pi)*exp(-(damping*distance)**2)/distance - slope_at_edge))
            end do
         end do
      end subroutine

      subroutine add_pair(i, j, d, distance, force)
         integer, intent(in) :: i, j
         real(dp), intent(in) :: d(3), distance, force
         virial = virial + force*distance
         f(:, i) = f(:, i) + force/distance*d
         f(:, j) = f(:, j) - force/distance*d
      end subroutine
   end subroutine

end module
