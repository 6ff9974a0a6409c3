# Axial stress, volumetric strain, coordination number and anisotropy over the axial strain. SPDX-License-Identifier: GPL-2.0-or-later
# gnuplot -e "png='FILE.png'; names='mesh_1x2 mesh_2x4'" paper.gp, in the folder of scripts/paper.sh
set terminal pngcairo size 1000,760 font "Sans,11"
set output png
set grid lc rgb "#dddddd" lw 1
set border 3 lw 1.2
set tics nomirror out
there(n) = int(system("test -s " . n . ".txt && echo 1 || echo 0"))
array color[6] = ["#1f6fb4", "#d9822b", "#2a8f4f", "#8e44ad", "#444444", "#c0392b"]
label(n) = n
set multiplot layout 2,2
set xlabel "axial strain" offset 0,0.4
set key noenhanced bottom right
array title[4] = ["axial stress over the confining one", "dilatancy, 100 (v/V - 1) (%)", "coordination number", "anisotropy of the fabric"]
do for [c=1:4] {
  set ylabel title[c]
  if (c > 1) { unset key }
  plot for [k=1:words(names)] there(word(names, k)) ? word(names, k) . ".txt" : "/dev/null" using 1:(column(c + 1)) with lines lw 2 \
    lc rgb color[k] title word(names, k)
}
