C     As rotor_free.f90, as an old program would have it: separate
C     coordinate arrays, index list in an array of default integers.
      PROGRAM ROTOR
      USE HOLONOMIC
      IMPLICIT NONE
      TYPE(HOL_CHAINS) CHAINS
      DOUBLE PRECISION X(2), Y(2), Z(2), VX(2), VY(2), VZ(2)
      DOUBLE PRECISION GX(2), GY(2), GZ(2), A(1), T(1), AM(2)
      INTEGER LIST(2), ISTAT
      DATA X /-1D0, 1D0/, Y /2*0D0/, Z /2*0D0/
      DATA VX /2*0D0/, VY /-1D0, 1D0/, VZ /2*0D0/
      DATA A /2D0/, AM /2*1D0/, LIST /1, 2/
      CALL CHAINS%CREATE(AM)
      CALL CHAINS%ADD(LIST, A)
      CALL CHAINS%FORCES(X, Y, Z, VX, VY, VZ, GX=GX, GY=GY, GZ=GZ,
     &                   TENSION=T)
      WRITE (*, '(2A)') 'holonomic ', HOL_VERSION()
      WRITE (*, '(A,F5.3,A,F5.3,1X,F6.3)')
     &   'tension ', T(1), ' forces ', GX(1), GX(2)
      CALL CHAINS%ADD(LIST, A, STAT=ISTAT)
      WRITE (*, '(2A)') 'again: ', HOL_STATUS_NAME(ISTAT)
      CALL CHAINS%DESTROY
      END
