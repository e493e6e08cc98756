! Many threads compute with one handle at once, each with arrays of its own.
program test_threads
   use, intrinsic :: iso_fortran_env, only: real64
   use checks, only: check, finish, same_bits, test
   use holonomic
   implicit none
   integer, parameter :: n = 300, n_rounds = 200
   type(hol_chains) :: chains
   real(real64), dimension(3, n) :: r, v, f, g0, u0, g, u
   integer :: i, round, n_wrong, n_misplaced, stat
   character(200) :: message
   character(12) :: expected

   call test("threads with one handle")
   call random_number(r)
   call random_number(v)
   call random_number(f)
   r = r + reshape([(real(i, real64), 0.0_real64, 0.0_real64, i=1, n)], [3, n])
   call chains%create([(1.0_real64, i=1, n)])
   call chains%add(30, 9, 1, 1.0_real64)
   call chains%forces(r, v, f, g=g0)
   u0 = v
   call chains%project_velocities(r, u0)
   n_wrong = 0
   n_misplaced = 0
   !$omp parallel do private(g, u, stat, message, expected) reduction(+:n_wrong, n_misplaced) num_threads(8) schedule(static, 1)
   do round = 1, n_rounds
      call chains%forces(r, v, f, g=g)
      u = v
      call chains%project_velocities(r, u)
      if (.not. (all(same_bits(g, g0)) .and. all(same_bits(u, u0)))) n_wrong = n_wrong + 1
      ! Each thread has its own message.
      u = v
      u(1, 1 + 10*mod(round, 30)) = huge(u)
      u(2, 1 + 10*mod(round, 30)) = 1/(u(2, 1)*0)
      call chains%project_velocities(r, u, stat=stat, errmsg=message)
      ! Not a function with a result of deferred length, for which gfortran keeps a static variable here.
      write (expected, '("molecule ", i0, ":")') 1 + mod(round, 30)
      if (stat /= HOL_ERR_NOT_FINITE .or. index(message, trim(expected)) == 0) n_misplaced = n_misplaced + 1
   end do
   !$omp end parallel do
   call check(n_wrong == 0, "give the same, bit for bit")
   call check(n_misplaced == 0, "each get their own message")
   call chains%set_threads(4)
   call chains%forces(r, v, f, g=g)
   call check(all(same_bits(g, g0)), "and so do threads inside the library")
   call chains%destroy()
   call finish()

end program
