example_folder(fortran)
set(molecule ${PROJECT_SOURCE_DIR}/examples/fortran/alkane_md/n-hexadecane.xyz)

# ------------------------------------------------------------------------------------------------------- alkane_md
# The bonds hold to the rounding of coordinates of some 10 A, 2 eps 10/1.54 for d^2, with some room for a bad step. The
# energy of velocity Verlet at 2 fs fluctuates by about 0.02 kJ/mol of 58; a wrong force or constraint gives far more.
example_test(alkane_md.rattle fortran alkane_md file=${molecule} steps=20000 output=nve --
    "degrees of freedom" 1 = 30
    "largest bond error" 1 < 2e-14
    "most iterations" 1 < 6
    "energy fluctuation" 1 < 0.1
    "energy drift" 1 < 2
    "energy drift" 1 > -2
    file nve.dat > 100000
    file nve.gp > 300)
# SHAKE in its place stays just within its tolerance; to 1e-10 it is the same trajectory's energy.
example_test(alkane_md.shake fortran alkane_md file=${molecule} steps=20000 tolerance=1e-10 --
    "constraints           by SHAKE, to" 1 = 1e-10
    "largest bond error" 1 < 1.01e-10
    "largest bond error" 1 > 1e-12
    "energy fluctuation" 1 < 0.1
    "energy drift" 1 < 2
    "energy drift" 1 > -2)
# Runge-Kutta knows nothing of the bonds but their forces: order 4 in their lengths shows that the forces are exact.
example_test(alkane_md.rk4 fortran alkane_md file=${molecule} integrator=rk4 steps=500 dt=1 --
    "observed order" 1 > 3.8
    "observed order" 2 > 3.8
    "observed order" 1 < 4.2
    "observed order" 2 < 4.2
    "largest bond error" 1 < 1e-5)
# 33 degrees of freedom over 100 ps with a correlation time below 1 ps: the mean is known to about 5 K, so 25 K is five
# standard errors; one of three degrees of freedom miscounted would show as 27 K.
example_test(alkane_md.langevin fortran alkane_md file=${molecule} integrator=langevin steps=50000 friction=5 --
    "degrees of freedom" 1 = 33
    "largest bond error" 1 < 3e-14
    "mean temperature" 1 > 275
    "mean temperature" 1 < 325)
example_refuses(alkane_md.refuses_a_missing_file fortran "alkane_md: .*nowhere.xyz" alkane_md file=nowhere.xyz)
example_refuses(alkane_md.refuses_another_group fortran "'OH', atom 3, is neither CH3 nor CH2"
    alkane_md file=${CMAKE_CURRENT_SOURCE_DIR}/propanol.xyz)
example_refuses(alkane_md.refuses_a_gap fortran "line 5: this atom is not a bond of 1.54 A from the one before"
    alkane_md file=${CMAKE_CURRENT_SOURCE_DIR}/gap.xyz)
example_refuses(alkane_md.refuses_an_unknown_option fortran "there is no option 'step'" alkane_md step=3)
example_refuses(alkane_md.refuses_no_steps fortran "steps=0 must be a whole number" alkane_md steps=0)

add_test(NAME examples.make_alkane COMMAND sh -c "\"$1\" 16 | cmp - \"$2\"" sh
    ${CMAKE_CURRENT_BINARY_DIR}/fortran/make_alkane ${molecule})
set_tests_properties(examples.make_alkane PROPERTIES FIXTURES_REQUIRED examples_fortran)

# --------------------------------------------------------------------------------------------------------- melt_md
# Momentum: a random walk of 512 roundings of eps in each of 4000 kicks is 3e-13. The three pressures are averages of
# the same quantity to second order in dt.
example_test(melt_md fortran melt_md chains=16 melt=4000 steps=4000 --
    "degrees of freedom" 1 = 1037
    "largest bond error" 1 < 1e-13
    "largest |d.v|" 1 < 1e-14
    "largest momentum" 1 < 1e-11
    "energy fluctuation" 1 < 5e-4
    "temperature" 1 > 0.85
    "temperature" 1 < 1.15
    "  largest difference" 1 < 0.01)
example_refuses(melt_md.refuses_a_full_box fortran "box is too small" melt_md density=3)

# ---------------------------------------------------------------------------------------------------- legacy_fixed
example_test(legacy_fixed fortran legacy_fixed --
    "LARGEST BOND ERROR" 1 < 5e-14
    "  20.000" 1 < 0.01
    "  20.000" 1 > -0.01)

# -------------------------------------------------------------------------------------------------------- water_md
# At constant pressure the mean pressure is that of the bath, and the density what it makes it: less than 0.998 where the
# cutoff is so short.
example_test(water_md.constant_pressure fortran water_md molecules=64 melt=200 steps=3000 pressure=1 --
    "degrees of freedom" 1 = 384
    "largest bond error" 1 < 1e-13
    "mean density" 1 > 0.80
    "mean density" 1 < 1.08
    "mean temperature" 1 > 280
    "mean temperature" 1 < 325
    "mean pressure" 1 > -1000
    "mean pressure" 1 < 1000)
# Momentum is three degrees of freedom of 6 per molecule. Oxygens of SPC/E are nearest at 2.75 A. The pressure of so small
# a box scatters by some 1000 bar about 0; without the constraints' virial it would be off by tens of thousands.
example_test(water_md fortran water_md molecules=125 melt=500 steps=1000 output=water --
    "125 molecules" 1 > 15
    "degrees of freedom" 1 = 747
    "largest bond error" 1 < 1e-13
    "largest |d.v|" 1 < 1e-14
    "energy fluctuation" 1 < 0.02
    "mean temperature" 1 > 270
    "mean temperature" 1 < 345
    "mean pressure" 1 > -3000
    "mean pressure" 1 < 3000
    "oxygens are nearest at" 1 > 2.65
    "oxygens are nearest at" 1 < 2.90
    file water.dat > 30000
    file water.gp > 300)
example_refuses(water_md.refuses_no_time_step fortran "dt, temperature and density must be above zero" water_md dt=0)

# -------------------------------------------------------------------------------------------------------- tip4p_md
# Momentum is three degrees of freedom of 6 per molecule. Half the step, a quarter of the energy's fluctuation. Oxygens are
# nearest at 2.79 A in runs like this one, where their distribution is 2.8 to 3.3. Without what acts on the sites molecules end up
# in each other.
example_test(tip4p_md fortran tip4p_md molecules=64 melt=1000 steps=1000 output=tip4p --
    "64 molecules" 1 > 12.4
    "degrees of freedom" 1 = 381
    "largest shape error" 1 < 1e-13
    "largest rate" 1 < 1e-16
    "energy fluctuation" 1 < 0.012
    "mean temperature" 1 > 260
    "mean temperature" 1 < 340
    "oxygens are nearest at" 1 > 2.68
    "oxygens are nearest at" 1 < 2.88
    "oxygens are nearest at" 2 > 2.5
    "oxygens are nearest at" 2 < 3.6
    file tip4p.dat > 5000
    file tip4p.energy.dat > 3000
    file tip4p.gp > 300)
example_test(tip4p_md.half_step fortran tip4p_md molecules=64 melt=1000 steps=1000 dt=1 --
    "energy fluctuation" 1 < 0.003)
example_refuses(tip4p_md.refuses_no_density fortran "dt, temperature and density must be above zero" tip4p_md density=0)

# ----------------------------------------------------------------------------------------------------- ring_fixman
# Exact: neighbours of a freely jointed ring of 6 have the mean cosine -1/5, and the radius of gyration squared is 7/12.
# The program itself compares means within four standard errors, and must find what the potential does.
example_test(ring_fixman fortran ring_fixman molecules=200 moves=300 --
    "200 rings of" 1 = 6
    "mean cos, neighbours" 3 > -0.206
    "mean cos, neighbours" 3 < -0.194
    "radius of gyration^2" 3 > 0.577
    "radius of gyration^2" 3 < 0.590
    "largest deviation:" 1 < 4
    "what the potential does to neighbours:" 1 > 5)
example_refuses(ring_fixman.notices_the_wrong_sign fortran "the sampling is not what it should be"
    ring_fixman molecules=200 moves=150 factor=-1)

# -------------------------------------------------------------------------------------------------------- with traps
# As many an old code is run: an invalid operation, a division by zero or an overflow ends the program, in the library, too.
if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
    example_folder(fortran KIND traps FLAGS "-ffpe-trap=invalid,zero,overflow")
    example_test(alkane_md.traps fortran_traps alkane_md file=${molecule} steps=500 -- "largest bond error" 1 < 2e-14)
    example_test(melt_md.traps fortran_traps melt_md chains=16 melt=100 steps=100 -- "largest bond error" 1 < 1e-13)
    example_test(legacy_fixed.traps fortran_traps legacy_fixed -- "LARGEST BOND ERROR" 1 < 5e-14)
    example_test(water_md.traps fortran_traps water_md molecules=64 melt=20 steps=50 -- "largest bond error" 1 < 1e-13)
    example_test(tip4p_md.traps fortran_traps tip4p_md molecules=64 melt=20 steps=50 -- "largest shape error" 1 < 1e-13)
    example_test(ring_fixman.traps fortran_traps ring_fixman molecules=200 moves=300 -- "200 rings of" 1 = 6)
endif()
