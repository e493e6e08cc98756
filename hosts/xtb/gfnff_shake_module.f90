! In place of src/gfnff/shake_module.f90: with GFN-FF the bonds are those of its topology. xtb 6.7 lists them there and then
! calls the do_shake of the other module, which knows of none; here both are one.
module xtb_gfnff_shake
   use xtb_mctc_accuracy, only: wp
   use xtb_gfnff_topology, only: TGFFTopology
   use xtb_shake, only: constrain
   implicit none
   private
   public :: init_shake

contains

   subroutine init_shake(nat, at, xyz, topo)
      integer, intent(in) :: nat, at(nat)
      real(wp), intent(in) :: xyz(3, nat)
      type(TGFFTopology), intent(in) :: topo
      call constrain(xyz, topo%blist(:2, :topo%nbond))
   end subroutine

end module xtb_gfnff_shake
