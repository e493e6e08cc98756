! Three ways to move a molecule with rigid bonds, each with what the library does for it in a step.
!
!     rk4       classical Runge-Kutta on r'' = (F + G)/m with G from `forces`: the bonds hold to the order of the method
!     rattle    velocity Verlet with project_positions after the drift and project_velocities at the end
!     langevin  g-BAOAB (Leimkuhler and Matthews 2016, DOI 10.1098/rspa.2016.0138): every kick, drift and bath is followed
!               by a projection
module alkane_integrators
   use, intrinsic :: iso_fortran_env, only: int64
   use alkane_force_field, only: bond_length, force_field, potential_energy
   use alkane_shake, only: rattle_velocities, shake
   use alkane_units, only: dp, boltzmann
   use holonomic, only: hol_chains, hol_report
   implicit none
   private
   public :: molecule, start, step_rk4, step_rattle, step_langevin, thermal_velocities, kinetic_energy

   type :: molecule
      type(force_field) :: field
      type(hol_chains) :: chains
      real(dp), allocatable :: r(:, :), v(:, :), f(:, :), r_ref(:, :)
      real(dp), allocatable :: lambda(:)       ! of the last drift, the first guess for the next
      real(dp) :: potential = 0
      integer(int64) :: iterations = 0         ! most that a drift has taken so far
      real(dp) :: tolerance = 0                ! above 0: SHAKE and RATTLE's iterations to this, not the library
      integer(int64) :: ticks = 0              ! of the clock, in constraints
   end type

contains

   ! Puts positions read from a file on the constraints, and sets the velocities.
   subroutine start(m, temperature)
      type(molecule), intent(inout) :: m
      real(dp), intent(in) :: temperature
      integer :: n
      n = size(m%r, 2)
      allocate (m%f(3, n), m%lambda(m%chains%n_bonds()))
      allocate (m%r_ref, source=m%r)
      call m%chains%project_positions(m%r_ref, m%r, 1.0_dp)
      m%potential = potential_energy(m%field, m%r, m%f)
      m%lambda = 0
      allocate (m%v(3, n))
      m%v = thermal_velocities(m, temperature)
      call remove_drift(m)
      call m%chains%project_velocities(m%r, m%v)
   end subroutine

   subroutine step_rk4(m, dt)
      type(molecule), intent(inout) :: m
      real(dp), intent(in) :: dt
      real(dp), dimension(3, size(m%r, 2)) :: r0, v0, v1, v2, v3, v4, a1, a2, a3, a4
      r0 = m%r
      v0 = m%v
      v1 = v0
      a1 = acceleration(m, r0, v1)
      v2 = v0 + dt/2*a1
      a2 = acceleration(m, r0 + dt/2*v1, v2)
      v3 = v0 + dt/2*a2
      a3 = acceleration(m, r0 + dt/2*v2, v3)
      v4 = v0 + dt*a3
      a4 = acceleration(m, r0 + dt*v3, v4)
      m%r = r0 + dt/6*(v1 + 2*v2 + 2*v3 + v4)
      m%v = v0 + dt/6*(a1 + 2*a2 + 2*a3 + a4)
      m%potential = potential_energy(m%field, m%r, m%f)
   end subroutine

   function acceleration(m, r, v) result(a)
      type(molecule), intent(inout) :: m
      real(dp), intent(in) :: r(:, :), v(:, :)
      real(dp) :: a(3, size(r, 2))
      m%potential = potential_energy(m%field, r, m%f)
      a = m%f
      call m%chains%forces(r, v, m%f, g=a, add=.true.)
      a = divided_by_mass(m, a)
   end function

   subroutine step_rattle(m, dt)
      type(molecule), intent(inout) :: m
      real(dp), intent(in) :: dt
      m%v = m%v + dt/2*divided_by_mass(m, m%f)
      call drift(m, dt)
      m%potential = potential_energy(m%field, m%r, m%f)
      m%v = m%v + dt/2*divided_by_mass(m, m%f)
      call project_velocities(m, dt)
   end subroutine

   subroutine step_langevin(m, dt, temperature, friction)
      type(molecule), intent(inout) :: m
      real(dp), intent(in) :: dt, temperature, friction
      real(dp) :: kept
      m%v = m%v + dt/2*divided_by_mass(m, m%f)
      call project_velocities(m, dt)
      call drift(m, dt/2)
      call project_velocities(m, dt)
      kept = exp(-friction*dt)
      m%v = kept*m%v + sqrt(1 - kept**2)*thermal_velocities(m, temperature)
      call project_velocities(m, dt)
      call drift(m, dt/2)
      call project_velocities(m, dt)
      m%potential = potential_energy(m%field, m%r, m%f)
      m%v = m%v + dt/2*divided_by_mass(m, m%f)
      call project_velocities(m, dt)
   end subroutine

   ! The constrained move along the velocities: corrections act along the bonds before the move, and change the
   ! velocities by the same displacement over dt.
   subroutine drift(m, dt)
      type(molecule), intent(inout) :: m
      real(dp), intent(in) :: dt
      type(hol_report) :: report
      integer(int64) :: began, ended
      integer :: rounds
      m%r_ref = m%r
      m%r = m%r + dt*m%v
      call system_clock(began)
      if (m%tolerance > 0) then
         call shake(m%field%mass, bond_length, m%tolerance, m%r_ref, m%r, dt, m%v, rounds)
         report%iterations = rounds
      else
         call m%chains%project_positions(m%r_ref, m%r, dt, m%v, m%lambda, guess=.true., report=report)
      end if
      call system_clock(ended)
      m%ticks = m%ticks + ended - began
      m%iterations = max(m%iterations, report%iterations)
   end subroutine

   subroutine project_velocities(m, dt)
      type(molecule), intent(inout) :: m
      real(dp), intent(in) :: dt
      integer(int64) :: began, ended
      call system_clock(began)
      if (m%tolerance > 0) then
         call rattle_velocities(m%field%mass, bond_length, m%tolerance, m%r, dt, m%v)
      else
         call m%chains%project_velocities(m%r, m%v)
      end if
      call system_clock(ended)
      m%ticks = m%ticks + ended - began
   end subroutine

   function divided_by_mass(m, f) result(a)
      type(molecule), intent(in) :: m
      real(dp), intent(in) :: f(:, :)
      real(dp) :: a(3, size(f, 2))
      a = f/spread(m%field%mass, 1, 3)
   end function

   real(dp) function kinetic_energy(m)
      type(molecule), intent(in) :: m
      kinetic_energy = sum(m%field%mass*sum(m%v**2, dim=1))/2
   end function

   ! Of free atoms: a projection makes them those of the rigid molecule.
   function thermal_velocities(m, temperature) result(v)
      type(molecule), intent(in) :: m
      real(dp), intent(in) :: temperature
      real(dp) :: v(3, size(m%r, 2)), u(3, size(m%r, 2)), w(3, size(m%r, 2))
      call random_number(u)
      call random_number(w)
      v = sqrt(-2*log(1 - u))*cos(2*acos(-1.0_dp)*w)*sqrt(boltzmann*temperature/spread(m%field%mass, 1, 3))
   end function

   subroutine remove_drift(m)
      type(molecule), intent(inout) :: m
      m%v = m%v - spread(matmul(m%v, m%field%mass)/sum(m%field%mass), 2, size(m%v, 2))
   end subroutine

end module
