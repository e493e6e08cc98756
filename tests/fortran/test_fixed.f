C     A caller in fixed form: separate arrays, DOUBLE PRECISION, an
C     index list of default integers, STAT and ERRMSG.
      PROGRAM FIXED
      USE HOLONOMIC
      USE CHECKS, ONLY: CHECK, FINISH, TEST
      IMPLICIT NONE
      INTEGER MAXAT
      PARAMETER (MAXAT = 10)
      TYPE(HOL_CHAINS) CHAINS
      TYPE(HOL_WORST) WORST
      DOUBLE PRECISION X(MAXAT), Y(MAXAT), Z(MAXAT)
      DOUBLE PRECISION XOLD(MAXAT), YOLD(MAXAT), ZOLD(MAXAT)
      DOUBLE PRECISION VX(MAXAT), VY(MAXAT), VZ(MAXAT)
      DOUBLE PRECISION FX(MAXAT), FY(MAXAT), FZ(MAXAT)
      DOUBLE PRECISION GX(MAXAT), GY(MAXAT), GZ(MAXAT)
      DOUBLE PRECISION AM(3), A(2), T(2), DT
      INTEGER LIST(3), ISTAT, I
      CHARACTER(LEN=80) TEXT
      DATA AM /3*1.0D0/, A /2*1.0D0/, LIST /3, 1, 2/, DT /0.01D0/
      CALL TEST('fixed form')
      DO 10 I = 1, MAXAT
         X(I) = 0.0D0
         Y(I) = 0.0D0
         Z(I) = 0.0D0
         VX(I) = 0.0D0
         VY(I) = 0.0D0
         VZ(I) = 0.0D0
         FX(I) = 0.0D0
         FY(I) = 0.0D0
         FZ(I) = 0.0D0
   10 CONTINUE
C     A straight chain, 3 - 1 - 2 along x, pulled at both ends with 5.
      X(3) = -1.0D0
      X(2) = 1.0D0
      FX(3) = -5.0D0
      FX(2) = 5.0D0
      CALL CHAINS%CREATE(AM)
      CALL CHAINS%ADD(LIST, A)
      CALL CHAINS%FORCES(X, Y, Z, VX, VY, VZ, FX, FY, FZ, TENSION=T,
     &                   GX=GX, GY=GY, GZ=GZ)
      CALL CHECK(ABS(T(1) - 5) .LT. 1D-14 .AND.
     &           ABS(T(2) - 5) .LT. 1D-14, 'tension')
      CALL CHECK(ABS(GX(3) - 5) .LT. 1D-14 .AND.
     &           ABS(GX(2) + 5) .LT. 1D-14, 'constraint forces')
      DO 20 I = 1, 3
         XOLD(I) = X(I)
         YOLD(I) = Y(I)
         ZOLD(I) = Z(I)
         VY(I) = 0.1D0*I
         X(I) = X(I) + DT*VX(I)
         Y(I) = Y(I) + DT*VY(I)
   20 CONTINUE
      CALL CHAINS%PROJECT_POSITIONS(XOLD, YOLD, ZOLD, X, Y, Z, DT,
     &                              VX, VY, VZ)
      CALL CHAINS%PROJECT_VELOCITIES(X, Y, Z, VX, VY, VZ)
      CALL CHAINS%VIOLATION(X, Y, Z, VX, VY, VZ, WORST)
      CALL CHECK(WORST%LENGTH .LT. 1D-14 .AND. WORST%RATE .LT. 1D-14,
     &           'positions and velocities')
      CALL CHAINS%ADD(LIST, A, STAT=ISTAT, ERRMSG=TEXT)
      CALL CHECK(ISTAT .EQ. HOL_ERR_SHARED_ATOM .AND.
     &           INDEX(TEXT, 'atom 3') .GT. 0, 'STAT and ERRMSG')
      CALL CHAINS%DESTROY()
      CALL FINISH()
      END
