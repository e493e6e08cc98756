! Any bonds as a dense problem in quadruple precision: what the library's answers for molecules are compared with.
module dense_bonds
   use, intrinsic :: iso_fortran_env, only: real128, real64
   implicit none
   private
   public :: along_bonds, curvature, dense_multipliers, rates

   ! Where a compiler has no quadruple precision, double has to do.
   integer, parameter :: qp = merge(real128, real64, real128 > 0)

contains

   ! Z lambda = rhs, Z_kl = sum_i w_i grad_i sigma_k . grad_i sigma_l; fixed atoms have w = 0.
   function dense_multipliers(bonds, w, r, rhs) result(lambda)
      integer, intent(in) :: bonds(:, :)
      real(real64), intent(in) :: w(:), r(:, :), rhs(:)
      real(real64) :: lambda(size(rhs))
      real(qp), allocatable :: gradient(:, :, :), z(:, :), b(:)
      integer :: k, l, n
      n = size(bonds, 2)
      allocate (gradient(3, size(w), n), z(n, n), b(n))
      gradient = 0
      do k = 1, n
         gradient(:, bonds(2, k), k) = 2*(real(r(:, bonds(2, k)), qp) - real(r(:, bonds(1, k)), qp))
         gradient(:, bonds(1, k), k) = -gradient(:, bonds(2, k), k)
      end do
      do k = 1, n
         do l = 1, n
            z(k, l) = sum(spread(real(w, qp), 1, 3)*gradient(:, :, k)*gradient(:, :, l))
         end do
      end do
      b = real(rhs, qp)
      do k = 1, n   ! Gauss, without pivoting: Z is positive definite
         do l = k + 1, n
            b(l) = b(l) - z(l, k)/z(k, k)*b(k)
            z(l, :) = z(l, :) - z(l, k)/z(k, k)*z(k, :)
         end do
      end do
      do k = n, 1, -1
         b(k) = (b(k) - dot_product(z(k, k + 1:), b(k + 1:)))/z(k, k)
      end do
      lambda = real(b, real64)
   end function

   ! The right-hand side of forces: 2 d . (w_j f_j - w_i f_i) + 2 |v_j - v_i|^2
   function curvature(bonds, w, r, v, f) result(rhs)
      integer, intent(in) :: bonds(:, :)
      real(real64), intent(in) :: w(:), r(:, :), v(:, :), f(:, :)
      real(real64) :: rhs(size(bonds, 2))
      integer :: k, i, j
      do k = 1, size(rhs)
         i = bonds(1, k)
         j = bonds(2, k)
         rhs(k) = 2*dot_product(r(:, j) - r(:, i), w(j)*f(:, j) - w(i)*f(:, i)) + 2*sum((v(:, j) - v(:, i))**2)
      end do
   end function

   ! d . (v_j - v_i)
   function rates(bonds, r, v)
      integer, intent(in) :: bonds(:, :)
      real(real64), intent(in) :: r(:, :), v(:, :)
      real(real64) :: rates(size(bonds, 2))
      integer :: k
      do k = 1, size(rates)
         rates(k) = dot_product(r(:, bonds(2, k)) - r(:, bonds(1, k)), v(:, bonds(2, k)) - v(:, bonds(1, k)))
      end do
   end function

   ! G = - sum lambda grad sigma, along the bonds at r
   function along_bonds(bonds, lambda, r) result(g)
      integer, intent(in) :: bonds(:, :)
      real(real64), intent(in) :: lambda(:), r(:, :)
      real(real64) :: g(3, size(r, 2)), pull(3)
      integer :: k
      g = 0
      do k = 1, size(lambda)
         pull = 2*lambda(k)*(r(:, bonds(2, k)) - r(:, bonds(1, k)))
         g(:, bonds(1, k)) = g(:, bonds(1, k)) + pull
         g(:, bonds(2, k)) = g(:, bonds(2, k)) - pull
      end do
   end function

end module
