! Without stat a failure stops the program, with the message.
program stops
   use holonomic, only: hol_chains
   implicit none
   type(hol_chains) :: chains
   call chains%create([1d0, 1d0])
   call chains%add([1, 3], 1d0)
   print "(a)", "not reached"
end program
