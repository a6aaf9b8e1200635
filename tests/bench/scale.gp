# Processor ms of events by leaves, a picture for each kind of world, both axes logarithmic.
#
#     gnuplot -e "csv='out/scale.csv'; folder='out/pictures'" tests/bench/scale.gp
#
# Colours are Okabe and Ito's, told apart with any eye; marks differ too.
set style line 1 lc rgb '#D55E00' lw 2.5 pt 7
set style line 2 lc rgb '#E69F00' lw 2.0 pt 5
set style line 3 lc rgb '#0072B2' lw 2.0 pt 9
set style line 4 lc rgb '#56B4E9' lw 2.0 pt 11
set style line 5 lc rgb '#009E73' lw 2.0 pt 13
set style line 6 lc rgb '#909090' lw 1.5 pt 4
worlds = system(sprintf("awk -F, '!/^#/ && $1 != \"world\" && $1 != \"pair\" && !seen[$1]++ { print $1 }' '%s'", csv))
curve(world, event) = sprintf( \
	"< awk -F, '$1 == \"%s\" && $4 == \"%s\" && ($5 == \"cpu ms\" || $5 == \"call cpu ms\") { if (!($2 in l)) l[$2] = $3; m[$2] += $6 } END { for (n in m) print l[n], m[n] }' '%s' | sort -n", \
	world, event, csv)
set logscale xy
set format y '%g'
set xlabel 'leaves'
set ylabel 'processor ms'
set grid xtics ytics lc rgb '#d8d8d8'
set border lc rgb '#606060'
set key top left reverse Left samplen 3 spacing 1.1
do for [kind in 'png svg'] {
	do for [k = 1:words(worlds)] {
		if (kind eq 'png') {
			set terminal pngcairo size 900,620 font 'sans,11' background rgb 'white'
		} else {
			set terminal svg size 900,620 font 'sans,12' background rgb 'white'
		}
		world = word(worlds, k)
		set output sprintf('%s/scale-%s.%s', folder, world, kind)
		set title sprintf('What one change costs in a %s', world)
		plot curve(world, 'first') with linespoints ls 6 title 'all rows, once', \
			curve(world, 'ten move') with linespoints ls 2 title 'ten move', \
			curve(world, 'one moves') with linespoints ls 1 title 'one moves', \
			curve(world, 'one more stays') with linespoints ls 3 title 'one static thing more', \
			curve(world, 'one more') with linespoints ls 4 title 'one movable thing more', \
			curve(world, 'material') with linespoints ls 5 title 'a material changes'
		unset output
	}
}
