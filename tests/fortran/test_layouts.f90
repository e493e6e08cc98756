! Every layout of the caller's arrays gives the same numbers, and what lies between the elements is left alone.
program test_layouts
   use, intrinsic :: iso_fortran_env, only: real32, real64
   use checks, only: check, finish, same_bits, test
   use holonomic, only: hol_chains, hol_report, hol_worst, HOL_OK
   implicit none

   type :: atom
      real(real64) :: mass
      real(real64) :: r(3), v(3)
      integer :: tag
      real(real64) :: g(3)
   end type

   integer, parameter :: n = 7
   type(hol_chains) :: chains
   real(real64), dimension(3, n) :: r, v, f, g, moved, moved_v, moved_r
   real(real64) :: lambda(n - 1), length(n - 1), virial(3, 3)
   real(real64), parameter :: dt = 0.01_real64
   type(hol_worst) :: worst
   integer :: i

   call random_init(.true., .true.)
   call random_number(r)
   call random_number(v)
   call random_number(f)
   r = r + reshape([(real(i, real64), 0.0_real64, 0.0_real64, i=1, n)], [3, n])
   length = norm2(r(:, 2:) - r(:, :n - 1), dim=1)
   call chains%create([(1 + 0.25_real64*i, i=1, n)])
   call chains%add([(i, i=1, n)], length)
   call chains%forces(r, v, f, lambda, g=g, virial=virial)
   moved_v = v
   moved_r = r + dt*v
   call chains%project_positions(r, moved_r, dt, moved_v)
   moved = moved_v
   call chains%project_velocities(moved_r, moved)
   call chains%violation(r, v, worst)

   call sections_of_a_matrix()
   call reversed_order()
   call components_of_a_record()
   call separate_arrays()
   call separate_arrays_of_different_strides()
   call larger_arrays()
   call a_section_per_bond()
   call single_precision()
   call two_dimensions()
   call added_forces()
   call no_atoms()
   call chains%destroy()
   call finish()

contains

   subroutine sections_of_a_matrix()
      real(real64), dimension(5, 2*n) :: wide_r, wide_v, wide_g
      call test("sections of a matrix are used as they stand")
      wide_r = -7
      wide_v = -7
      wide_g = -7
      wide_r(2:4, ::2) = r
      wide_v(5:1:-2, 2::2) = v
      call chains%forces(wide_r(2:4, ::2), wide_v(5:1:-2, 2::2), f, g=wide_g(1:5:2, 2::2))
      call check(all(same_bits(wide_g(1:5:2, 2::2), g)), "the same forces")
      call check(all(same_bits(wide_g(2:4:2, :), -7.0_real64)) .and. all(same_bits(wide_g(:, 1::2), -7.0_real64)), &
                 "nothing between them is written")
   end subroutine

   subroutine reversed_order()
      type(hol_chains) :: backwards
      real(real64), dimension(3, n) :: r2, v2, f2, g2
      call test("negative strides")
      r2 = r(:, n:1:-1)
      v2 = v(:, n:1:-1)
      f2 = f(:, n:1:-1)
      call backwards%create([(1 + 0.25_real64*i, i=1, n)])
      call backwards%add([(i, i=1, n)], length)
      call backwards%forces(r2(:, n:1:-1), v2(:, n:1:-1), f2(:, n:1:-1), g=g2(:, n:1:-1))
      call check(all(same_bits(g2(:, n:1:-1), g)), "the same forces")
      call backwards%destroy()
   end subroutine

   subroutine components_of_a_record()
      type(atom) :: atoms(n)
      integer :: k
      call test("components of a derived type")
      do k = 1, n
         atoms(k) = atom(1.0_real64, r(:, k), v(:, k), k, [1, 2, 3])
      end do
      call chains%forces(atoms%r(1), atoms%r(2), atoms%r(3), atoms%v(1), atoms%v(2), atoms%v(3), f(1, :), f(2, :), &
                         f(3, :), gx=atoms%g(1), gy=atoms%g(2), gz=atoms%g(3))
      call check(all([(all(same_bits(atoms(k)%g, g(:, k))), k=1, n)]), "the same forces")
      call check(all(atoms%tag == [(k, k=1, n)]), "other components are left alone")
      do k = 1, n
         atoms(k)%r = r(:, k) + dt*v(:, k)
      end do
      call chains%project_positions(r(1, :), r(2, :), r(3, :), atoms%r(1), atoms%r(2), atoms%r(3), dt, &
                                    atoms%v(1), atoms%v(2), atoms%v(3))
      call check(all([(all(same_bits(atoms(k)%r, moved_r(:, k))), k=1, n)]), "the same positions")
      call check(all([(all(same_bits(atoms(k)%v, moved_v(:, k))), k=1, n)]), "the same velocities")
      call chains%project_velocities(atoms%r(1), atoms%r(2), atoms%r(3), atoms%v(1), atoms%v(2), atoms%v(3))
      call check(all([(all(same_bits(atoms(k)%v, moved(:, k))), k=1, n)]), "the same projected velocities")
   end subroutine

   subroutine separate_arrays()
      real(real64), dimension(n) :: x, y, z, vx, vy, vz
      type(hol_worst) :: again
      call test("separate arrays")
      x = r(1, :)
      y = r(2, :)
      z = r(3, :)
      vx = v(1, :)
      vy = v(2, :)
      vz = v(3, :)
      call chains%violation(x, y, z, vx, vy, vz, again)
      call check(same_bits(again%length, worst%length) .and. same_bits(again%rate, worst%rate), "the same violation")
      call check(again%rate_bond == worst%rate_bond .and. again%rate_molecule == 1, "at the same place, counted from 1")
      x = x + dt*vx
      y = y + dt*vy
      z = z + dt*vz
      call chains%project_positions(r(1, :), r(2, :), r(3, :), x, y, z, dt, vx, vy, vz)
      call check(all(same_bits(x, moved_r(1, :))) .and. all(same_bits(z, moved_r(3, :))), "the same positions")
      call check(all(same_bits(vy, moved_v(2, :))), "the same velocities")
      call chains%project_velocities(x, y, z, vx, vy, vz)
      call check(all(same_bits(vx, moved(1, :))) .and. all(same_bits(vy, moved(2, :))), "the same projected velocities")
   end subroutine

   subroutine separate_arrays_of_different_strides()
      real(real64) :: x(n), y(2*n), z(3*n), gx(3*n), gy(n), gz(2*n), vx(2*n), vy(n), vz(n), again(3, n)
      call test("separate arrays with a stride each")
      y = -7
      z = -7
      gx = -7
      gz = -7
      x = r(1, n:1:-1)
      y(::2) = r(2, :)
      z(3::3) = r(3, :)
      call chains%forces(x(n:1:-1), y(::2), z(3::3), v(1, :), v(2, :), v(3, :), f(1, :), f(2, :), f(3, :), &
                         gx=gx(2::3), gy=gy, gz=gz(::2))
      call check(all(same_bits(gx(2::3), g(1, :))), "gx")
      call check(all(same_bits(gy, g(2, :))), "gy")
      call check(all(same_bits(gz(::2), g(3, :))), "gz")
      call check(all(same_bits(gx(1::3), -7.0_real64)) .and. all(same_bits(gz(2::2), -7.0_real64)), &
                 "nothing between them is written")
      call chains%metric(x(n:1:-1), y(::2), z(3::3), 1.0_real64, fx=gx(3::3), fy=gy, fz=gz(2::2))
      call chains%metric(r, 1.0_real64, force=again)
      call check(all(same_bits(gx(3::3), again(1, :))) .and. all(same_bits(gz(2::2), again(3, :))), "metric")
      vx = -7
      vx(::2) = v(1, :)
      vy = v(2, n:1:-1)
      vz = v(3, :)
      x = x + dt*vx(2*n - 1:1:-2)
      y(::2) = y(::2) + dt*v(2, :)
      z(3::3) = z(3::3) + dt*v(3, :)
      call chains%project_positions(r(1, :), r(2, :), r(3, :), x(n:1:-1), y(::2), z(3::3), dt, vx(::2), vy(n:1:-1), vz)
      call check(all(same_bits(x(n:1:-1), moved_r(1, :))) .and. all(same_bits(z(3::3), moved_r(3, :))), "positions")
      call check(all(same_bits(vx(::2), moved_v(1, :))) .and. all(same_bits(vy(n:1:-1), moved_v(2, :))), &
                 "velocities of positions")
      call chains%project_velocities(x(n:1:-1), y(::2), z(3::3), vx(::2), vy(n:1:-1), vz)
      call check(all(same_bits(vx(::2), moved(1, :))) .and. all(same_bits(vz, moved(3, :))), "velocities")
      call check(all(same_bits(y(2::2), -7.0_real64)) .and. all(same_bits(vx(2::2), -7.0_real64)), &
                 "nothing between these is written either")
   end subroutine

   subroutine larger_arrays()
      real(real64) :: big_r(3, 20), big_g(3, 20), big_lambda(50)
      call test("arrays dimensioned for the worst case")
      big_r = -7
      big_g = -7
      big_lambda = -7
      big_r(:, :n) = r
      call chains%forces(big_r, lambda=big_lambda, g=big_g)
      call check(all(same_bits(big_g(:, n + 1:), -7.0_real64)), "atoms beyond the last are left alone")
      call check(all(same_bits(big_lambda(n:), -7.0_real64)), "bonds beyond the last are left alone")
   end subroutine

   subroutine a_section_per_bond()
      real(real64) :: sparse(2*n)
      call test("a section as an array per bond")
      sparse = -7
      call chains%forces(r, v, f, lambda=sparse(2:2*(n - 1):2))
      call check(all(same_bits(sparse(2:2*(n - 1):2), lambda)), "the same multipliers")
      call check(all(same_bits(sparse(1::2), -7.0_real64)), "nothing between them is written")
   end subroutine

   subroutine single_precision()
      real(real32), dimension(3, n) :: r4, v4, g4, a4, b4, u4
      real(real32), parameter :: dt4 = 0.0078125_real32   ! 2^-7, the same in both precisions
      real(real32), dimension(n) :: x4, y4, z4
      real(real64), dimension(3, n) :: g8
      real(real64), dimension(n - 1) :: lambda4, lambda8
      type(hol_worst) :: worst4
      type(hol_report) :: report
      call test("single precision")
      r4 = real(r, real32)
      v4 = real(v, real32)
      call chains%forces(real(r4, real64), real(v4, real64), lambda=lambda8, g=g8)
      call chains%forces(r4, v4, lambda=lambda4, g=g4)
      call check(all(same_bits(lambda4, lambda8)), "multipliers have the precision of double arithmetic")
      call check(all(same_bits(g4, real(g8, real32))), "forces are the rounded ones")
      call chains%forces(r4(1, :), r4(2, :), r4(3, :), v4(1, :), v4(2, :), v4(3, :), gx=x4, gy=y4, gz=z4)
      call check(all(same_bits(x4, g4(1, :))) .and. all(same_bits(z4, g4(3, :))), "separate arrays give the same")
      a4 = r4 + real(dt, real32)*v4
      call chains%project_positions(r4, a4, dt, v4, report=report)
      call check(report%n_corrected == 1, "positions are projected")
      call chains%violation(a4, worst=worst4)
      ! The coordinates, up to 8, carry eps(real32)/2 times 8 each, and there are two of them in a bond of about 1.
      call check(worst4%length < 32*epsilon(1.0_real32), "to the rounding of single precision")
      call chains%project_velocities(a4, v4)
      call chains%violation(a4, v4, worst4)
      call check(worst4%rate < 8*epsilon(1.0_real32), "velocities too")
      a4 = r4 + dt4*v4
      b4 = a4
      u4 = v4
      call chains%project_positions(r4, a4, dt4, v4)
      call chains%project_positions(r4, b4, real(dt4, real64), u4)
      call check(all(same_bits(a4, b4)) .and. all(same_bits(v4, u4)), "dt of either precision")
      x4 = r4(1, :) + dt4*u4(1, :)
      y4 = r4(2, :) + dt4*u4(2, :)
      z4 = r4(3, :) + dt4*u4(3, :)
      a4 = r4 + dt4*u4
      call chains%project_positions(r4(1, :), r4(2, :), r4(3, :), x4, y4, z4, dt4)
      call chains%project_positions(r4, a4, dt4)
      call check(all(same_bits(x4, a4(1, :))) .and. all(same_bits(z4, a4(3, :))), "of separate arrays, too")
   end subroutine

   subroutine two_dimensions()
      real(real64), dimension(2, n) :: g2
      real(real64), dimension(n) :: gx, gy
      real(real64), dimension(3, n) :: flat_r, flat_v, flat_g
      call test("two dimensions")
      flat_r = r
      flat_r(3, :) = 0
      flat_v = v
      flat_v(3, :) = 0
      call chains%forces(flat_r, flat_v, g=flat_g)
      call chains%forces(r(:2, :), v(:2, :), g=g2)
      call check(all(same_bits(g2, flat_g(:2, :))), "arrays (2, n) are z = 0")
      call chains%forces(r(1, :), r(2, :), vx=v(1, :), vy=v(2, :), gx=gx, gy=gy)
      call check(all(same_bits(gx, flat_g(1, :))) .and. all(same_bits(gy, flat_g(2, :))), "x and y without z are, too")
      call check(chains%degrees_of_freedom(2) == 2*n - (n - 1), "degrees of freedom")
   end subroutine

   subroutine added_forces()
      real(real64), dimension(3, n) :: total, in_place
      real(real64), dimension(n) :: fx, fy, fz
      call test("constraint forces are added to what is there")
      total = f
      call chains%forces(r, v, f, g=total, add=.true.)
      call check(all(same_bits(total, f + g)), "forces with add")
      in_place = f
      call chains%add_forces(r, v, in_place)
      call check(all(same_bits(in_place, total)), "add_forces")
      fx = f(1, :)
      fy = f(2, :)
      fz = f(3, :)
      call chains%add_forces(r(1, :), r(2, :), r(3, :), v(1, :), v(2, :), v(3, :), fx, fy, fz)
      call check(all(same_bits(fx, total(1, :))) .and. all(same_bits(fz, total(3, :))), "add_forces of separate arrays")
      total = f
      call chains%forces(r, v, f, g=total, add=.false.)
      call check(all(same_bits(total, g)), "add = .false. replaces")
   end subroutine

   subroutine no_atoms()
      type(hol_chains) :: none
      real(real64) :: nothing(3, 0), empty(0)
      integer :: stat
      call test("no atoms at all")
      call none%create(empty)
      call none%forces(nothing, g=nothing, lambda=empty, stat=stat)
      call check(stat == HOL_OK, "nothing to do is no error")
      call none%forces(empty, empty, empty, stat=stat)
      call check(stat == HOL_OK, "nor with separate arrays")
      call check(none%n_atoms() == 0 .and. none%n_bonds() == 0, "counts")
      call none%destroy()
   end subroutine

end program
