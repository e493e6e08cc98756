#include "core/rigid/equimomental.hpp"

#include <algorithm>

#include "boundary.hpp"

using holonomic::guarded;
using holonomic::need;

int hol_equimomental_points(double mass, const double *centre, const double *inertia, int64_t *n_points, double *masses,
                            double *places) {
    return guarded<holonomic::LongDoubleEnvironment>(__func__, [&] {
        need(inertia, "inertia");
        need(n_points, "n_points");
        need(masses, "masses");
        need(places, "places");
        const holonomic::rigid::MassPoints found = holonomic::rigid::equimomental_points(mass, centre, inertia);
        *n_points = found.n;
        std::fill_n(masses, found.n, found.mass);
        std::copy_n(found.coordinates[0], 3 * found.n, places);
    });
}
