! Repulsion of the beads in a periodic cube (Weeks, Chandler and Andersen 1971, DOI 10.1063/1.1674820) by a Verlet list
! made from cells, as a molecular dynamics code has it. Nothing here knows of the library.
!
!     U = 4 ((1/r)^12 - (1/r)^6) + 1 for r < 2^(1/6), between beads that no bond joins
module melt_pairs
   use, intrinsic :: iso_fortran_env, only: dp => real64
   implicit none
   private
   public :: pair_list, update_list, pair_forces

   real(dp), parameter :: cutoff_square = 2.0_dp**(1/3.0_dp), skin = 0.35_dp
   real(dp), parameter :: reach = sqrt(cutoff_square) + skin

   type :: pair_list
      integer, allocatable :: first(:), partner(:)   ! of bead i: partner(first(i)) .. partner(first(i + 1) - 1)
      real(dp), allocatable :: r_made(:, :)          ! positions when the list was made
      integer :: made = 0                            ! how often it was
   end type

contains

   ! Makes the list anew if a bead has moved half the skin since it was made. Then the beads are put back into the box,
   ! too: one by one, so that chains lie across its faces.
   subroutine update_list(list, box, n_beads, r)
      type(pair_list), intent(inout) :: list
      real(dp), intent(in) :: box
      integer, intent(in) :: n_beads                 ! of a chain
      real(dp), intent(inout) :: r(:, :)
      if (list%made > 0) then
         if (4*maxval(sum((r - list%r_made)**2, dim=1)) < skin**2) return
      end if
      r = r - box*floor(r/box)
      call make_list(list, box, n_beads, r)
      list%r_made = r
      list%made = list%made + 1
   end subroutine

   subroutine make_list(list, box, n_beads, r)
      type(pair_list), intent(inout) :: list
      real(dp), intent(in) :: box, r(:, :)
      integer, intent(in) :: n_beads
      integer, allocatable :: head(:, :, :), next(:)
      integer :: cells, n, i, j, k, ix, iy, iz, at(3), n_pairs
      real(dp) :: d(3)
      n = size(r, 2)
      cells = max(1, floor(box/reach))
      allocate (head(0:cells - 1, 0:cells - 1, 0:cells - 1), source=0)
      allocate (next(n))
      do i = 1, n
         at = cell(r(:, i))
         next(i) = head(at(1), at(2), at(3))
         head(at(1), at(2), at(3)) = i
      end do
      if (.not. allocated(list%first)) allocate (list%first(n + 1), list%partner(8*n))
      n_pairs = 0
      do i = 1, n
         list%first(i) = n_pairs + 1
         at = cell(r(:, i))
         ! Three cells per axis, or all of them if there are fewer, so that none is seen twice.
         do iz = at(3) - 1, at(3) - 1 + min(cells, 3) - 1
            do iy = at(2) - 1, at(2) - 1 + min(cells, 3) - 1
               do ix = at(1) - 1, at(1) - 1 + min(cells, 3) - 1
                  j = head(modulo(ix, cells), modulo(iy, cells), modulo(iz, cells))
                  do while (j /= 0)
                     if (j > i .and. .not. bonded(i, j, n_beads)) then
                        d = minimum_image(r(:, i) - r(:, j), box)
                        if (dot_product(d, d) < reach**2) then
                           n_pairs = n_pairs + 1
                           if (n_pairs > size(list%partner)) list%partner = [list%partner, (0, k=1, size(list%partner))]
                           list%partner(n_pairs) = j
                        end if
                     end if
                     j = next(j)
                  end do
               end do
            end do
         end do
      end do
      list%first(n + 1) = n_pairs + 1
   contains
      pure function cell(position)
         real(dp), intent(in) :: position(3)
         integer :: cell(3)
         cell = modulo(floor(position/box*cells), cells)
      end function
   end subroutine

   ! Neighbours along a chain; beads 1 .. n_beads are the first chain, and so on. Needs i < j.
   pure logical function bonded(i, j, n_beads)
      integer, intent(in) :: i, j, n_beads
      bonded = j == i + 1 .and. mod(i, n_beads) /= 0
   end function

   ! Energy, forces, and sum over pairs of d . f.
   subroutine pair_forces(list, box, r, f, energy, virial)
      type(pair_list), intent(in) :: list
      real(dp), intent(in) :: box, r(:, :)
      real(dp), intent(out) :: f(:, :), energy, virial
      integer :: i, j, k
      real(dp) :: d(3), square, sixth, slope
      f = 0
      energy = 0
      virial = 0
      do i = 1, size(r, 2)
         do k = list%first(i), list%first(i + 1) - 1
            j = list%partner(k)
            d = minimum_image(r(:, i) - r(:, j), box)
            square = dot_product(d, d)
            if (square >= cutoff_square) cycle
            sixth = 1/square**3
            energy = energy + 4*sixth*(sixth - 1) + 1
            slope = 24*sixth*(2*sixth - 1)
            virial = virial + slope
            f(:, i) = f(:, i) + slope/square*d
            f(:, j) = f(:, j) - slope/square*d
         end do
      end do
   end subroutine

   pure function minimum_image(d, box) result(nearest)
      real(dp), intent(in) :: d(3), box
      real(dp) :: nearest(3)
      nearest = d - box*anint(d/box)
   end function

end module
