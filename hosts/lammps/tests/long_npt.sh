# SPDX-License-Identifier: GPL-2.0-only
# For case.sh, but not among the tests, for it takes an hour: what a barostat conserves over 250 ps.

# long_npt MOLECULE N SPACING TEMPERATURE PRESSURE: N^3 rigid molecules with this fix and with rigid/npt/small, and co2 with
# springs instead and no constraint; all from the same start, with the same bath. STEPS: of 2 fs.
long_npt() {
    local steps=${STEPS:-125000} bath="temp $4 $4 200 iso $5 $5 2000" fix
    local scene=(n "$2" spacing "$3" temperature "$4")
    local with=(later "thermo_style custom step temp pe etotal press v_momentum econserve vol")
    fluid start "$1" "${scene[@]}" select "rigid $INPUTS/$1.mol" dt 2 steps $((steps / 6)) every 1000 \
        motion "npt temp $4 $4 100 iso $5 $5 1000" after "write_data start${1} nocoeff"
    scene+=(data "start${1}")
    fluid holonomic "$1" "${scene[@]}" select "rigid $INPUTS/$1.mol" dt 2 steps "$steps" every 250 motion "npt $bath"
    fluid small "$1" "${scene[@]}" dt 2 steps "$steps" every 250 rigid none "${with[@]}" before "fix rigid all rigid/npt/small molecule $bath"
    [ "$1" != co2 ] || fluid springs co2 "${scene[@]}" dt 0.5 steps $((4 * steps)) every 1000 rigid none "${with[@]}" before "fix motion all npt $bath"
    for fix in holonomic small springs; do
        [ -f $fix ] || continue
        column Econserve $fix | awk -v fix=$fix '{ e[NR] = $1; s += $1; c += $1 * NR } END { m = s / NR; t = (NR + 1) / 2
            slope = (c - NR * m * t) / (NR * (NR * NR - 1) / 12); for (k = 1; k <= NR; ++k) q += (e[k] - m - slope * (k - t))^2
            printf "%-9s conserved: end less start %.3g, scatter about a line %.3g;", fix, e[NR] - e[1], sqrt(q / NR) }'
        printf ' means of temperature %.2f, pressure %.2f, volume %.1f\n' "$(mean Temp $fix)" "$(mean Press $fix)" "$(mean Volume $fix)"
    done
    below 1e-13 'f_rigid[1]' holonomic
    below 1e-8 v_momentum holonomic
}
