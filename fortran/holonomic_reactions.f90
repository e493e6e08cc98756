! What given multipliers do: hol_reactions with arrays of any layout.
module holonomic_reactions
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64, real32, real64
   use holonomic_c, only: hol_reactions_view, HOL_ADD, HOL_BOX, HOL_ERR_VALUE, HOL_REFERENCE_BOX, &
                          HOL_WRITE
   use holonomic_place, only: enough, list_of, place, tensor
   use holonomic_solve, only: chain_set_solve
   use holonomic_status, only: decimal, failure, settle
   implicit none
   private
   public :: chain_set_reactions

   type, extends(chain_set_solve) :: chain_set_reactions
   contains
      procedure, private :: reactions_rows_32, reactions_rows_64, reactions_parts_32, reactions_parts_64
      ! bond_virial (6, n_bonds): xx xy xz yy yz zz. reference: the positions belong to the box of set_reference_box.
      generic :: reactions => reactions_rows_32, reactions_rows_64, reactions_parts_32, reactions_parts_64
   end type

contains

   recursive subroutine reactions_rows_64(self, r, lambda, tension, g, add, bond_virial, virial, &
                                           reference, stat, errmsg)
      class(chain_set_reactions), intent(in) :: self
      real(real64), intent(in), target :: r(:, :)
      real(real64), intent(in), contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, contiguous, target :: tension(:)
      real(real64), intent(inout), optional, target :: g(:, :)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, contiguous, target :: bond_virial(:, :)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      logical, intent(in), optional :: reference
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_g
      n_atoms = self%n_atoms()
      call at_r%rows_64(n_atoms, problem, "r", r)
      call at_g%rows_64(n_atoms, problem, "g", g)
      call reactions_at(self, problem, at_r, lambda, tension, at_g, add, bond_virial, virial, reference, stat, errmsg)
   end subroutine

   recursive subroutine reactions_rows_32(self, r, lambda, tension, g, add, bond_virial, virial, &
                                           reference, stat, errmsg)
      class(chain_set_reactions), intent(in) :: self
      real(real32), intent(in), target :: r(:, :)
      real(real64), intent(in), contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, contiguous, target :: tension(:)
      real(real32), intent(inout), optional, target :: g(:, :)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, contiguous, target :: bond_virial(:, :)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      logical, intent(in), optional :: reference
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_g
      n_atoms = self%n_atoms()
      call at_r%rows_32(n_atoms, problem, "r", r)
      call at_g%rows_32(n_atoms, problem, "g", g)
      call reactions_at(self, problem, at_r, lambda, tension, at_g, add, bond_virial, virial, reference, stat, errmsg)
   end subroutine

   recursive subroutine reactions_parts_64(self, x, y, z, lambda, tension, gx, gy, gz, add, &
                                           bond_virial, virial, reference, stat, errmsg)
      class(chain_set_reactions), intent(in) :: self
      real(real64), intent(in), target :: x(:), y(:)
      real(real64), intent(in), optional, target :: z(:)
      real(real64), intent(in), contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, contiguous, target :: tension(:)
      real(real64), intent(inout), optional, target :: gx(:), gy(:), gz(:)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, contiguous, target :: bond_virial(:, :)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      logical, intent(in), optional :: reference
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_g
      n_atoms = self%n_atoms()
      call at_r%parts_64(n_atoms, problem, "*", x, y, z)
      call at_g%parts_64(n_atoms, problem, "g*", gx, gy, gz)
      call reactions_at(self, problem, at_r, lambda, tension, at_g, add, bond_virial, virial, reference, stat, errmsg)
   end subroutine

   recursive subroutine reactions_parts_32(self, x, y, z, lambda, tension, gx, gy, gz, add, &
                                           bond_virial, virial, reference, stat, errmsg)
      class(chain_set_reactions), intent(in) :: self
      real(real32), intent(in), target :: x(:), y(:)
      real(real32), intent(in), optional, target :: z(:)
      real(real64), intent(in), contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, contiguous, target :: tension(:)
      real(real32), intent(inout), optional, target :: gx(:), gy(:), gz(:)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, contiguous, target :: bond_virial(:, :)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      logical, intent(in), optional :: reference
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(failure) :: problem
      integer(int64) :: n_atoms
      type(place), target :: at_r, at_g
      n_atoms = self%n_atoms()
      call at_r%parts_32(n_atoms, problem, "*", x, y, z)
      call at_g%parts_32(n_atoms, problem, "g*", gx, gy, gz)
      call reactions_at(self, problem, at_r, lambda, tension, at_g, add, bond_virial, virial, reference, stat, errmsg)
   end subroutine

   recursive subroutine reactions_at(self, problem, at_r, lambda, tension, at_g, add, bond_virial, &
                                           virial, reference, stat, errmsg)
      class(chain_set_reactions), intent(in) :: self
      type(failure), intent(inout) :: problem
      type(place), intent(in), target :: at_r, at_g
      real(real64), intent(in), contiguous, target :: lambda(:)
      real(real64), intent(inout), optional, contiguous, target :: tension(:)
      logical, intent(in), optional :: add
      real(real64), intent(inout), optional, contiguous, target :: bond_virial(:, :)
      real(real64), intent(inout), optional, target :: virial(3, 3)
      logical, intent(in), optional :: reference
      integer, intent(out), optional :: stat
      character(*), intent(inout), optional :: errmsg
      type(c_ptr) :: at_lambda, at_tension, at_bonds
      integer(c_int) :: mode, box
      call problem%need_created(self%c_handle())
      mode = HOL_WRITE
      if (present(add)) mode = merge(HOL_ADD, HOL_WRITE, add)
      box = HOL_BOX
      if (present(reference)) box = merge(HOL_REFERENCE_BOX, HOL_BOX, reference)
      at_lambda = list_of(lambda, "lambda", self%n_bonds(), "bonds", problem)
      at_tension = list_of(tension, "tension", self%n_bonds(), "bonds", problem)
      at_bonds = c_null_ptr
      if (present(bond_virial)) then
         if (size(bond_virial, 1) /= 6) then
            call problem%set(HOL_ERR_VALUE, "bond_virial has "//decimal(size(bond_virial, 1, kind=c_int64_t))// &
                             " rows; it must have 6")
         else if (enough("bond_virial", size(bond_virial, 2, kind=c_int64_t), self%n_bonds(), "bonds", problem)) then
            at_bonds = c_loc(bond_virial)
         end if
      end if
      if (problem%none()) then
         call problem%ask(hol_reactions_view(self%c_handle(), at_r%address(), box, at_lambda, at_tension, &
                                             at_g%address(), mode, at_bonds, tensor(virial)))
         call at_g%give_back()
      end if
      call settle(problem, "reactions", stat, errmsg)
   end subroutine

end module
