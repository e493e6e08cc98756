! Bonds whose periodic images are told, in numbers of box vectors. Each procedure takes integers of 32 or 64 bits, and
! reals likewise.
module holonomic_images
   use, intrinsic :: iso_c_binding, only: c_int64_t, c_loc, c_ptr
   use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64
   use holonomic_c, only: hol_chains_add_bonds_with_images, hol_chains_images, hol_chains_n_bonds, hol_chains_set_images, &
                          HOL_ERR_VALUE
   use holonomic_linear, only: chain_set_linear
   use holonomic_rigid, only: take_bonds
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: chain_set_images

   type, extends(chain_set_linear) :: chain_set_images
   contains
      procedure, private :: add_with_images_32_32, add_with_images_32_64, add_with_images_64_32, add_with_images_64_64
      procedure, private :: set_images_32, set_images_64, images_32, images_64
      ! add_with_images(bonds, lengths, images): images(3, n_bonds), by which box vectors the second atom of a bond is moved.
      generic :: add_with_images => add_with_images_32_32, add_with_images_32_64, add_with_images_64_32, &
         add_with_images_64_64
      ! Of all bonds of the set; 0 for those that were added without.
      generic :: set_images => set_images_32, set_images_64
      generic :: images => images_32, images_64
   end type

contains

#define INTEGERS 32
#define REALS 32
#define ADD_WITH_IMAGES add_with_images_32_32
#define SET_IMAGES set_images_32
#define GET_IMAGES images_32
#include "images.inc"
#define INTEGERS 32
#define REALS 64
#define ADD_WITH_IMAGES add_with_images_32_64
#include "images.inc"
#define INTEGERS 64
#define REALS 32
#define ADD_WITH_IMAGES add_with_images_64_32
#define SET_IMAGES set_images_64
#define GET_IMAGES images_64
#include "images.inc"
#define INTEGERS 64
#define REALS 64
#define ADD_WITH_IMAGES add_with_images_64_64
#include "images.inc"

   subroutine check_shape(name, extents, n_bonds, problem)
      character(*), intent(in) :: name
      integer(int64), intent(in) :: extents(2), n_bonds
      type(failure), intent(inout) :: problem
      if (extents(1) /= 3 .or. extents(2) /= n_bonds) &
         call problem%set(HOL_ERR_VALUE, name//" must be (3, "//decimal(n_bonds)//")")
   end subroutine

   subroutine add_all(self, bonds, lengths, images, stat, errmsg)
      class(chain_set_images), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: bonds(:, :), images(:, :)
      real(real64), intent(in), contiguous, target :: lengths(:)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      type(c_ptr) :: pairs, of_pairs
      integer(c_int64_t) :: n_bonds
      call problem%need_created(self%c_handle())
      call take_bonds(bonds, lengths, n_bonds, pairs, of_pairs, problem)
      if (problem%none()) call check_shape("images", shape(images, int64), n_bonds, problem)
      if (problem%none() .and. n_bonds > 0) &
         call problem%ask(hol_chains_add_bonds_with_images(self%c_handle(), n_bonds, pairs, of_pairs, c_loc(images)))
      call settle(problem, "add_with_images", stat, errmsg)
   end subroutine

   subroutine set_all(self, images, stat, errmsg)
      class(chain_set_images), intent(inout) :: self
      integer(int64), intent(in), contiguous, target :: images(:, :)
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      call problem%need_created(self%c_handle())
      if (problem%none()) call check_shape("images", shape(images, int64), hol_chains_n_bonds(self%c_handle()), problem)
      if (problem%none() .and. size(images) > 0) call problem%ask(hol_chains_set_images(self%c_handle(), c_loc(images)))
      call settle(problem, "set_images", stat, errmsg)
   end subroutine

end module
