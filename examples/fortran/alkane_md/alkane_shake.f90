! What the library replaces, to compare with: SHAKE (Ryckaert, Ciccotti and Berendsen 1977) and the second half of RATTLE
! (Andersen 1983). Both go along the bonds, mend one after the other, and begin again until all are good enough.
module alkane_shake
   use alkane_units, only: dp
   implicit none
   private
   public :: shake, rattle_velocities

   integer, parameter :: most_rounds = 10000

contains

   ! Corrections along the bonds of r_ref bring the bonds of r to their length: | d^2 - a^2 | <= tolerance a^2.
   subroutine shake(mass, a, tolerance, r_ref, r, dt, v, rounds)
      real(dp), intent(in) :: mass(:), a, tolerance, r_ref(:, :), dt
      real(dp), intent(inout) :: r(:, :), v(:, :)
      integer, intent(out) :: rounds
      real(dp), dimension(3, size(r, 2)) :: before
      real(dp) :: d(3), along(3), excess, w1, w2
      integer :: k
      logical :: done
      before = r
      do rounds = 1, most_rounds
         done = .true.
         do k = 1, size(r, 2) - 1
            d = r(:, k + 1) - r(:, k)
            excess = dot_product(d, d) - a**2
            if (abs(excess) <= tolerance*a**2) cycle
            done = .false.
            w1 = 1/mass(k)
            w2 = 1/mass(k + 1)
            along = r_ref(:, k + 1) - r_ref(:, k)
            along = along*excess/(2*(w1 + w2)*dot_product(d, along))
            r(:, k) = r(:, k) + w1*along
            r(:, k + 1) = r(:, k + 1) - w2*along
         end do
         if (done) exit
      end do
      v = v + (r - before)/dt
   end subroutine

   ! Velocities along no bond: | d.(v_2 - v_1) | dt <= tolerance a^2.
   subroutine rattle_velocities(mass, a, tolerance, r, dt, v)
      real(dp), intent(in) :: mass(:), a, tolerance, r(:, :), dt
      real(dp), intent(inout) :: v(:, :)
      real(dp) :: d(3), rate, w1, w2
      integer :: k, rounds
      logical :: done
      do rounds = 1, most_rounds
         done = .true.
         do k = 1, size(r, 2) - 1
            d = r(:, k + 1) - r(:, k)
            rate = dot_product(d, v(:, k + 1) - v(:, k))
            if (abs(rate)*dt <= tolerance*a**2) cycle
            done = .false.
            w1 = 1/mass(k)
            w2 = 1/mass(k + 1)
            d = d*rate/((w1 + w2)*dot_product(d, d))
            v(:, k) = v(:, k) + w1*d
            v(:, k + 1) = v(:, k + 1) - w2*d
         end do
         if (done) exit
      end do
   end subroutine

end module
