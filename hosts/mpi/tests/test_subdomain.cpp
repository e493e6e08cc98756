// Divided molecules against the same molecules whole, with MPI alone:
//   mpirun -n 2 test_subdomain KIND BONDS PIECES blocks|slabs|box [TIMES]
// A molecule is cut into pieces, which processes get in turns; each process also has the library solve the whole.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>

#include "part.hpp"

namespace {

/** Least time of some calls, of the slowest process. */
double time_of(int n_times, const std::function<void()> &call) {
    double least = HUGE_VAL;
    for (int k = 0; k < n_times; ++k) {
        MPI_Barrier(MPI_COMM_WORLD);
        const double began = MPI_Wtime();
        call();
        double took = MPI_Wtime() - began;
        MPI_Allreduce(MPI_IN_PLACE, &took, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
        least = std::min(least, took);
    }
    return least;
}

struct Test {
    const Scene &scene;
    hol_chains *chains = nullptr;
    Part part;

    explicit Test(const Scene &s) : scene(s), part(s) {
        need(hol_chains_create(scene.n_atoms(), scene.masses.data(), &chains), hol_error_message());
        if (!scene.box.empty()) {
            const double L[9] = {0.01, 0.002, 0.003, 0, -0.02, 0.001, 0, 0, 0.015};
            need(hol_chains_set_box(chains, scene.box.data()), hol_error_message());
            need(hol_chains_set_box_rate(chains, L), hol_error_message());
            need(hol_subdomain_set_box(part.subdomain, scene.box.data()), hol_subdomain_error_message());
            need(hol_subdomain_set_box_rate(part.subdomain, L), hol_subdomain_error_message());
        }
        need(hol_chains_add_bonds(chains, scene.n_bonds(), scene.pairs.data(), scene.lengths.data()),
             hol_error_message());
    }
    ~Test() { hol_chains_destroy(chains); }

    double weight(std::int64_t atom) const { return scene.masses[atom] > 0 ? 1 / scene.masses[atom] : 0; }

    /** A lower bound of abs(A^-1) S, the scale of docs/stability.md: its diagonal element, or the multiplier. */
    std::vector<double> scales(const std::vector<double> &lambda, bool with_forces) const {
        std::vector<double> scale(lambda.size());
        for (std::int64_t k = 0; k < scene.n_bonds(); ++k) {
            const std::int64_t i = scene.pairs[2 * k], j = scene.pairs[2 * k + 1];
            double pull = 0, dd = 0;
            for (int c = 0; c < 3; ++c) {
                // A bond across a face of the box looks longer here, by what does not matter to the test.
                const double d = scene.box.empty() ? scene.r[3 * j + c] - scene.r[3 * i + c] : scene.lengths[k],
                             u = scene.v[3 * j + c] - scene.v[3 * i + c];
                dd += d * d;
                pull += with_forces ? std::fabs(d) * (weight(i) * std::fabs(scene.f[3 * i + c]) +
                                                      weight(j) * std::fabs(scene.f[3 * j + c])) +
                                          u * u
                                    : std::fabs(d) * (std::fabs(scene.v[3 * i + c]) + std::fabs(scene.v[3 * j + c]));
            }
            scale[k] = std::fabs(lambda[k]) + pull / ((weight(i) + weight(j)) * dd) / 2;
        }
        // In a rod a pull reaches all bonds.
        if (scene.stiff) std::fill(scale.begin(), scale.end(), *std::max_element(scale.begin(), scale.end()));
        return scale;
    }

    /** As in docs/stability.md; a rod has 4 more for each bond. */
    double bound() const {
        const auto n = static_cast<double>(scene.n_bonds());
        return (2 * (16 + std::sqrt(n)) + (scene.stiff ? 4 * n : 0)) * eps;
    }

    void compare(const char *what, const std::vector<double> &whole, const std::vector<double> &mine,
                 const std::vector<double> &cut, bool with_forces) {
        const std::vector<double> scale = scales(whole, with_forces);
        double worst = 0;
        for (std::size_t k = 0; k < mine.size(); ++k)
            worst = std::max(worst, std::fabs(mine[k] - whole[part.bonds[k]]) / scale[part.bonds[k]]);
        for (std::size_t k = 0; k < cut.size(); ++k)
            worst = std::max(worst, std::fabs(cut[k] - whole[part.cut[k]]) / scale[part.cut[k]]);
        expect(worst <= bound(), what, worst, bound());
    }

    void compare_atoms(const char *what, const std::vector<double> &whole, const std::vector<double> &mine,
                       double tolerance) {
        double worst = 0, size = 0;
        for (double x : whole) size = std::max(size, std::fabs(x));
        for (std::size_t k = 0; k < mine.size(); ++k)
            worst = std::max(worst, std::fabs(mine[k] - whole[3 * part.atoms[k / 3] + k % 3]));
        expect(worst <= tolerance * size, what, worst / size, tolerance);
    }

    void compare_virials(const char *what, const double *whole, double *mine, double tolerance = 1e-12) {
        MPI_Allreduce(MPI_IN_PLACE, mine, 9, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
        double worst = 0, size = 0;
        for (int k = 0; k < 9; ++k) size = std::max(size, std::fabs(whole[k]));
        for (int k = 0; k < 9; ++k) worst = std::max(worst, std::fabs(mine[k] - whole[k]) / size);
        expect(worst <= tolerance, what, worst, tolerance);
    }

    void run(int n_times) {
        const std::size_t n = scene.lengths.size();
        std::vector<double> lambda(n), g(scene.r.size()), mine(part.bonds.size()), cut(part.cut.size());
        std::vector<double> r = part.of_atoms(scene.r), v = part.of_atoms(scene.v), f = part.of_atoms(scene.f),
                            my_g(r.size());
        double virial[9], my_virial[9];
        double times[3], own[4];
        // Forces
        hol_subdomain_work before = part.work();
        // Tells what was done, and that it took as many sums as it has to, whatever the molecule is.
        const auto told = [&](const char *what, int n_sums, int n_more = 0) {
            const hol_subdomain_work after = part.work();
            const std::int64_t sums = after.n_sums - before.n_sums;
            expect(sums >= n_times * n_sums && sums <= n_times * (n_sums + n_more), "sums over processes",
                   static_cast<double>(sums), n_times * n_sums);
            if (rank == 0)
                std::printf("%-12s %lld sums, %lld numbers, %lld solutions (%.1e)\n", what,
                            static_cast<long long>(after.n_sums - before.n_sums) / n_times,
                            static_cast<long long>(after.n_numbers - before.n_numbers) / n_times,
                            static_cast<long long>(after.n_solves - before.n_solves) / n_times, after.last_change);
            before = after;
        };
        times[0] = time_of(n_times, [&] {
            need(hol_forces(chains, scene.r.data(), scene.v.data(), scene.f.data(), lambda.data(), nullptr, g.data(),
                            HOL_WRITE, virial),
                 hol_error_message());
        });
        own[0] = time_of(
            n_times, [&] { need(hol_subdomain_factorize(part.subdomain, r.data()), hol_subdomain_error_message()); });
        told("factorize", 2);
        own[1] = time_of(n_times, [&] {
            need(hol_subdomain_forces(part.subdomain, v.data(), f.data(), mine.data(), cut.data(), my_g.data(),
                                      HOL_WRITE, my_virial),
                 hol_subdomain_error_message());
        });
        told("forces", 3);
        compare("multipliers of forces", lambda, mine, cut, true);
        compare_atoms("constraint forces", g, my_g, 1e-12);
        compare_virials("virial", virial, my_virial);
        // Velocities
        std::vector<double> whole_v;
        times[1] = time_of(n_times, [&] {
            whole_v = scene.v;
            need(hol_project_velocities(chains, scene.r.data(), whole_v.data(), lambda.data(), virial),
                 hol_error_message());
        });
        std::vector<double> my_v;
        own[2] = time_of(n_times, [&] {
            my_v = v;
            need(hol_subdomain_project_velocities(part.subdomain, my_v.data(), mine.data(), cut.data(), my_virial),
                 hol_subdomain_error_message());
        });
        told("velocities", 3);
        compare("multipliers of velocities", lambda, mine, cut, false);
        compare_atoms("velocities", whole_v, my_v, 1e-13);
        compare_virials("virial of velocities", virial, my_virial);
        hol_worst worst;
        double length, rate;
        need(hol_violation(chains, scene.r.data(), whole_v.data(), &worst), hol_error_message());
        need(hol_subdomain_violation(part.subdomain, r.data(), my_v.data(), &length, &rate),
             hol_subdomain_error_message());
        // As docs/stability.md has it for what is left of d.dv
        const double largest =
            (16 + std::sqrt(static_cast<double>(n))) * eps * *std::max_element(scene.v.begin(), scene.v.end());
        expect(std::fabs(length - worst.length) <= 1e-15, "largest error of a length", length, worst.length + 1e-15);
        expect(rate <= worst.rate + largest, "largest rate", rate, worst.rate + largest);
        need(hol_violation(chains, scene.r.data(), scene.v.data(), &worst), hol_error_message());
        need(hol_subdomain_violation(part.subdomain, r.data(), v.data(), &length, &rate),
             hol_subdomain_error_message());
        expect(std::fabs(rate - worst.rate) <= largest, "largest rate before", rate, worst.rate);
        // Positions
        const double dt = scene.time_step;
        double extent = 1;
        for (double x : scene.r) extent = std::max(extent, std::fabs(x));
        const double rounding = 16 * eps * extent / dt;
        std::vector<double> moved = scene.r, drift;
        for (std::size_t k = 0; k < moved.size(); ++k) {
            const double w = weight(static_cast<std::int64_t>(k / 3));
            moved[k] += dt * whole_v[k] + 0.5 * dt * dt * w * scene.f[k];
        }
        std::vector<double> whole_r;
        times[2] = time_of(n_times, [&] {
            whole_r = moved, drift = whole_v;
            need(hol_project_positions(chains, scene.r.data(), whole_r.data(), drift.data(), dt, lambda.data(), 0,
                                       virial, nullptr),
                 hol_error_message());
        });
        std::vector<double> my_r, my_drift;
        int iterations = 0;
        before = part.work();
        own[3] = time_of(n_times, [&] {
            my_r = part.of_atoms(moved), my_drift = my_v;
            need(hol_subdomain_project_positions(part.subdomain, my_r.data(), my_drift.data(), dt, mine.data(),
                                                 cut.data(), my_virial, &iterations),
                 hol_subdomain_error_message());
        });
        told("positions", 2 + iterations, iterations);  // two for a step with new factors
        compare_atoms("positions", whole_r, my_r, 1e-13);
        compare_atoms("velocities after the drift", drift, my_drift, rounding);
        compare_virials("virial of positions", virial, my_virial, rounding / dt);
        expect_lengths(my_r, extent);
        if (rank == 0) {
            const double per_bond = 1e9 / static_cast<double>(n);
            std::printf("cut bonds %zu, rows %lld, entries %lld, steps %d\n", part.cut.size(),
                        static_cast<long long>(part.work().n_rows), static_cast<long long>(part.work().n_entries),
                        iterations);
            std::printf(
                "ns a bond, whole: forces %.1f velocities %.1f positions %.1f; divided: factorize %.1f forces %.1f "
                "velocities %.1f positions %.1f\n",
                per_bond * times[0], per_bond * times[1], per_bond * times[2], per_bond * own[0], per_bond * own[1],
                per_bond * own[2], per_bond * own[3]);
        }
    }

    /** Lengths of all bonds, from positions that all processes put together. */
    void expect_lengths(const std::vector<double> &mine, double extent) {
        std::vector<double> r(scene.r.size(), 0.0);
        for (std::size_t k = 0; k < mine.size(); ++k) r[3 * part.atoms[k / 3] + k % 3] = mine[k];
        MPI_Allreduce(MPI_IN_PLACE, r.data(), static_cast<int>(r.size()), MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
        hol_worst worst;
        need(hol_violation(chains, r.data(), nullptr, &worst), hol_error_message());
        double shortest = HUGE_VAL;
        for (double a : scene.lengths) shortest = std::min(shortest, a);
        const double bound = 8 * eps * (1 + extent / shortest);
        expect(worst.length <= bound, "bond lengths", worst.length, bound);
    }
};

/** What goes wrong on one process is an error on all, and nothing is written. */
void test_errors(const Scene &scene) {
    const Part part(scene);
    std::vector<double> r = part.of_atoms(scene.r), f = part.of_atoms(scene.f), lambda(part.bonds.size(), 7.0);
    const auto same = [&](int status, int wanted, const char *what) { expect(status == wanted, what, status, wanted); };
    same(hol_subdomain_forces(part.subdomain, nullptr, f.data(), lambda.data(), nullptr, nullptr, HOL_WRITE, nullptr),
         HOL_ERR_STATE, "forces before anything was factorized");
    same(hol_subdomain_factorize(part.subdomain, r.data()), HOL_OK, "factorize");
    if (rank == n_ranks - 1) f[0] = NAN;
    same(hol_subdomain_forces(part.subdomain, nullptr, f.data(), lambda.data(), nullptr, nullptr, HOL_WRITE, nullptr),
         HOL_ERR_NOT_FINITE, "no number on one process");
    expect(std::all_of(lambda.begin(), lambda.end(), [](double x) { return x == 7; }), "nothing was written", 0, 0);
    f = part.of_atoms(scene.f);
    same(hol_subdomain_forces(part.subdomain, nullptr, f.data(), lambda.data(), nullptr, nullptr, HOL_WRITE, nullptr),
         HOL_OK, "the same call with numbers");
    // A bond that leaps
    std::vector<double> moved = r;
    if (rank == 0) moved[0] += 1000;
    const std::vector<double> before = moved;
    const int status =
        hol_subdomain_project_positions(part.subdomain, moved.data(), nullptr, 1, nullptr, nullptr, nullptr, nullptr);
    expect(status != HOL_OK && moved == before, "positions out of reach", status, HOL_OK);
    // An atom that two processes name, or one end twice
    hol_subdomain *none = nullptr;
    const double mass[2] = {1, 1}, length = 1;
    const std::int64_t ends[2] = {0, rank == 0 ? 1 : 0};
    same(hol_subdomain_create(rank, n_ranks, add_up, nullptr, 2, mass, 0, nullptr, nullptr, 1, ends, &length, &none),
         n_ranks > 1 ? HOL_ERR_INDEX : HOL_OK, "an end that every process names");
    hol_subdomain_destroy(none);
    const std::int64_t nobody[2] = {-1, rank == 0 ? 1 : -1};
    same(hol_subdomain_create(rank, n_ranks, add_up, nullptr, 2, mass, 0, nullptr, nullptr, 1, nobody, &length, &none),
         HOL_ERR_INDEX, "an end that no process names");
}

/** Bonds that depend on each other, ever more nearly: what is not refused is right, in as many sums as anything else.
 */
void test_refusals() {
    int n_solved = 0;
    for (int k = 0; k <= 12; ++k) {
        const Scene scene = make_scene("flat", k, 4, "blocks");
        Test test(scene);
        const std::vector<double> r = test.part.of_atoms(scene.r), f = test.part.of_atoms(scene.f);
        std::vector<double> whole(scene.lengths.size()), mine(test.part.bonds.size()), cut(test.part.cut.size());
        const std::int64_t before = test.part.work().n_sums;
        int status = hol_subdomain_factorize(test.part.subdomain, r.data());
        if (status == HOL_OK)
            status = hol_subdomain_forces(test.part.subdomain, nullptr, f.data(), mine.data(), cut.data(), nullptr,
                                          HOL_WRITE, nullptr);
        if (status != HOL_OK) {
            expect(status == HOL_ERR_DEGENERATE, "a flat triangle is refused", status, HOL_ERR_DEGENERATE);
            continue;
        }
        expect(test.part.work().n_sums == before + 5, "sums over processes",
               static_cast<double>(test.part.work().n_sums - before), 5);
        need(hol_forces(test.chains, scene.r.data(), nullptr, scene.f.data(), whole.data(), nullptr, nullptr, HOL_WRITE,
                        nullptr),
             hol_error_message());
        test.compare("multipliers of a flat triangle", whole, mine, cut, true);
        ++n_solved;
    }
    expect(n_solved >= 3 && n_solved <= 12, "triangles that were solved", n_solved, 12);
}

}  // namespace

int main(int argc, char **argv) {
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
    if (argc < 5) return 2;
    const Scene scene = make_scene(argv[1], std::atoi(argv[2]), std::atoi(argv[3]), argv[4]);
    if (rank == 0)
        std::printf("%s of %lld bonds in %s pieces (%s) on %d processes\n", argv[1],
                    static_cast<long long>(scene.n_bonds()), argv[3], argv[4], n_ranks);
    Test(scene).run(argc > 5 ? std::atoi(argv[5]) : 1);
    if (scene.n_bonds() < 2000) test_errors(scene), test_refusals();
    MPI_Finalize();
    return n_bad > 0;
}
