! The constraints of xtb's molecular dynamics, by holonomic: in place of src/shake_module.f90. What the rest of xtb uses of
! that module is here by the same names and arguments, ncons, init_shake and do_shake, and bonds are chosen by its rules.
module xtb_shake
   use xtb_mctc_accuracy, only: wp
   use xtb_fixparam, only: shakeset
   use xtb_param_atomicrad, only: atomicRad
   use xtb_setparam, only: set
   use holonomic, only: hol_chains
   implicit none
   private
   public :: ncons, init_shake, do_shake

   integer, protected :: ncons = 0
   integer, allocatable :: bonds(:, :)   ! (2, ncons)
   real(wp), allocatable :: lengths(:)   ! (ncons)
   type(hol_chains) :: molecules
   logical :: made = .false.             ! molecules: by the first do_shake, which has the masses

contains

   subroutine init_shake(nat, at, xyz, wbo)
      integer, intent(in) :: nat, at(nat)
      real(wp), intent(in) :: xyz(3, nat), wbo(nat, nat)
      logical :: bonded(nat, nat)        ! above the diagonal
      integer :: i, j, numbers(nat)
      bonded = .false.
      do i = 1, shakeset%n - 1, 2
         call join(shakeset%atoms(i), shakeset%atoms(i + 1))
      end do
      do i = 1, nat
         if (set%shake_mode == 1 .and. at(i) == 1) call join(i, nearest(i))
         do j = i + 1, merge(nat, i, set%shake_mode == 2)
            if (is_rigid(i, j)) call join(i, j)
         end do
      end do
      numbers = [(i, i=1, nat)]
      call constrain(xyz, transpose(reshape([pack(spread(numbers, 2, nat), bonded), pack(spread(numbers, 1, nat), bonded)], &
                                            [count(bonded), 2])))

   contains

      subroutine join(i, j)
         integer, intent(in) :: i, j
         bonded(min(i, j), max(i, j)) = .true.
      end subroutine

      integer function nearest(i)
         integer, intent(in) :: i
         nearest = minloc(sum((xyz - spread(xyz(:, i), 2, nat))**2, dim=1), dim=1, mask=[(j /= i, j=1, nat)])
      end function

      ! Near enough, and a bond by its order; bonds of metals but lithium and beryllium are not held.
      logical function is_rigid(i, j)
         integer, intent(in) :: i, j
         real(wp) :: least
         logical :: light
         least = merge(0.1_wp, 0.5_wp, is_metal(at(i)) .or. is_metal(at(j)))
         light = any([at(i), at(j)] == 3 .or. [at(i), at(j)] == 4)
         is_rigid = norm2(xyz(:, i) - xyz(:, j)) < 1.2_wp*(atomicRad(at(i)) + atomicRad(at(j))) &
                    .and. wbo(i, j) > least .and. (light .or. least > 0.2_wp)
      end function
   end subroutine

   ! Lithium to boron, sodium to aluminium, and so on, to thallium.
   pure logical function is_metal(z)
      integer, intent(in) :: z
      is_metal = any(z >= [3, 11, 19, 37, 55] .and. z <= [5, 13, 31, 49, 81])
   end function

   ! These bonds keep the lengths that they have.
   subroutine constrain(xyz, pairs)
      real(wp), intent(in) :: xyz(:, :)
      integer, intent(in) :: pairs(:, :)
      if (made) call molecules%destroy()
      made = .false.
      ncons = size(pairs, 2)
      bonds = pairs
      lengths = norm2(xyz(:, pairs(1, :)) - xyz(:, pairs(2, :)), dim=1)
   end subroutine

   ! xyz: after the drift from xyzo by velo tstep. Accelerations get what velocities get, over the time.
   subroutine do_shake(nat, xyzo, xyz, velo, acc, mass, tstep)
      integer, intent(in) :: nat
      real(wp), intent(in) :: xyzo(3, nat), mass(nat), tstep
      real(wp), intent(inout) :: xyz(3, nat), velo(3, nat), acc(3, nat)
      real(wp) :: free(3, nat)
      character(500) :: message
      integer :: stat
      if (ncons < 1) return
      if (.not. made) then
         call molecules%create(mass)
         call molecules%add(bonds, lengths)
         made = .true.
      end if
      free = velo
      call molecules%project_positions(xyzo, xyz, tstep, velo, stat=stat, errmsg=message)
      if (stat /= 0) write (*, *) trim(message)
      acc = acc + (velo - free)/tstep
   end subroutine

end module xtb_shake
