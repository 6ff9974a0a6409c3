# Figure of the element tests: gnuplot -c plot.gp OUT.png, in the folder of the results. SPDX-License-Identifier: GPL-2.0-or-later
set terminal pngcairo size 1200,900 font "Sans,12"
set output ARG1
set datafile separator ","
set key top left reverse Left samplen 2
set encoding utf8
set grid lc rgb "#dddddd"
# Row 10 is the end of consolidation.
height(f) = real(system(sprintf("awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) c[$k] = k } NR == 12 { print $(c[\"F22\"]) }' %s", f)))
volume(f) = real(system(sprintf("awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) c[$k] = k } NR == 12 { print $(c[\"volume\"]) }' %s", f)))
set multiplot layout 2,2
files = "biaxial_0.csv biaxial_0.3.csv biaxial_0.5.csv"
names = "frictionless µ=0.3 µ=0.5"
set xlabel "axial compression [%]"
set ylabel "(s11 - s22) / (-s11 - s22)"
set title "biaxial compression, side stress 0.2 N/mm"
plot for [k = 1:3] word(files, k) every ::10 using (100*(1 - column("F22")/height(word(files, k)))):((column("s11") - column("s22"))/(-column("s11") - column("s22"))) \
  with lines lw 2 title word(names, k)
set ylabel "volume strain [%]"
plot for [k = 1:3] word(files, k) every ::10 using (100*(1 - column("F22")/height(word(files, k)))):(100*(column("volume")/volume(word(files, k)) - 1)) \
  with lines lw 2 title word(names, k)
set title "shear with µ=0.3: stress path"
set xlabel "mean stress [N/mm]"
set ylabel "s12 [N/mm]"
plot "undrained.csv" every ::10 using "pressure":"s12" with lines lw 2 title "constant volume", \
  "constant_pressure.csv" every ::10 using "pressure":"s12" with lines lw 2 title "constant mean stress"
set title "ten cycles between two shear stresses, µ=0.3"
set xlabel "F12"
plot "cyclic.csv" every ::10 using "F12":"s12" with lines lw 1 notitle
unset multiplot
