example_folder(sampling)

# The programs fail by themselves when a mean is four standard errors off; with a fixed seed they always do or never. The
# errors here are about 0.001, a tenth of what the Fixman potential changes, so that leaving it out or taking it with the
# wrong sign is found with certainty, as the tests below that must fail show.

# ------------------------------------------------------------------------------------------------- fixman_sampling
example_test(fixman_sampling sampling fixman_sampling molecules=300 moves=256 --
    " 2 bonds, Fixman potential times 0   mean cos^2" 1 > 0.316
    " 2 bonds, Fixman potential times 0   mean cos^2" 1 < 0.326
    " 2 bonds, Fixman potential times 1   mean cos^2" 1 > 0.328
    " 2 bonds, Fixman potential times 1   mean cos^2" 1 < 0.338
    "10 bonds, Fixman potential times 0   mean cos^2" 2 < 0.002
    "10 bonds, Fixman potential times 1   mean cos^2" 2 < 0.002
    "largest deviation:" 1 < 4
    file fixman_sampling.dat > 3000
    file fixman_sampling.gp > 300)
example_refuses(fixman_sampling.notices_the_wrong_sign sampling "the sampling is not what it should be"
    fixman_sampling molecules=300 moves=128 factor=-1 output=wrong_sign)
example_refuses(fixman_sampling.refuses_an_unknown_option sampling "there is no option 'move=3'" fixman_sampling move=3)

# --------------------------------------------------------------------------------------------- bead_rod_relaxation
example_test(bead_rod_relaxation sampling bead_rod_relaxation bonds=4 time=22 --
    "200 chains of 4 rods, at the start mean square end-to-end distance / N =" 1 = 4
    "largest bond error:" 1 < 1e-14
    "mean square end-to-end distance / N:" 1 > 0.97
    "mean square end-to-end distance / N:" 1 < 1.03
    "mean square cosine:" 2 < 0.002
    file bead_rod_relaxation.dat > 3000
    file bead_rod_relaxation.gp > 300)
example_refuses(bead_rod_relaxation.notices_a_missing_metric_force sampling "did not become freely jointed"
    bead_rod_relaxation bonds=4 time=22 metric=0 output=no_metric)
example_refuses(bead_rod_relaxation.refuses_a_run_too_short_to_forget sampling "time=1 is too short"
    bead_rod_relaxation time=1)
