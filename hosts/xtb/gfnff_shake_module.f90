! In place of src/gfnff/shake_module.f90. With GFN-FF, xtb 6.7 holds no bond: the topology that it hands over has no list of them any
! more, and do_shake is that of the other module. Here both are one, and bonds are the pairs that are near enough.
module xtb_gfnff_shake
   use xtb_mctc_accuracy, only: wp
   use xtb_gfnff_topology, only: TGFFTopology
   use xtb_shake, only: by_orders => init_shake
   implicit none
   private
   public :: init_shake

contains

   subroutine init_shake(nat, at, xyz, topo)
      integer, intent(in) :: nat, at(nat)
      real(wp), intent(in) :: xyz(3, nat)
      type(TGFFTopology), intent(in) :: topo
      real(wp) :: orders(nat, nat)
      orders = 1
      call by_orders(nat, at, xyz, orders)
   end subroutine

end module xtb_gfnff_shake
