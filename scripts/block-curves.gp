# Force on the bottom and dilatancy of the block over the displacement of its top. SPDX-License-Identifier: GPL-2.0-or-later
# gnuplot -e "out='RESULTS'; png='FILE.png'" block-curves.gp
set terminal pngcairo size 900,1050 font "Sans,11"
set output png
set datafile separator ","
set key autotitle columnheader
set grid lc rgb "#dddddd" lw 1
set border 3 lw 1.2
set tics nomirror out
set xrange [0:3]
set xtics 0.5
set lmargin 9
set rmargin 2
array color[3] = ["#1f6fb4", "#d9822b", "#2a8f4f"]
names = "taylor restricted periodic"
titles = "Taylor Restricted_Taylor Periodic"
run(p, b) = sprintf("%s/p0%d_%s/history.csv", out, p, word(names, b))
title_of(b) = system("echo " . word(titles, b) . " | tr _ ' '")
set multiplot layout 3,2 margins 0.085,0.985,0.055,0.965 spacing 0.1,0.065
do for [b=1:3] {
  set title title_of(b) . ": vertical force on the bottom" offset 0,-0.6
  set ylabel "force (N)" offset 1.2,0
  set yrange [0:*]
  if (b == 3) { set xlabel "displacement of the top (mm)" offset 0,0.4 } else { unset xlabel }
  if (b == 1) { set key at graph 0.98,0.05 bottom right reverse Left samplen 2 } else { unset key }
  plot for [p=1:3] run(p, b) using (-column("uy_top")):(column("step") < 10 ? NaN : column("bottom_y")) with lines lw 2.2 lc rgb color[p] \
    title sprintf("p = 0.%d N/mm", p)
  unset key
  set title title_of(b) . ": dilatancy" offset 0,-0.6
  set ylabel "100 (v/V - 1)" offset 1.2,0
  set yrange [*:*]
  plot for [p=1:3] run(p, b) using (-column("uy_top")):(column("step") < 10 ? NaN : column("dilatancy")) with lines lw 2.2 lc rgb color[p] notitle
}
unset multiplot
