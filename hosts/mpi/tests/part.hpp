#ifndef HOLONOMIC_SUBDOMAIN_TESTS_PART_HPP
#define HOLONOMIC_SUBDOMAIN_TESTS_PART_HPP

#include <holonomic.h>
#include <mpi.h>

#include <cstdio>
#include <limits>

#include "../holonomic_subdomain.h"
#include "scenes.hpp"

constexpr double eps = std::numeric_limits<double>::epsilon();

static int rank, n_ranks, n_bad = 0;

inline void expect(bool good, const char *what, double number, double bound) {
    double all[2] = {number, good ? 0.0 : 1.0};
    MPI_Allreduce(MPI_IN_PLACE, all, 2, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    if (all[1] > 0) ++n_bad;
    if (rank == 0) std::printf("%-52s %10.3g  bound %9.3g  %s\n", what, all[0], bound, all[1] > 0 ? "FAILED" : "");
}

inline void need(int status, const char *message) {
    if (status == HOL_OK) return;
    std::fprintf(stderr, "process %d: %s: %s\n", rank, hol_status_name(status), message);
    MPI_Abort(MPI_COMM_WORLD, 1);
}

inline int add_up(void *, std::int64_t n, double *numbers) {
    return MPI_Allreduce(MPI_IN_PLACE, numbers, static_cast<int>(n), MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
}

/** What this process has of a scene. */
struct Part {
    std::vector<std::int64_t> atoms, bonds, cut;  // numbers in the scene; cut: on every process
    hol_subdomain *subdomain = nullptr;

    explicit Part(const Scene &scene) {
        std::vector<double> masses, lengths, cut_lengths;
        std::vector<std::int64_t> here(scene.n_atoms(), -1), pairs, ends;
        for (std::int64_t i = 0; i < scene.n_atoms(); ++i) {
            if (scene.owner[i] % n_ranks != rank) continue;
            here[i] = static_cast<std::int64_t>(atoms.size());
            atoms.push_back(i);
            masses.push_back(scene.masses[i]);
        }
        for (std::int64_t k = 0; k < scene.n_bonds(); ++k) {
            const std::int64_t a = scene.pairs[2 * k], b = scene.pairs[2 * k + 1];
            if (scene.owner[a] != scene.owner[b]) {
                cut.push_back(k);
                cut_lengths.push_back(scene.lengths[k]);
                ends.insert(ends.end(), {here[a], here[b]});
            } else if (here[a] >= 0) {
                bonds.push_back(k);
                lengths.push_back(scene.lengths[k]);
                pairs.insert(pairs.end(), {here[a], here[b]});
            }
        }
        need(hol_subdomain_create(rank, n_ranks, add_up, nullptr, static_cast<std::int64_t>(atoms.size()),
                                  masses.data(), static_cast<std::int64_t>(bonds.size()), pairs.data(), lengths.data(),
                                  static_cast<std::int64_t>(cut.size()), ends.data(), cut_lengths.data(), &subdomain),
             hol_subdomain_error_message());
    }

    std::vector<double> of_atoms(const std::vector<double> &x) const {
        std::vector<double> mine;
        for (std::int64_t i : atoms) mine.insert(mine.end(), &x[3 * i], &x[3 * i] + 3);
        return mine;
    }

    hol_subdomain_work work() const {
        hol_subdomain_work work;
        hol_subdomain_get_work(subdomain, &work);
        return work;
    }

    ~Part() { hol_subdomain_destroy(subdomain); }
};

#endif
