# Mean stress of the ensemble over the strain for four angles of friction, two experiments side by side. SPDX-License-Identifier: GPL-2.0-or-later
# gnuplot -e "out='RESULTS'; png='FILE.png'; kind='uniaxial'; left='taylor 1'; right='taylor 2'" friction-curves.gp
set terminal pngcairo size 1000,820 font "Sans,11"
set output png
set grid lc rgb "#dddddd" lw 1
set border 3 lw 1.2
set tics nomirror out
bar = "heads size graph 0.006,90"
array color[4] = ["#444444", "#1f6fb4", "#2a8f4f", "#d9822b"]
cases = left . " " . right
condition(c) = word(cases, 2 * c - 1)
axis(c) = word(cases, 2 * c)
title_of(c) = (condition(c) eq "taylor" ? "Taylor" : condition(c) eq "restricted" ? "Restricted Taylor" : "Periodic") . \
  (kind eq "uniaxial" ? (axis(c) eq "1" ? ", horizontal compression" : ", vertical compression") \
                      : (axis(c) eq "1" ? ", horizontal shear" : ", vertical shear"))
strain(c) = kind eq "uniaxial" ? (axis(c) eq "1" ? "1 - F_{11}" : "1 - F_{22}") : (axis(c) eq "1" ? "F_{12}" : "F_{21}")
file(c, a) = sprintf("%s/curve_%s_%s_%s_%d_0.txt", out, kind, condition(c), axis(c), 10 * (a - 1))
# error bars at about ten strains, set apart for each curve
rows(c) = int(system("wc -l <" . file(c, 1)))
far(c) = rows(c) / 10
set multiplot layout 2,2 margins 0.1,0.985,0.075,0.955 spacing 0.115,0.12
set key top left reverse Left samplen 2
do for [c=1:2] {
  set title title_of(c) offset 0,-0.6
  set xlabel strain(c) offset 0,0.4
  set ylabel "-{/Symbol s}_{11}/E_n (solid), -{/Symbol s}_{22}/E_n (dashed)" offset 1.2,0
  plot for [a=1:4] file(c, a) using 1:2 with lines lw 2 lc rgb color[a] title (c == 1 ? sprintf("%d degrees", 10 * (a - 1)) : ""), \
    for [a=1:4] file(c, a) using 1:4 with lines lw 2 dt (6,3) lc rgb color[a] notitle, \
    for [a=1:4] file(c, a) every far(c)::((a - 1) * far(c) / 4 + far(c) / 2) using 1:($2 - $3):(0):(2 * $3) with vectors @bar lw 1.2 lc rgb color[a] notitle, \
    for [a=1:4] file(c, a) every far(c)::((a - 1) * far(c) / 4 + far(c) / 2) using 1:($4 - $5):(0):(2 * $5) with vectors @bar lw 1.2 lc rgb color[a] notitle
}
unset key
do for [c=1:2] {
  set title title_of(c) offset 0,-0.6
  set xlabel strain(c) offset 0,0.4
  set ylabel "{/Symbol s}_{12}/E_n" offset 1.2,0
  plot for [a=1:4] file(c, a) using 1:6 with lines lw 2 lc rgb color[a] notitle, \
    for [a=1:4] file(c, a) every far(c)::((a - 1) * far(c) / 4 + far(c) / 2) using 1:($6 - $7):(0):(2 * $7) with vectors @bar lw 1.2 lc rgb color[a] notitle
}
unset multiplot
