! Two atoms of mass 1 turn about each other at distance 2 with relative speed 2: the tension is m/2 2^2 / 2 = 1.
program rotor
   use holonomic, only: hol_chains, hol_status_name, hol_version
   implicit none
   integer, parameter :: dp = kind(1d0)
   type(hol_chains) :: chains
   real(dp) :: r(3, 2), v(3, 2), g(3, 2), tension(1)
   integer :: stat

   r = reshape([-1, 0, 0, 1, 0, 0], [3, 2])
   v = reshape([0, -1, 0, 0, 1, 0], [3, 2])
   call chains%create([1d0, 1d0])
   call chains%add([1, 2], [2d0])
   call chains%forces(r, v=v, tension=tension, g=g)
   print '(2a)', "holonomic ", hol_version()
   print '(a,f5.3,a,f5.3,1x,f6.3)', "tension ", tension(1), " forces ", g(1, 1), g(1, 2)
   call chains%add([1, 2], [2d0], stat=stat)
   print '(2a)', "again: ", hol_status_name(stat)
   call chains%destroy()
end program
