# Read by every plot. Given on gnuplot's command line: results (the CSV file), out (the plots' folder).
set datafile separator ","
set grid lc rgb "#dddddd"
set border lc rgb "#555555"
# Below the plot, so that the plot has the whole width. Names of methods and problems have underscores that mean none.
set key below horizontal Left reverse noenhanced samplen 2.5 height 1 font ",15"
set title noenhanced font ",17"
# One colour and mark per method in all plots; the library is the thick dark one.
array names[12] = ["holonomic", "sparse-newton", "milc-shake", "rattle", "lincs", "openmm-ccma", "lapack-dptsv", "lapack-dgtsv", "eigen-simplicial", "eigen-ldlt", "omega-recursion", "eq20"]
array titles[12] = ["holonomic", "sparse Newton", "MILC-SHAKE", "RATTLE", "LINCS", "OpenMM CCMA", "LAPACK dptsv", "LAPACK dgtsv", "Eigen simplicial", "Eigen dense", "recursion, Eq. 17", "Eq. 20"]
array colours[12] = ["#111111", "#d55e00", "#009e73", "#0072b2", "#cc79a7", "#e69f00", "#0072b2", "#56b4e9", "#009e73", "#e69f00", "#d55e00", "#cc79a7"]
array marks[12] = [7, 5, 9, 13, 11, 4, 13, 12, 9, 4, 5, 11]
width(i) = i == 1 ? 3 : 1.5
# Rows of the CSV file that fulfil an awk condition, printed as the awk expression says.
rows(condition, what) = sprintf("< awk -F, 'NR > 1 && %s { print %s }' OFS=, '%s'", condition, what, results)
count(condition) = int(system(sprintf("awk -F, 'NR > 1 && %s { n++ } END { print n+0 }' '%s'", condition, results)))
# Readable at half of their size.
png = "pngcairo enhanced size 960,720 font 'Sans,18'"
svg = "svg enhanced size 960,720 font 'Sans,20' background 'white'"
# What scenes are called.
scene(name) = name eq "straight5" ? "nearly straight" : name eq "light_joints" ? "light joints" : name eq "random_tree" ? "random tree" : name
# The same rows with the quartiles of their repetitions, for error bars: what is printed may use low and high.
spread = system(sprintf("dirname '%s'", results)) . "/spread.csv"
with_quartiles(condition, what) = sprintf("< awk -F, 'FNR == NR { k = $1 FS $2 FS $3 FS $4 FS $5 FS $6 FS $7; l[k] = $10; h[k] = $12; next } FNR > 1 && %s { k = $1 FS $2 FS $3 FS $4 FS $5 FS $6 FS $7; low = (k in l ? l[k] : $9); high = (k in h ? h[k] : $9); print %s }' OFS=, '%s' '%s'", condition, what, spread, results)
