# Read by every plot. Given on gnuplot's command line: results (the CSV file), out (the plots' folder).
set datafile separator ","
set grid lc rgb "#dddddd"
set border lc rgb "#555555"
set key font ",10"
# One colour and mark per method in all plots; the library is the thick dark one.
array names[12] = ["holonomic", "sparse-newton", "milc-shake", "rattle", "lincs", "openmm-ccma", "lapack-dptsv", "lapack-dgtsv", "eigen-simplicial", "eigen-ldlt", "omega-recursion", "eq20"]
array colours[12] = ["#111111", "#d55e00", "#009e73", "#0072b2", "#cc79a7", "#e69f00", "#0072b2", "#56b4e9", "#009e73", "#e69f00", "#d55e00", "#cc79a7"]
array marks[12] = [7, 5, 9, 13, 11, 4, 13, 12, 9, 4, 5, 11]
width(i) = i == 1 ? 3 : 1.5
# Rows of the CSV file that fulfil an awk condition, printed as the awk expression says.
rows(condition, what) = sprintf("< awk -F, 'NR > 1 && %s { print %s }' OFS=, '%s'", condition, what, results)
count(condition) = int(system(sprintf("awk -F, 'NR > 1 && %s { n++ } END { print n+0 }' '%s'", condition, results)))
png = "pngcairo noenhanced size 960,640 font 'Sans,12'"
svg = "svg noenhanced size 960,640 font 'Sans,14' background 'white'"
