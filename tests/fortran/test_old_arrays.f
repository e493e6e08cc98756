C     Arrays RX(N, NA), N molecules of NA atoms, as old codes have them:
C     atom A of molecule M is number M + (A - 1)*N in memory. They are
C     passed as one-dimensional arrays in the three ways of
C     docs/fortran.md, and each must give what separate copies give.
      PROGRAM OLDARR
      USE HOLONOMIC
      USE CHECKS, ONLY: CHECK, FINISH, SAME_BITS, TEST
      IMPLICIT NONE
      INTEGER N, NA, M, I
      PARAMETER (N = 5, NA = 4)
      DOUBLE PRECISION, TARGET :: RX(N, NA), RY(N, NA), RZ(N, NA)
      DOUBLE PRECISION GX(N, NA), GY(N, NA), GZ(N, NA)
      DOUBLE PRECISION RX1(N*NA), RY1(N*NA), RZ1(N*NA)
      DOUBLE PRECISION GX1(N*NA), GY1(N*NA), GZ1(N*NA)
      EQUIVALENCE (GX, GX1), (GY, GY1), (GZ, GZ1)
      DOUBLE PRECISION FX(N*NA), FY(N*NA), FZ(N*NA), R(3, N*NA)
      DOUBLE PRECISION V(3, N*NA), G(3, N*NA), AM(N*NA), T(N*(NA-1))
      DOUBLE PRECISION, POINTER :: PX(:), PY(:), PZ(:)
      TYPE(HOL_CHAINS) CHAINS
      CALL TEST('arrays RX(N, NA)')
      CALL RANDOM_INIT(.TRUE., .TRUE.)
      AM = 1.0D0
      DO 20 M = 1, N
         DO 10 I = 1, NA
            RX(M, I) = 0.8D0*I
            RY(M, I) = 0.6D0*MOD(I, 2)
            RZ(M, I) = 3.0D0*M
   10    CONTINUE
   20 CONTINUE
      RX1 = RESHAPE(RX, [N*NA])
      RY1 = RESHAPE(RY, [N*NA])
      RZ1 = RESHAPE(RZ, [N*NA])
      CALL RANDOM_NUMBER(V)
      CALL CHAINS%CREATE(AM)
      DO 30 M = 1, N
         CALL CHAINS%ADD([(M + (I - 1)*N, I = 1, NA)], 1.0D0)
   30 CONTINUE
C     What is right: a copy (3, n)
      R(1, :) = RX1
      R(2, :) = RY1
      R(3, :) = RZ1
      CALL CHAINS%FORCES(R, V, TENSION=T, G=G)
      CALL CHECK(MAXVAL(ABS(G)) .GT. 0.1D0, 'there are forces')
      CALL CHECK(ABS(SUM(G(1, 2::N))) .LT. 1D-14,
     &           'none on molecule 2 as a whole')
C     EQUIVALENCE, here of the constraint forces
      CALL CHAINS%FORCES(RX1, RY1, RZ1, V(1, :), V(2, :), V(3, :),
     &                   GX=GX1, GY=GY1, GZ=GZ1)
      CALL CHECK(ALL(SAME_BITS(GX(2, :), G(1, 2::N))) .AND.
     &           ALL(SAME_BITS(GZ(N, :), G(3, N::N))), 'EQUIVALENCE')
C     A pointer of one dimension
      PX(1:N*NA) => RX
      PY(1:N*NA) => RY
      PZ(1:N*NA) => RZ
      CALL CHAINS%FORCES(PX, PY, PZ, V(1, :), V(2, :), V(3, :),
     &                   GX=FX, GY=FY, GZ=FZ)
      CALL CHECK(ALL(SAME_BITS(FX, G(1, :))) .AND.
     &           ALL(SAME_BITS(FY, G(2, :))), 'pointers')
C     A subroutine between, whose arrays are of one dimension
      FX = 0.0D0
      CALL BETWEEN(N*NA, RX, RY, RZ, FX, FY, FZ)
      CALL CHECK(ALL(SAME_BITS(FX, G(1, :))) .AND.
     &           ALL(SAME_BITS(FZ, G(3, :))), 'a subroutine')
      CALL CHAINS%DESTROY()
      CALL FINISH()

      CONTAINS

      SUBROUTINE BETWEEN(NATOMS, X, Y, Z, HX, HY, HZ)
      INTEGER NATOMS
      DOUBLE PRECISION X(NATOMS), Y(NATOMS), Z(NATOMS)
      DOUBLE PRECISION HX(NATOMS), HY(NATOMS), HZ(NATOMS)
      CALL CHAINS%FORCES(X, Y, Z, V(1, :), V(2, :), V(3, :),
     &                   GX=HX, GY=HY, GZ=HZ)
      END SUBROUTINE

      END PROGRAM
