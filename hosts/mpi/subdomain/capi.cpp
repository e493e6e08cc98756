// The functions of holonomic_subdomain.h: arguments checked, errors turned into statuses, nothing written on an error.
#include <cmath>

#include "subdomain.hpp"

using namespace holonomic_subdomain;

struct hol_subdomain {
    explicit hol_subdomain(Subdomain made) : all(std::move(made)) {}
    Subdomain all;
};

namespace {

thread_local std::string message;

template <class Function>
int guarded(Function function) noexcept {
    try {
        try {
            function();
            return HOL_OK;
        } catch (const Failure &failure) {
            message = failure.message;
            return failure.status;
        } catch (const std::bad_alloc &) {
            message = "out of memory";
            return HOL_ERR_MEMORY;
        }
    } catch (...) {
        return HOL_ERR_INTERNAL;
    }
}

void need(bool there, const char *what) {
    if (!there) throw Failure{HOL_ERR_NULL, std::string(what) + " is NULL"};
}

void need_finite(const double *x, int n_atoms, const char *what) {
    for (std::size_t k = 0; x && k < 3 * static_cast<std::size_t>(n_atoms); ++k)
        if (!std::isfinite(x[k]))
            throw Failure{HOL_ERR_NOT_FINITE, std::string(what) + " of atom " + std::to_string(k / 3)};
}

/** What each call begins with. What is wrong on one process alone is found out by all at the first sum. */
template <class Check>
Subdomain &begin(hol_subdomain *subdomain, bool factorized, Check check_arguments) {
    need(subdomain, "subdomain");
    Subdomain &all = subdomain->all;
    if (factorized && !all.factorized()) throw Failure{HOL_ERR_STATE, "hol_subdomain_factorize comes first"};
    all.processes.forget();
    all.processes.alone(check_arguments);
    return all;
}

void give(const Found &found, double *lambda, double *cut_lambda, double *virial) {
    if (lambda) std::copy(found.lambda.begin(), found.lambda.end(), lambda);
    if (cut_lambda) std::copy(found.cut_lambda.begin(), found.cut_lambda.end(), cut_lambda);
    if (virial) std::copy(found.virial, found.virial + 9, virial);
}

}  // namespace

int hol_subdomain_create(int rank, int n_ranks, hol_subdomain_sum sum, void *context, int64_t n_atoms,
                         const double *masses, int64_t n_bonds, const int64_t *pairs, const double *lengths,
                         int64_t n_cut, const int64_t *ends, const double *cut_lengths, hol_subdomain **subdomain) {
    return guarded([&] {
        need(subdomain, "subdomain");
        *subdomain = nullptr;
        need(sum, "sum");
        constexpr std::int64_t most = std::int64_t{1} << 30;
        if (n_ranks < 1 || rank < 0 || rank >= n_ranks || n_cut < 0 || n_cut > most)
            throw Failure{HOL_ERR_VALUE, "rank, n_ranks or n_cut is out of its range"};
        Processes processes(rank, n_ranks, sum, context);
        Given given;
        given.ends.assign(2 * static_cast<std::size_t>(n_cut), -1);
        given.cut_lengths.assign(static_cast<std::size_t>(n_cut), 1.0);
        processes.alone([&] {
            if (n_atoms < 0 || n_atoms > most || n_bonds < 0 || n_bonds > most)
                throw Failure{HOL_ERR_VALUE, "n_atoms or n_bonds is out of its range"};
            need(masses || n_atoms == 0, "masses");
            need((pairs && lengths) || n_bonds == 0, "pairs or lengths");
            need((ends && cut_lengths) || n_cut == 0, "ends or cut_lengths");
            if (n_atoms > 0) given.masses.assign(masses, masses + n_atoms);
            if (n_bonds > 0)
                given.pairs.assign(pairs, pairs + 2 * n_bonds), given.lengths.assign(lengths, lengths + n_bonds);
            if (n_cut > 0)
                given.ends.assign(ends, ends + 2 * n_cut), given.cut_lengths.assign(cut_lengths, cut_lengths + n_cut);
        });
        *subdomain = new hol_subdomain(Subdomain(processes, std::move(given)));
    });
}

void hol_subdomain_destroy(hol_subdomain *subdomain) { delete subdomain; }

int hol_subdomain_set_box(hol_subdomain *subdomain, const double *box) {
    return guarded([&] {
        need(subdomain, "subdomain");
        subdomain->all.set_box(box);
    });
}

int hol_subdomain_set_box_rate(hol_subdomain *subdomain, const double *L) {
    return guarded([&] {
        need(subdomain, "subdomain");
        for (int k = 0; L && k < 9; ++k)
            if (!std::isfinite(L[k])) throw Failure{HOL_ERR_VALUE, "L is not finite"};
        subdomain->all.set_rate(L);
    });
}

int hol_subdomain_factorize(hol_subdomain *subdomain, const double *r) {
    return guarded([&] {
        Subdomain &all = begin(subdomain, false, [&] {
            need(r || subdomain->all.n_atoms() == 0, "r");
            need_finite(r, subdomain->all.n_atoms(), "position");
        });
        all.factorize(r);
    });
}

int hol_subdomain_forces(hol_subdomain *subdomain, const double *v, const double *f, double *lambda, double *cut_lambda,
                         double *g, int mode, double *virial) {
    return guarded([&] {
        Subdomain &all = begin(subdomain, true, [&] {
            if (mode != HOL_WRITE && mode != HOL_ADD) throw Failure{HOL_ERR_VALUE, "mode"};
            need_finite(v, subdomain->all.n_atoms(), "velocity");
            need_finite(f, subdomain->all.n_atoms(), "force");
        });
        const Found found = all.forces(v, f);
        for (std::size_t k = 0; g && k < found.g.size(); ++k) g[k] = mode == HOL_ADD ? g[k] + found.g[k] : found.g[k];
        give(found, lambda, cut_lambda, virial);
    });
}

int hol_subdomain_project_velocities(hol_subdomain *subdomain, double *v, double *lambda, double *cut_lambda,
                                     double *virial) {
    return guarded([&] {
        Subdomain &all = begin(subdomain, true, [&] {
            need(v || subdomain->all.n_atoms() == 0, "v");
            need_finite(v, subdomain->all.n_atoms(), "velocity");
        });
        const Found found = all.velocities(v);
        std::copy(found.v.begin(), found.v.end(), v);
        give(found, lambda, cut_lambda, virial);
    });
}

int hol_subdomain_project_positions(hol_subdomain *subdomain, double *r, double *v, double dt, double *lambda,
                                    double *cut_lambda, double *virial, int *iterations) {
    return guarded([&] {
        Subdomain &all = begin(subdomain, true, [&] {
            need(r || subdomain->all.n_atoms() == 0, "r");
            if (!(dt > 0 && std::isfinite(dt))) throw Failure{HOL_ERR_VALUE, "dt"};
            need_finite(r, subdomain->all.n_atoms(), "position");
        });
        std::vector<double> moved(r, r + 3 * static_cast<std::size_t>(all.n_atoms()));
        const Found found = all.positions(moved, dt);
        std::copy(moved.begin(), moved.end(), r);
        for (std::size_t k = 0; v && k < moved.size(); ++k)
            v[k] += dt * all.inverse_mass(static_cast<int>(k / 3)) * found.g[k];
        give(found, lambda, cut_lambda, virial);
        if (iterations) *iterations = found.steps;
    });
}

int hol_subdomain_violation(hol_subdomain *subdomain, const double *r, const double *v, double *length, double *rate) {
    return guarded([&] {
        Subdomain &all = begin(subdomain, false, [&] {
            need(r || subdomain->all.n_atoms() == 0, "r");
            need_finite(r, subdomain->all.n_atoms(), "position");
            need_finite(v, subdomain->all.n_atoms(), "velocity");
        });
        double worst[2];
        all.violation(r, v, worst);
        if (length) *length = worst[0];
        if (rate) *rate = worst[1];
    });
}

int hol_subdomain_set_labels(hol_subdomain *subdomain, const int64_t *atoms) {
    return guarded([&] {
        need(subdomain, "subdomain");
        subdomain->all.set_labels(atoms);
    });
}

int hol_subdomain_cut_vectors(const hol_subdomain *subdomain, double *d) {
    return guarded([&] {
        need(subdomain && d, "subdomain or d");
        if (!subdomain->all.factorized()) throw Failure{HOL_ERR_STATE, "hol_subdomain_factorize comes first"};
        for (const TwiceVector &vector : subdomain->all.cut_vectors())
            for (int c = 0; c < 3; ++c) *d++ = vector.hi[c];
    });
}

int hol_subdomain_get_work(const hol_subdomain *subdomain, hol_subdomain_work *work) {
    return guarded([&] {
        need(subdomain && work, "subdomain or work");
        *work = subdomain->all.work();
    });
}

const char *hol_subdomain_error_message(void) { return message.c_str(); }
