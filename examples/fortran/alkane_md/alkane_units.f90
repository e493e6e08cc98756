! Units of the program: length A, time fs, mass g/mol (so that energies are in g/mol A^2/fs^2 = 10^4 kJ/mol).
module alkane_units
   use, intrinsic :: iso_fortran_env, only: real64
   implicit none
   private
   integer, parameter, public :: dp = real64
   real(dp), parameter, public :: boltzmann = 8.314462618e-7_dp   ! energy/K
   real(dp), parameter, public :: kj_per_mol = 1e-4_dp            ! one kJ/mol in energy units
   real(dp), parameter, public :: piconewton = 1/1.66053907e5_dp  ! one pN in force units, g/mol A/fs^2
end module
