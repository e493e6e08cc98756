// Prints the kernels for one molecule as a compiler for a GPU takes them without OpenMM:
//     registers PRECISION MAX_ENTRIES BONDS      bonds are pairs of atoms, 0-1 0-2 1-2
#include <holonomic.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

static void ask(int status) {
    if (status == HOL_OK) return;
    std::fprintf(stderr, "%s\n", hol_error_message());
    std::exit(1);
}

int main(int argc, char **argv) {
    std::vector<std::int64_t> pairs;
    std::int64_t nAtoms = 0;
    for (int k = 3; k < argc; ++k) {
        int i, j;
        if (std::sscanf(argv[k], "%d-%d", &i, &j) != 2) return 2;
        pairs.insert(pairs.end(), {i, j});
        nAtoms = std::max<std::int64_t>(nAtoms, std::max(i, j) + 1);
    }
    const std::vector<double> masses(nAtoms, 1.0), lengths(pairs.size() / 2, 0.1);
    hol_chains *chains = nullptr;
    hol_device_plan *plan = nullptr;
    ask(hol_chains_create(nAtoms, masses.data(), &chains));
    ask(hol_chains_add_bonds(chains, static_cast<std::int64_t>(lengths.size()), pairs.data(), lengths.data()));
    ask(hol_device_plan_create(chains, static_cast<hol_device_precision>(std::atoi(argv[1])), std::atoi(argv[2]),
                               &plan));
    std::puts(hol_device_plan_source(plan));
    hol_device_plan_destroy(plan);
    hol_chains_destroy(chains);
}
