# What scripts/bench measures and about how long it takes; to be read with `.`, in bash. Uses its variables extent, program,
# out, start, load and failed.

# Processor seconds of a build from nothing, and of each section, on a common machine: for the estimates alone.
build_cpu=110
sections=(acceleration velocity position metric solve skips condition drift molecules adding isa)
full_seconds=(45 60 120 20 15 70 5 20 150 10 15)
quick_seconds=(4 4 7 2 1 6 1 2 30 2 1)

# Sum of the estimates from section number $1 on.
seconds_from() {
    local i sum=0
    for ((i = $1; i < ${#sections[@]}; ++i)); do
        if [ -n "$extent" ]; then sum=$((sum + quick_seconds[i])); else sum=$((sum + full_seconds[i])); fi
    done
    echo "$sum"
}

measuring_estimate() {
    if [ -n "$run" ]; then echo "measuring, about $(seconds_from 0) s"; else echo "the report"; fi
}

# A section is a process of its own, so that one that fails does not take the others with it.
measure_all() {
    local i section isa left
    for ((i = 0; i < ${#sections[@]}; ++i)); do
        section=${sections[i]}
        left=$(seconds_from "$i")
        # As the run has gone so far, once it has gone for a while.
        if [ "$i" -ge 2 ]; then left=$((left * (SECONDS - start) / ($(seconds_from 0) - left))); fi
        say "$section, section $((i + 1)) of ${#sections[@]}: $((SECONDS - start)) s so far, about $left s to go"
        if [ "$section" != isa ]; then
            # shellcheck disable=SC2086
            "$program" $extent --out "$out" "$section" || failed="$failed $section"
            continue
        fi
        for isa in baseline avx2 avx512vl; do
            # The variable is obeyed only where the machine and the build have the set.
            [ "$(HOLONOMIC_ISA=$isa "$program" --isa)" = "$isa" ] || continue
            # shellcheck disable=SC2086
            HOLONOMIC_ISA=$isa "$program" $extent --out "$out" isa || failed="$failed isa-$isa"
        done
    done
}

describe_machine() {
    printf 'date: %s\n' "$(date -u +%Y-%m-%d)"
    printf 'machine: %s, %s cores\n' "$(awk -F': ' '/^model name/ { print $2; exit }' /proc/cpuinfo 2>/dev/null || uname -m)" \
        "$(getconf _NPROCESSORS_ONLN)"
    lscpu 2>/dev/null | awk -F': +' '/^L1d|^L2|^L3/ { printf "%s: %s\n", $1, $2 }'
    printf 'system: %s\n' "$(. /etc/os-release 2>/dev/null && echo "$PRETTY_NAME, $(uname -sr)" || uname -sr)"
    printf 'compiler: %s\n' "$(c++ --version | head -n 1)"
    printf 'holonomic: %s, instruction set %s\n' "$(git describe --always --dirty 2>/dev/null || echo unknown)" "$("$program" --isa)"
    for package in libeigen3-dev liblapack-dev libopenmm-dev libbenchmark-dev lammps-examples gromacs-data; do
        dpkg-query -W -f '${Package}: ${Version}\n' "$package" 2>/dev/null
    done
    printf 'command: scripts/bench%s\n' "${extent:+ $extent}"
    printf 'load before: %s\n' "$load"
    printf 'built in: %d s; measured in: %d s\n' "$((start - began))" "$((SECONDS - start))"
}
