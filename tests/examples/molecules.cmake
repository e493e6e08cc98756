example_folder(molecules)

# ---------------------------------------------------------------------------------------------------------- alkane
# All 37 bonds of dodecane hold to the rounding of coordinates of some 20 A. The energy of velocity Verlet at 1 fs
# fluctuates by about 0.08 kJ/mol of 127 in a molecule whose C-H bonds are rigid and whose angles are not.
example_test(alkane molecules alkane steps=10000 --
    "atoms" 1 = 38
    "atoms" 2 = 37
    "degrees of freedom" 1 = 74
    "largest bond error" 1 < 5e-14
    "largest |d.v|" 1 < 1e-12
    "energy fluctuation" 1 < 0.2
    "energy drift" 1 < 20
    "energy drift" 1 > -20)
# Of second order in the time step: a quarter of that at half the step. A force that does not belong to its energy, or
# constraints that do work, would leave it as it is.
example_test(alkane.half_the_step molecules alkane carbons=4 steps=4000 dt=0.5 --
    "atoms" 1 = 14
    "energy fluctuation" 1 < 0.02)
example_test(alkane.ethane molecules alkane carbons=2 steps=1000 --
    "atoms" 2 = 7
    "largest bond error" 1 < 2e-14)
example_refuses(alkane.refuses_methane molecules "carbons=1 must be a number of at least 2" alkane carbons=1)

# ----------------------------------------------------------------------------------------------------------- brush
# The last bond of an arm is a free dumbbell, nearly: 2 kT/a of tension by its own motion; that of the backbone is what
# the crowd adds. kT of 520 degrees of freedom over 75 units of time is known to better than 0.02.
example_test(brush molecules brush steps=20000 --
    "180 beads" 1 = 20
    "largest bond error" 1 < 1e-13
    "largest |d.v|" 1 < 1e-13
    "kT" 1 > 0.94
    "kT" 1 < 1.06
    "mean tension backbone" 1 > 4
    "mean tension arm    8" 1 > 1.7
    "mean tension arm    8" 1 < 2.5)

# ------------------------------------------------------------------------------------------------------------- gel
# Stretched to twice its length a phantom network pulls with 3.5; the blocks of so short a run say 0.2 for its error.
example_test(gel molecules gel points=1 steps=400 --
    "128 strands" 1 = 10
    "128 strands" 2 = 1
    "     2.000" 1 > 2.5
    "     2.000" 1 < 4.8
    "largest bond error" 1 < 1e-12
    "largest |d.v|" 1 < 1e-13)

# ----------------------------------------------------------------------------------------------------------- rings
# Eight rings of six freedoms each, less a bond between each two.
example_test(rigid_rings molecules rigid_rings 2000 --
    "degrees of freedom" 1 = 41
    "largest energy error" 1 < 1e-5
    "largest length error" 1 < 1e-13
    "largest |d.v|" 1 < 1e-12
    "end to end" 1 > 10)
