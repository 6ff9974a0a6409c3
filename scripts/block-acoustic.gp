# Smallest acoustic eigenvalue of each integration point of the periodic blocks: maps of two increments into MAPS.png, all increments
# and the jumps into STRIPS.png. SPDX-License-Identifier: GPL-2.0-or-later
# gnuplot -e "out='RESULTS'; maps='MAPS.png'; strips='STRIPS.png'" block-acoustic.gp
set terminal pngcairo size 900,650 font "Sans,11"
set output maps
set border 3 lw 1.2
set tics nomirror out
set multiplot
set border 15
# maps: columns are pressures, rows are the end of the confinement and 3 mm
set palette defined (-4 "#8c1d18", -0.001 "#fbe3dc", 0 "#e4edf5", 4 "#2b6ca8")
set cbrange [-4:4]
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
    set bmargin at screen (row == 1 ? 0.53 : 0.04)
    set tmargin at screen (row == 1 ? 0.53 : 0.04) + 0.41
    step = row == 1 ? 10 : 40
    set title sprintf("p = 0.%d N/mm, %s", p, row == 1 ? "confined" : "3 mm") offset 0,-0.6
    if (p == 3) { set colorbox user origin 0.925,(row == 1 ? 0.53 : 0.04) size 0.018,0.41; set cbtics 2 } else { unset colorbox }
    file = sprintf("%s/acoustic_p0%d_periodic_%d.txt", out, p, step)
    plot file using 1:2:3 with points pt 5 ps 4.6 lc palette notitle, \
      file using 1:2:(sprintf("%.1f", column(3))) with labels font "Sans,9" notitle
  }
}
unset multiplot

# strips: increments to the right, integration points upward, a dot for each jump of a point
set terminal pngcairo size 900,1050 font "Sans,11"
set output strips
set multiplot layout 3,1 margins 0.075,0.9,0.055,0.965 spacing 0.075
unset grid
set border 3
set size noratio
set xrange [-0.5:40.5]
set yrange [-0.5:35.5]
set format "%g"
set xtics 5
set ytics 0,4,35
set ylabel "integration point" offset 0.6,0
set colorbox default
do for [p=1:3] {
  set title sprintf("p = 0.%d N/mm", p) offset 0,-0.6
  if (p == 3) { set xlabel "increment (10: confined, 40: 3 mm)" offset 0,0.4 } else { unset xlabel }
  plot sprintf("%s/acoustic_p0%d_periodic.txt", out, p) using 1:2:3 with image notitle, \
    sprintf("%s/jumps_p0%d_periodic.txt", out, p) using 1:2 with points pt 7 ps 0.9 lc rgb "#000000" notitle
}
unset multiplot
