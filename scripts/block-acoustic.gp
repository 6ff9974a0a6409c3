# Smallest acoustic eigenvalue of each integration point of the periodic blocks, and over the displacement.
# SPDX-License-Identifier: GPL-2.0-or-later
# gnuplot -e "out='RESULTS'; png='FILE.png'" block-acoustic.gp
set terminal pngcairo size 900,950 font "Sans,11"
set output png
set border 3 lw 1.2
set tics nomirror out
array color[3] = ["#1f6fb4", "#d9822b", "#2a8f4f"]
set multiplot
# maps: columns are pressures, rows are the end of the confinement and 3 mm
set palette defined (-4 "#8c1d18", -0.001 "#fbe3dc", 0 "#e4edf5", 6 "#2b6ca8")
set cbrange [-4:6]
set size ratio -1
set xrange [0:100]
set yrange [0:100]
set xtics 0,100/3.,100 format ""
set ytics 0,100/3.,100 format ""
set grid front lc rgb "#444444" lw 1
do for [row=1:2] {
  do for [p=1:3] {
    set lmargin at screen 0.06 + 0.29 * (p - 1)
    set rmargin at screen 0.06 + 0.29 * (p - 1) + 0.27
    set bmargin at screen (row == 1 ? 0.685 : 0.36)
    set tmargin at screen (row == 1 ? 0.685 : 0.36) + 0.27
    step = row == 1 ? 10 : 40
    set title sprintf("p = 0.%d N/mm, %s", p, row == 1 ? "confined" : "3 mm") offset 0,-0.6
    if (p == 3) { set colorbox user origin 0.925,(row == 1 ? 0.685 : 0.36) size 0.018,0.27; set cbtics 2 } else { unset colorbox }
    file = sprintf("%s/acoustic_p0%d_periodic_%d.txt", out, p, step)
    plot file using 1:2:3 with points pt 5 ps 4.6 lc palette notitle, \
      file using 1:2:(sprintf("%.1f", column(3))) with labels font "Sans,9" notitle
  }
}
unset grid
set size noratio
set lmargin at screen 0.085
set rmargin at screen 0.985
set bmargin at screen 0.055
set tmargin at screen 0.29
set grid lc rgb "#dddddd" lw 1
set datafile separator ","
set title "smallest of the 36 points; the dots are increments that passed a jump" offset 0,-0.6
set xrange [0:40]
set yrange [*:2]
set format "%g"
set xtics 5
set ytics auto
set xlabel "increment (10: confined, 40: 3 mm)" offset 0,0.5
set ylabel "eigenvalue (N/mm)" offset 1.2,0
set key top right horizontal reverse Left samplen 2
run(p) = sprintf("%s/p0%d_periodic/history.csv", out, p)
plot for [p=1:3] run(p) using "step":"min_acoustic" with lines lw 2 lc rgb color[p] title sprintf("p = 0.%d N/mm", p), \
  for [p=1:3] run(p) using "step":(column("jumps") > 0 ? column("min_acoustic") : NaN) with points pt 7 ps 1 lc rgb color[p] notitle, \
  0 with lines lw 1 lc rgb "#000000" notitle
unset multiplot
