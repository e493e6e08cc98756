// The header by itself, as C++ of every standard that the compiler knows, with every warning an error.
#include <holonomic.h>

#include <cstdio>

int main()
{
    const double mass[2] = {1, 1}, length = 1, r[6] = {0, 0, 0, 1, 0, 0}, v[6] = {0, 0, 0, 0, 2, 0};
    double tension = 0;
    hol_chains *chains = NULL;
    int status = hol_chains_create(2, mass, &chains);
    if (!status) status = hol_chains_add_block(chains, 1, 1, 0, &length);
    if (!status) status = hol_forces(chains, r, v, NULL, NULL, &tension, NULL, HOL_WRITE, NULL);
    hol_chains_destroy(chains);
    std::printf("%s %s %g\n", hol_version(), hol_status_name(status), tension);
    return status == HOL_OK && tension == 2 ? 0 : 1;
}
