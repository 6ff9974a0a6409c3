# Curves of the biaxial test and the slope, and the packings of four points. SPDX-License-Identifier: GPL-2.0-or-later
# gnuplot -e "out='RESULTS'; png='FILE.png'; rves='FILE.png'; slope='FILE.png'" large-curves.gp
set terminal pngcairo size 1000,430 font "Sans,11"
set datafile separator ","
set key autotitle columnheader
set grid lc rgb "#dddddd" lw 1
set border 3 lw 1.2
set tics nomirror out
array color[3] = ["#1f6fb4", "#d9822b", "#2a8f4f"]
names = "taylor restricted periodic"
titles = "Taylor Restricted_Taylor Periodic"
run(b) = sprintf("%s/biaxial_%s/history.csv", out, word(names, b))
# compressed already, by a few increments?
there(b) = int(system(sprintf("awk -F, '$1 > 12 {n = 1} END {print n + 0}' %s 2>/dev/null || echo 0", run(b))))
title_of(b) = system("echo " . word(titles, b) . " | tr _ ' '")
last = there(3) ? 3 : 2
set output png
set multiplot layout 1,2 margins 0.07,0.985,0.15,0.95 spacing 0.1,0.06
set xlabel "displacement of the top (mm)"
set xrange [0:3.501]
set ylabel "axial force (N)"
set yrange [0:*]
set key top left Left reverse samplen 2
plot for [b=1:last] run(b) using (-column("uy_top")):(column("step") < 10 ? NaN : column("bottom_y")) with lines lw 2.2 lc rgb color[b] \
  title title_of(b)
unset key
set ylabel "dilatancy, 100 (v/V - 1) (%)"
set yrange [*:*]
plot for [b=1:last] run(b) using (-column("uy_top")):(column("step") < 10 ? NaN : column("dilatancy")) with lines lw 2.2 lc rgb color[b] notitle
unset multiplot
set xrange [*:*]

set output slope
slopes = "slope_taylor slope_periodic_friction"
slope_of(b) = out . "/" . word(slopes, b) . "/history.csv"
there = int(system("test -e '" . slope_of(2) . "' && echo 2 || echo 1"))
name_of(b) = b == 1 ? "Taylor" : "periodic, friction"
# the footing under the weight alone: the last row of that step
base(b) = real(system("awk -F, 'NR == 1 {for (k = 1; k <= NF; k++) c[$k] = k} $c[\"name\"] == \"gravity\" {u = $c[\"footing_uy_footing\"]} END {print u}' '" . slope_of(b) . "'"))
set multiplot layout 1,2 margins 0.085,0.985,0.15,0.95 spacing 0.11,0.06
set xlabel "load (MN)"
set key top left Left reverse samplen 2
set ylabel "settlement of the footing since the weight acts (m)"
plot for [b=1:there] under = base(b) slope_of(b) using (strcol("name") eq "load" ? -column("footing_fy_footing") / 1e6 : NaN):(under - column("footing_uy_footing")) \
  with linespoints lw 2 pt 7 ps 0.6 lc rgb color[b] title name_of(b)
unset key
set ylabel "turn of the footing towards the slope (degrees)"
plot for [b=1:there] slope_of(b) using (strcol("name") eq "load" ? -column("footing_fy_footing") / 1e6 : NaN):(-column("footing_turn_footing") * 180 / pi) \
  with linespoints lw 2 pt 7 ps 0.6 lc rgb color[b] notitle
unset multiplot

# packings: the pictures of granhom plot side by side
set terminal pngcairo size 1600,880
set output rves
set datafile separator
unset border
unset tics
unset grid
unset xlabel
unset ylabel
set size ratio -1
set autoscale
points = "183 117 90 17"
set multiplot layout 2,4 margins 0,1,0,1 spacing 0,0
do for [b=1:2] {
  do for [k=1:4] {
    plot sprintf("%s/biaxial_%s.rve.%s.png", out, word(names, b), word(points, k)) binary filetype=png with rgbimage notitle
  }
}
unset multiplot
