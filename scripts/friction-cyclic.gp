# Stress of the ensemble along the cycle of shear, with and without hardening. SPDX-License-Identifier: GPL-2.0-or-later
# gnuplot -e "out='RESULTS'; png='FILE.png'; conditions='taylor'" friction-cyclic.gp
set output
rows = words(conditions)
set terminal pngcairo size 1200,40 + 390 * rows font "Sans,11"
set output png
set grid lc rgb "#dddddd" lw 1
set border 3 lw 1.2
set tics nomirror out
bar = "heads size graph 0.006,90"
array color[2] = ["#1f6fb4", "#d9822b"]
name(r) = word(conditions, r) eq "taylor" ? "Taylor" : word(conditions, r) eq "restricted" ? "Restricted Taylor" : "Periodic"
file(r, h) = sprintf("%s/curve_cyclic_%s_1_30_%d.txt", out, word(conditions, r), h == 1 ? 0 : 1000)
array stress[3] = ["-{/Symbol s}_{11}/E_n", "-{/Symbol s}_{22}/E_n", "{/Symbol s}_{12}/E_n"]
here(r, h) = system("test -e " . file(r, h) . " && echo 1 || echo 0") + 0
set multiplot layout rows,3 margins 0.07,0.985,0.14/rows,1-0.09/rows spacing 0.075,0.24/rows
do for [r=1:rows] {
  do for [s=1:3] {
    set title name(r) . ", " . stress[s] offset 0,-0.6
    set xlabel "F_{12}" offset 0,0.4
    if (s == 3) { set key top left reverse Left samplen 2 } else { unset key }
    most = here(r, 2) ? 2 : 1
    plot for [h=1:most] file(r, h) using 1:(column(2 * s)) with lines lw 2 lc rgb color[h] title (h == 1 ? "h = 0" : "h = E_n"), \
      for [h=1:most] file(r, h) every 100::(h == 1 ? 50 : 100) using 1:(column(2 * s) - column(2 * s + 1)):(0):(2 * column(2 * s + 1)) with vectors @bar lw 1.2 lc rgb color[h] notitle
  }
}
unset multiplot
