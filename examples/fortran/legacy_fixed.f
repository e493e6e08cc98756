C     A chain of 20 beads hangs by its first one and swings under its
C     weight: an old program in fixed form, with separate coordinate
C     arrays dimensioned for the worst case, to which rigid bonds were
C     added.  The lines that were added lie between C>>> and C<<<.
C
C     No options.  Prints the energy and the largest relative error of
C     the squared bond lengths along the run.
      PROGRAM LEGACY
C>>>
      USE HOLONOMIC
C<<<
      IMPLICIT NONE
      INTEGER MAXAT, NSTEP
      PARAMETER (MAXAT = 100, NSTEP = 20000)
      DOUBLE PRECISION DT, GRAV
      PARAMETER (DT = 1.0D-3, GRAV = 9.81D0)
      INTEGER NATOM
      DOUBLE PRECISION X, Y, Z, VX, VY, VZ, FX, FY, FZ, AM
      COMMON /ATOMS/ X(MAXAT), Y(MAXAT), Z(MAXAT),
     &               VX(MAXAT), VY(MAXAT), VZ(MAXAT),
     &               FX(MAXAT), FY(MAXAT), FZ(MAXAT), AM(MAXAT), NATOM
      DOUBLE PRECISION EKIN, EPOT, E0, WORSTB
      INTEGER I, ISTEP
C>>>
      TYPE(HOL_CHAINS) CHAINS
      TYPE(HOL_WORST) WORST
      DOUBLE PRECISION XOLD(MAXAT), YOLD(MAXAT), ZOLD(MAXAT)
      DOUBLE PRECISION TENS(MAXAT)
C<<<
      NATOM = 20
      DO 10 I = 1, NATOM
         X(I) = 0.1D0*(I - 1)
         Y(I) = 0.0D0
         Z(I) = 0.0D0
         VX(I) = 0.0D0
         VY(I) = 0.01D0*(I - 1)
         VZ(I) = 0.0D0
         AM(I) = 0.05D0
   10 CONTINUE
C>>>
C     Bead 1 is held fixed: mass zero in the library's list of masses.
      AM(1) = 0.0D0
      CALL CHAINS%CREATE(AM(1:NATOM))
      CALL CHAINS%ADD([(I, I = 1, NATOM)], 0.1D0)
C<<<
      CALL FORCE(GRAV, EPOT)
      E0 = EPOT
      DO 20 I = 1, NATOM
         E0 = E0 + 0.5D0*AM(I)*(VX(I)**2 + VY(I)**2 + VZ(I)**2)
   20 CONTINUE
      WORSTB = 0.0D0
      WRITE (*, '(A)') '    TIME     ENERGY - START   BOND ERROR'
      DO 60 ISTEP = 1, NSTEP
         DO 30 I = 1, NATOM
C>>>
            XOLD(I) = X(I)
            YOLD(I) = Y(I)
            ZOLD(I) = Z(I)
            IF (AM(I) .LE. 0.0D0) GOTO 30
C<<<
            VX(I) = VX(I) + 0.5D0*DT*FX(I)/AM(I)
            VY(I) = VY(I) + 0.5D0*DT*FY(I)/AM(I)
            VZ(I) = VZ(I) + 0.5D0*DT*FZ(I)/AM(I)
            X(I) = X(I) + DT*VX(I)
            Y(I) = Y(I) + DT*VY(I)
            Z(I) = Z(I) + DT*VZ(I)
   30    CONTINUE
C>>>
         CALL CHAINS%PROJECT_POSITIONS(XOLD, YOLD, ZOLD, X, Y, Z, DT,
     &                                 VX, VY, VZ)
C<<<
         CALL FORCE(GRAV, EPOT)
         DO 40 I = 1, NATOM
            IF (AM(I) .LE. 0.0D0) GOTO 40
            VX(I) = VX(I) + 0.5D0*DT*FX(I)/AM(I)
            VY(I) = VY(I) + 0.5D0*DT*FY(I)/AM(I)
            VZ(I) = VZ(I) + 0.5D0*DT*FZ(I)/AM(I)
   40    CONTINUE
C>>>
         CALL CHAINS%PROJECT_VELOCITIES(X, Y, Z, VX, VY, VZ)
         CALL CHAINS%VIOLATION(X, Y, Z, VX, VY, VZ, WORST)
         WORSTB = MAX(WORSTB, WORST%LENGTH)
C<<<
         IF (MOD(ISTEP, NSTEP/10) .EQ. 0) THEN
            EKIN = 0.0D0
            DO 50 I = 1, NATOM
               EKIN = EKIN + 0.5D0*AM(I)*(VX(I)**2 + VY(I)**2
     &                                    + VZ(I)**2)
   50       CONTINUE
            WRITE (*, '(F8.3, ES18.6, ES14.2)') ISTEP*DT,
     &         EKIN + EPOT - E0, WORSTB
         END IF
   60 CONTINUE
C>>>
C     The pull on the hook and at the free end, in this instant.
      CALL CHAINS%FORCES(X, Y, Z, VX, VY, VZ, FX, FY, FZ, TENSION=TENS)
      WRITE (*, '(A, 2F12.6)') 'TENSION OF THE FIRST AND LAST BOND',
     &   TENS(1), TENS(NATOM - 1)
      WRITE (*, '(A, ES10.2)') 'LARGEST BOND ERROR', WORSTB
      CALL CHAINS%DESTROY()
C<<<
      END

      SUBROUTINE FORCE(GRAV, EPOT)
      IMPLICIT NONE
      INTEGER MAXAT
      PARAMETER (MAXAT = 100)
      DOUBLE PRECISION GRAV, EPOT
      INTEGER NATOM, I
      DOUBLE PRECISION X, Y, Z, VX, VY, VZ, FX, FY, FZ, AM
      COMMON /ATOMS/ X(MAXAT), Y(MAXAT), Z(MAXAT),
     &               VX(MAXAT), VY(MAXAT), VZ(MAXAT),
     &               FX(MAXAT), FY(MAXAT), FZ(MAXAT), AM(MAXAT), NATOM
      EPOT = 0.0D0
      DO 10 I = 1, NATOM
         FX(I) = 0.0D0
         FY(I) = 0.0D0
         FZ(I) = -AM(I)*GRAV
         EPOT = EPOT + AM(I)*GRAV*Z(I)
   10 CONTINUE
      END
