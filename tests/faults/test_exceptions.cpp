/**
 * Exceptions of every kind inside every function: the library asks for memory through operator new, which here belongs
 * to the program and throws, in turn at each place where it is asked, what no allocator would. Each must come out as a
 * status with a message, leave outputs and handles as they were, and leave the library usable.
 */
#include <holonomic.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "throwing_allocations.hpp"

namespace
{

constexpr int n_atoms = 4000, n_bonds = 3033;

/** A coil of 3000 bonds and eleven chains of three, some atoms left over, and room for every output. */
struct scene {
    hol_chains *chains = nullptr, *bodies = nullptr;  // the others: a rod, and what is joined to it
    hol_inverse *inverse = nullptr;
    std::vector<double> mass, length, gamma, r, v, f, moved, out;

    scene()
        : mass(n_atoms, 1.5), length(3000, 1.0), gamma(49, 0.3), r(3 * n_atoms), v(3 * n_atoms), f(3 * n_atoms),
          moved(3 * n_atoms), out(20000, 0.25)
    {
        for (std::size_t i = 0; i < n_atoms; ++i)
            for (std::size_t x = 0; x < 3; ++x) {
                const std::size_t at = 3 * i + x;
                r[at] = static_cast<double>(i / 3 + (x < i % 3 ? 1 : 0));  // steps along x, y, z in turn
                v[at] = 0.01 * static_cast<double>((7 * i + 3 * x) % 11);
                f[at] = static_cast<double>((5 * i + x) % 13);
                moved[at] = r[at] + 0.001 * v[at];
            }
        const std::int64_t rod = 2, rod_atoms[3] = {0, 1, 2};
        if (hol_chains_create(n_atoms, mass.data(), &chains) ||
            hol_chains_add_block(chains, 1, 3000, 0, length.data()) ||
            hol_chains_add_block(chains, 11, 3, 3003, length.data()) ||
            hol_inverse_create(chains, 1, r.data(), &inverse) || hol_chains_create(n_atoms, mass.data(), &bodies) ||
            hol_chains_add_rigid(bodies, 1, &rod, rod_atoms, r.data(), 1, rod_atoms + 1, length.data()) ||
            hol_chains_add_block(bodies, 1, 50, 10, length.data()))
            std::printf("no scene: %s\n", hol_error_message()), std::exit(1);
        // Whatever a handle prepares for its calculations is thrown away, so that it is prepared in the call under
        // test.
        hol_chains_set_active(chains, nullptr);
    }
    ~scene()
    {
        hol_inverse_destroy(inverse);
        hol_chains_destroy(chains);
        hol_chains_destroy(bodies);
    }
    scene(const scene &) = delete;
    scene &operator=(const scene &) = delete;
};

int create_and_destroy(scene &s)
{
    hol_chains *made = s.chains;
    const int status = hol_chains_create(50, s.mass.data(), &made);
    if (status != HOL_OK && made != nullptr) return -1;
    hol_chains_destroy(made);
    return status;
}

int invert(scene &s)
{
    hol_inverse *made = s.inverse;
    const int status = hol_inverse_create(s.chains, 0, s.r.data(), &made);
    if (status != HOL_OK && made != nullptr) return -1;
    hol_inverse_destroy(made);
    return status;
}

int add_one(scene &s)
{
    static const std::int64_t atoms[4] = {3980, 3990, 3985, 3999};
    const std::int64_t before = hol_chains_n_molecules(s.chains);
    const int status = hol_chains_add(s.chains, 3, atoms, s.length.data());
    return hol_chains_n_molecules(s.chains) == before + (status == HOL_OK ? 1 : 0) ? status : -1;
}

int add_several(scene &s)
{
    const std::int64_t before = hol_chains_n_molecules(s.chains);
    const int status = hol_chains_add_block(s.chains, 20, 3, 3700, s.length.data());
    return hol_chains_n_molecules(s.chains) == before + (status == HOL_OK ? 20 : 0) ? status : -1;
}

/** A tetrahedron with a tail, and three rods. */
int add_bodies(scene &s)
{
    static const std::int64_t size = 4, atoms[4] = {3980, 3990, 3985, 3999}, tail[2] = {3999, 3991};
    static const double places[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const std::int64_t before = hol_chains_n_molecules(s.chains);
    const int status = hol_chains_add_rigid(s.chains, 1, &size, atoms, places, 1, tail, s.length.data());
    return hol_chains_n_molecules(s.chains) == before + (status == HOL_OK ? 1 : 0) ? status : -1;
}

int add_copies_of_bodies(scene &s)
{
    static const std::int64_t size = 2, atoms[2] = {0, 1};
    static const double places[6] = {0, 0, 0, 1, 0, 0};
    const std::int64_t before = hol_chains_n_molecules(s.chains);
    const int status =
        hol_chains_add_rigid_molecules(s.chains, 3, 2, 3900, 1, &size, atoms, places, 0, nullptr, nullptr);
    return hol_chains_n_molecules(s.chains) == before + (status == HOL_OK ? 3 : 0) ? status : -1;
}

int add_copies_of_relations(scene &s)
{
    static const std::int64_t size = 2, atoms[2] = {0, 1};
    static const double same[2] = {1, -1};
    const std::int64_t before = hol_chains_n_molecules(s.chains);
    const int status =
        hol_chains_add_linear_molecules(s.chains, 3, 2, 3900, 1, &size, atoms, same, 0, nullptr, nullptr);
    return hol_chains_n_molecules(s.chains) == before + (status == HOL_OK ? 3 : 0) ? status : -1;
}

int set_active(scene &s)
{
    const unsigned char active[12] = {1, 0, 1, 1, 0};
    return hol_chains_set_active(s.chains, active);
}

int set_box(scene &s)
{
    const double box[9] = {9e3, 0, 0, 0, 9e3, 0, 0, 0, 9e3};
    return hol_chains_set_box(s.chains, box);
}

int offsets(scene &s)
{
    std::int64_t o[64];
    return hol_chains_offsets(s.chains, o);
}

int atoms_of_a_chain(scene &s)
{
    std::int64_t atoms[4];
    return hol_chains_atoms(s.chains, 3, atoms);
}

int forces(scene &s)
{
    double *const o = s.out.data();
    return hol_forces(s.chains, s.r.data(), s.v.data(), s.f.data(), o, nullptr, o + n_bonds, HOL_WRITE, nullptr);
}

int forces_with_bodies(scene &s)
{
    double *const o = s.out.data();
    return hol_forces(s.bodies, s.r.data(), s.v.data(), s.f.data(), o, nullptr, o + n_bonds, HOL_WRITE, nullptr);
}

int velocities(scene &s)
{
    return hol_project_velocities(s.chains, s.r.data(), s.moved.data(), s.out.data(), nullptr);
}

int positions(scene &s)
{
    return hol_project_positions(s.chains, s.r.data(), s.moved.data(), nullptr, 0.001, s.out.data(), 0, nullptr,
                                 nullptr);
}

int violation(scene &s)
{
    hol_worst worst;
    return hol_violation(s.chains, s.r.data(), s.v.data(), &worst);
}

int metric(scene &s)
{
    double *const o = s.out.data();
    return hol_metric(s.chains, s.r.data(), 1, o, o + 20, nullptr, o + 40, HOL_WRITE);
}

int inverse_bound(scene &s)
{
    double *const o = s.out.data();
    return hol_inverse_error_bound(s.inverse, s.v.data(), s.f.data(), s.length.data(), o, o + 5);
}

int partition(scene &s)
{
    const double mass[5] = {1, 12, 1, 16, 1};
    double *const o = s.out.data();
    return hol_partition_function(4, mass, o, o + 1, o + 2);
}

struct operation {
    const char *name;
    int (*call)(scene &);
};

const operation operations[] = {
    // left out: settings that keep one number
    {"hol_chains_create", create_and_destroy},
    {"hol_chains_add", add_one},
    {"hol_chains_add_block", add_several},
    {"hol_chains_add_rigid", add_bodies},
    {"hol_chains_add_rigid_molecules", add_copies_of_bodies},
    {"hol_chains_add_linear_molecules", add_copies_of_relations},
    {"hol_forces with bodies", forces_with_bodies},
    {"hol_chains_set_box", set_box},
    {"hol_chains_set_active", set_active},
    {"hol_chains_offsets", offsets},
    {"hol_chains_atoms", atoms_of_a_chain},
    {"hol_forces", forces},
    {"hol_project_velocities", velocities},
    {"hol_project_positions", positions},
    {"hol_violation", violation},
    {"hol_metric", metric},
    {"hol_inverse_create", invert},
    {"hol_inverse_entry", [](scene &s) { return hol_inverse_entry(s.inverse, HOL_UNIT_DIAGONAL, 0, 1, s.out.data()); }},
    {"hol_inverse_row", [](scene &s) { return hol_inverse_row(s.inverse, HOL_PHYSICAL, 1, s.out.data()); }},
    {"hol_inverse_matrix", [](scene &s) { return hol_inverse_matrix(s.inverse, HOL_PHYSICAL, s.out.data()); }},
    {"hol_inverse_band", [](scene &s) { return hol_inverse_band(s.inverse, HOL_PHYSICAL, 1, s.out.data()); }},
    {"hol_inverse_condition", [](scene &s) { return hol_inverse_condition(s.inverse, s.out.data()); }},
    {"hol_inverse_error_bound", inverse_bound},
    {"hol_tridiagonal_pivots", [](scene &s) { return hol_tridiagonal_pivots(50, s.gamma.data(), s.out.data()); }},
    {"hol_tridiagonal_log_det", [](scene &s) { return hol_tridiagonal_log_det(50, s.gamma.data(), s.out.data()); }},
    {"hol_tridiagonal_solve",
     [](scene &s) { return hol_tridiagonal_solve(50, s.gamma.data(), s.length.data(), s.out.data()); }},
    {"hol_tridiagonal_inverse_entry",
     [](scene &s) { return hol_tridiagonal_inverse_entry(50, s.gamma.data(), 3, 17, s.out.data()); }},
    {"hol_tridiagonal_inverse_band",
     [](scene &s) { return hol_tridiagonal_inverse_band(50, s.gamma.data(), 1, s.out.data()); }},
    {"hol_partition_function", partition},
};

void expect(bool right, const operation &what, const char *words)
{
    if (right) return;
    std::printf("%s, %s thrown: %s (last message: %s)\n", what.name, kind_names[thrown], words, hol_error_message());
    std::exit(1);
}

/** Throws at each allocation of the operation in turn; returns how many there were. */
long throw_at_each(const operation &what)
{
    for (long n = 0;; ++n) {
        scene s;
        const std::vector<double> before = s.out, moved = s.moved;
        left = n;
        int status = -1;
        try {
            status = what.call(s);
        } catch (...) {  // nothing in an operation but the library allocates
            left = -1;
            expect(false, what, "an exception crossed the boundary");
        }
        const bool met = left < 0;
        left = -1;
        if (!met) {
            expect(status == HOL_OK, what, "fails without an exception");
            return n;
        }
        const bool memory = thrown == BAD_ALLOC || thrown == BAD_LENGTH;
        expect(status == (memory ? HOL_ERR_MEMORY : HOL_ERR_INTERNAL), what, "another status");
        const bool with_words = thrown == RUNTIME_ERROR || thrown == SYSTEM_ERROR || thrown == DERIVED;
        const char *const words = memory ? "out of memory" : with_words ? "thrown on purpose" : "internal error";
        expect(std::strstr(hol_error_message(), words) != nullptr, what, "another message");
        expect(s.out == before && s.moved == moved, what, "an output was written");
        expect(what.call(s) == HOL_OK, what, "the handle is of no use afterwards");
    }
}

}  // namespace

int main()
{
    long total = 0;
    for (const operation &what : operations) {
        long met = 0;
        for (int k = 0; k < KINDS; ++k) {
            thrown = static_cast<kind>(k);
            met += throw_at_each(what);
        }
        std::printf("%-30s %4ld exceptions, none crossed\n", what.name, met);
        total += met;
    }
    if (total == 0) std::puts("the library does not ask this program for memory: nothing was tested");
    return total == 0;
}
