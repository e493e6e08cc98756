! A first configuration: chains folded to and fro in flat patches, stacked in the box.
module melt_start
   use, intrinsic :: iso_fortran_env, only: dp => real64
   implicit none
   private
   public :: place_chains, thermal_velocities

   real(dp), parameter :: closest = 0.95_dp   ! what the repulsion can take at the start

contains

   ! Beads 1 apart along a chain; `fits` is false if the box is too small for that many patches.
   subroutine place_chains(n_chains, n_beads, box, r, fits)
      integer, intent(in) :: n_chains, n_beads
      real(dp), intent(in) :: box
      real(dp), intent(out) :: r(:, :)
      logical, intent(out) :: fits
      integer :: width, rows, patches(3), chain, bead, row, column, at(3)
      patches = 0
      fits = .false.
      do width = 1, n_beads
         rows = (n_beads + width - 1)/width
         patches = floor(box/([width - 1, rows - 1, 0] + closest))
         fits = product(int(patches, kind(0_8))) >= n_chains
         if (fits) exit
      end do
      if (.not. fits) return
      do chain = 0, n_chains - 1
         at = [mod(chain, patches(1)), mod(chain/patches(1), patches(2)), chain/(patches(1)*patches(2))]
         do bead = 0, n_beads - 1
            row = bead/width
            column = merge(mod(bead, width), width - 1 - mod(bead, width), mod(row, 2) == 0)
            r(:, chain*n_beads + bead + 1) = at*box/patches + [column, row, 0]
         end do
      end do
   end subroutine

   ! kT = 1, masses 1
   subroutine thermal_velocities(v)
      real(dp), intent(out) :: v(:, :)
      real(dp), dimension(size(v, 1), size(v, 2)) :: a, b
      call random_number(a)
      call random_number(b)
      v = sqrt(-2*log(1 - a))*cos(2*acos(-1.0_dp)*b)
   end subroutine

end module
