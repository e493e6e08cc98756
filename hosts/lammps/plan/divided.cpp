// SPDX-License-Identifier: GPL-2.0-only
#include "divided.hpp"

#include <algorithm>
#include <string>

namespace holonomic_lammps {

int Divided::add_up(void *self, std::int64_t n, double *numbers) {
    return MPI_Allreduce(MPI_IN_PLACE, numbers, static_cast<int>(n), MPI_DOUBLE, MPI_SUM,
                         static_cast<const Divided *>(self)->world_);
}

/** The message of the rank where it went wrong; the others know only that it did. */
void Divided::check(int status, const char *doing) const {
    if (status == HOL_OK) return;
    const std::string message = hol_subdomain_error_message();
    const bool elsewhere = message.compare(0, 8, "process ") == 0;
    throw_together(world_, elsewhere ? "" : std::string(doing) + " of divided molecules: " + message);
    throw ErrorEverywhere(std::string(doing) + " of divided molecules: " + message);
}

void Divided::renew(const Registry &registry, const Membership *members, const Tag *tags,
                    const std::vector<double> &masses, bool fresh) {
    if (registry.n_divided() == 0) {
        subdomain_.reset();
        atoms_.clear();
        return;
    }
    atoms_.clear();
    for (std::size_t i = 0; i < masses.size(); ++i)
        if (members[i].place == divided) atoms_.push_back(static_cast<int>(i));
    std::sort(atoms_.begin(), atoms_.end(), [&](int a, int b) { return tags[a] < tags[b]; });
    std::vector<Tag> here;
    std::vector<double> masses_here;
    for (int i : atoms_) here.push_back(tags[i]), masses_here.push_back(masses[i]);
    int changed = fresh || here != tags_ || !subdomain_;
    MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, world_);
    if (!changed) return;
    tags_ = std::move(here);
    masses_ = std::move(masses_here);
    if (fresh) partners_.clear();
    learn_partners(registry);
    make();
}

/** Atoms that have come bring none of their bonds; their bookkeepers know. */
void Divided::learn_partners(const Registry &registry) {
    std::vector<Tag> unknown;
    for (Tag tag : tags_)
        if (partners_.count(tag) == 0) unknown.push_back(tag);
    std::vector<std::vector<Partner>> found = registry.partners(unknown);
    for (std::size_t k = 0; k < unknown.size(); ++k) partners_[unknown[k]] = std::move(found[k]);
}

void Divided::make() {
    const auto place = [&](Tag tag) {
        const auto found = std::lower_bound(tags_.begin(), tags_.end(), tag);
        return found != tags_.end() && *found == tag ? static_cast<std::int64_t>(found - tags_.begin()) : -1;
    };
    pairs_.clear(), lengths_.clear();
    std::vector<Cut> cuts;  // of which the atom of lower tag is here
    for (std::size_t i = 0; i < tags_.size(); ++i)
        for (const Partner &partner : partners_.at(tags_[i])) {
            if (partner.atom < tags_[i]) continue;
            const std::int64_t other = place(partner.atom);
            if (other < 0) {
                cuts.push_back({tags_[i], partner.atom, partner.length});
                continue;
            }
            pairs_.insert(pairs_.end(), {static_cast<std::int64_t>(i), other});
            lengths_.push_back(partner.length);
        }
    // All cut bonds to all ranks
    const Outgoing<Cut> outgoing(size_of(world_), cuts);
    cuts_ = route(world_, outgoing).items;
    std::sort(cuts_.begin(), cuts_.end(),
              [](const Cut &a, const Cut &b) { return a.from != b.from ? a.from < b.from : a.to < b.to; });
    ends_.clear();
    std::vector<double> cut_lengths;
    for (const Cut &cut : cuts_) {
        ends_.insert(ends_.end(), {place(cut.from), place(cut.to)});
        cut_lengths.push_back(cut.length);
    }
    lambda_.assign(lengths_.size(), 0.0);
    cut_lambda_.assign(cuts_.size(), 0.0);
    hol_subdomain *made = nullptr;
    check(hol_subdomain_create(rank_of(world_), size_of(world_), add_up, this, n_atoms(), masses_.data(),
                               static_cast<std::int64_t>(lengths_.size()), pairs_.data(), lengths_.data(),
                               static_cast<std::int64_t>(cuts_.size()), ends_.data(), cut_lengths.data(), &made),
          "bonds");
    subdomain_.reset(made);
    check(hol_subdomain_set_labels(made, tags_.data()), "labels");
}

void Divided::set_box(const double *rows) { check(hol_subdomain_set_box(subdomain_.get(), rows), "the box"); }

void Divided::set_rate(const double *L) {
    check(hol_subdomain_set_box_rate(subdomain_.get(), L), "the rate of the box");
}

void Divided::factorize(const double *r) { check(hol_subdomain_factorize(subdomain_.get(), r), "bond vectors"); }

void Divided::positions(double *now, double dt) {
    check(hol_subdomain_project_positions(subdomain_.get(), now, nullptr, dt, nullptr, nullptr, nullptr, nullptr),
          "positions");
}

void Divided::velocities(double *v) {
    check(hol_subdomain_project_velocities(subdomain_.get(), v, nullptr, nullptr, nullptr), "velocities");
}

void Divided::forces(const double *v, const double *f, double *g, double *virial) {
    check(hol_subdomain_forces(subdomain_.get(), v, f, lambda_.data(), cut_lambda_.data(), g, HOL_WRITE, virial),
          "constraint forces");
}

hol_worst Divided::violation(const double *r, const double *v) const {
    hol_worst worst{};
    check(hol_subdomain_violation(subdomain_.get(), r, v, &worst.length, &worst.rate), "errors of bonds");
    return worst;
}

std::vector<Divided::Known> Divided::list(const double *r) const {
    std::vector<Known> known;
    for (std::size_t k = 0; k < lengths_.size(); ++k) {
        const int a = static_cast<int>(pairs_[2 * k]), b = static_cast<int>(pairs_[2 * k + 1]);
        const double d[3] = {r[3 * b] - r[3 * a], r[3 * b + 1] - r[3 * a + 1], r[3 * b + 2] - r[3 * a + 2]};
        known.push_back({tags_[a], tags_[b], {a, b}, true, {d[0], d[1], d[2]}, lambda_[k]});
    }
    std::vector<double> vectors(3 * cuts_.size() + 1);
    check(hol_subdomain_cut_vectors(subdomain_.get(), vectors.data()), "bond vectors");
    for (std::size_t k = 0; k < cuts_.size(); ++k) {
        const int a = static_cast<int>(ends_[2 * k]), b = static_cast<int>(ends_[2 * k + 1]);
        const double *d = &vectors[3 * k];
        if (a < 0 && b < 0) continue;
        known.push_back({cuts_[k].from, cuts_[k].to, {a, b}, a >= 0, {d[0], d[1], d[2]}, cut_lambda_[k]});
    }
    return known;
}

}  // namespace holonomic_lammps
