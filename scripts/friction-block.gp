# The block with and without friction: force on the bottom and dilatancy over the displacement of the top, and the residuals of
# the increments. SPDX-License-Identifier: GPL-2.0-or-later
# gnuplot -e "out='RESULTS'; png='FILE.png'" friction-block.gp
set terminal pngcairo size 1000,420 font "Sans,11"
set output png
set datafile separator ","
set key autotitle columnheader
set grid lc rgb "#dddddd" lw 1
set border 3 lw 1.2
set tics nomirror out
set xrange [0:3]
set xlabel "displacement of the top (mm)" offset 0,0.4
array color[3] = ["#1f6fb4", "#d9822b", "#2a8f4f"]
names = "taylor restricted periodic"
titles = "Taylor Restricted_Taylor Periodic"
run(k, b) = sprintf("%s/block_%s_%s/history.csv", out, k, word(names, b))
title_of(b) = system("echo " . word(titles, b) . " | tr _ ' '")
set multiplot layout 1,2 margins 0.065,0.985,0.14,0.92 spacing 0.09
set title "vertical force on the bottom" offset 0,-0.6
set ylabel "force (N)" offset 1.2,0
set yrange [0:*]
set key top left reverse Left samplen 2.5
plot for [b=1:3] run("friction20", b) using (-column("uy_top")):(column("step") < 10 ? NaN : column("bottom_y")) with lines lw 2.2 lc rgb color[b] \
    title title_of(b) . ", 20 degrees", \
  for [b=1:3] run("p02", b) using (-column("uy_top")):(column("step") < 10 ? NaN : column("bottom_y")) with lines lw 1.6 dt (6,3) lc rgb color[b] \
    title title_of(b) . ", frictionless"
unset key
set title "dilatancy" offset 0,-0.6
set ylabel "100 (v/V - 1)" offset 1.2,0
set yrange [*:*]
plot for [b=1:3] run("friction20", b) using (-column("uy_top")):(column("step") < 10 ? NaN : column("dilatancy")) with lines lw 2.2 lc rgb color[b] notitle, \
  for [b=1:3] run("p02", b) using (-column("uy_top")):(column("step") < 10 ? NaN : column("dilatancy")) with lines lw 1.6 dt (6,3) lc rgb color[b] notitle
unset multiplot
