// As rotor.c, from C++, with the two atoms far apart in a vector of the caller's.
#include <holonomic.h>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

int main()
{
    const std::vector<double> masses(100, 1.0);
    std::vector<double> r(300, 0.0), v(300, 0.0), g(300, 0.0);
    const std::vector<std::int64_t> atoms = {7, 93};
    const double length = 2;
    r[3 * 7] = -1;
    r[3 * 93] = 1;
    v[3 * 7 + 1] = -1;
    v[3 * 93 + 1] = 1;

    hol_chains *handle = nullptr;
    if (hol_chains_create(100, masses.data(), &handle) != HOL_OK) return 1;
    const std::unique_ptr<hol_chains, void (*)(hol_chains *)> chains(handle, hol_chains_destroy);
    double tension = -1;
    if (hol_chains_add(chains.get(), 1, atoms.data(), &length) != HOL_OK) return 1;
    if (hol_forces(chains.get(), r.data(), v.data(), nullptr, nullptr, &tension, g.data(), HOL_WRITE, nullptr) !=
        HOL_OK)
        return 1;
    std::printf("holonomic %s\n", hol_version());
    std::printf("tension %.3f forces %.3f %.3f\n", tension, g[3 * 7], g[3 * 93]);
    std::printf("again: %s\n", hol_status_name(hol_chains_add(chains.get(), 1, atoms.data(), &length)));
    return 0;
}
