// SPDX-License-Identifier: GPL-2.0-only
// Virial, degrees of freedom, constraint forces per atom, tensions per bond, errors.
#include <algorithm>
#include <cmath>

#include "atom.h"
#include "fix_holonomic.h"
#include "force.h"
#include "group.h"
#include "memory.h"
#include "templates.hpp"
#include "update.h"

using namespace LAMMPS_NS;
using namespace std::string_literals;
using namespace holonomic_lammps;

/** The virial of the molecules that live here; a bond's, half and half, at its atoms, a body's at each of them. */
void FixHolonomic::tally(int vflag) {
    v_init(vflag);
    if (vflag_global) {
        const int from[6] = {0, 4, 8, 1, 2, 5};
        for (int k = 0; k < 6; ++k) virial[k] += virial_[from[k]];
    }
    if (vflag_atom) tally_atoms(), tally_divided_atoms();
    if (due(forces_every_)) keep_forces();
    if (due(tensions_every_)) keep_tensions();
}

void FixHolonomic::tally_atoms() {
    std::vector<double> parts(6 * static_cast<std::size_t>(plan_->n_slots()), 0.0);
    const double *tension = tensions_.data();
    for (const Resident &resident : plan_->residents()) {
        const Shape &shape = plan_->shapes()[resident.shape];
        if (shape.rigid) {
            tally_body(resident, &parts[6 * resident.first]);
            tension += shape.pairs.size();
            continue;
        }
        for (const auto &pair : shape.pairs) {
            const int a = resident.first + pair[0], b = resident.first + pair[1];
            double d[3];
            for (int c = 0; c < 3; ++c) d[c] = now_[3 * b + c] - now_[3 * a + c];
            const double t = -0.5 * *tension++ / std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            const double w[6] = {t * d[0] * d[0], t * d[1] * d[1], t * d[2] * d[2],
                                 t * d[0] * d[1], t * d[0] * d[2], t * d[1] * d[2]};
            for (int k = 0; k < 6; ++k) {
                parts[6 * a + k] += w[k];
                parts[6 * b + k] += w[k];
            }
        }
    }
    const auto add = [&](int i, const double *w) {
        for (int k = 0; k < 6; ++k) vatom[i][k] += w[k];
    };
    for (int slot = 0; slot < plan_->n_slots(); ++slot)
        if (plan_->atoms()[slot] >= 0) add(plan_->atoms()[slot], &parts[6 * slot]);
    plan_->exchange.to_owners<6>(
        world, [&](int slot, double *w) { std::copy(&parts[6 * slot], &parts[6 * slot] + 6, w); }, add);
}

/** Where no distance pulls, there are the forces: (r - c) G, symmetric in sum, as no torque is left. */
void FixHolonomic::tally_body(const Resident &resident, double *parts) const {
    const int n = plan_->shapes()[resident.shape].n_atoms;
    const double *r = &now_[3 * resident.first], *g = &reactions_[3 * resident.first];
    double mean[3] = {0, 0, 0};
    for (int k = 0; k < 3 * n; ++k) mean[k % 3] += r[k] / n;
    for (int k = 0; k < n; ++k) {
        double d[3];
        for (int c = 0; c < 3; ++c) d[c] = r[3 * k + c] - mean[c];
        const double *f = g + 3 * k;
        const double w[6] = {d[0] * f[0],
                             d[1] * f[1],
                             d[2] * f[2],
                             0.5 * (d[0] * f[1] + d[1] * f[0]),
                             0.5 * (d[0] * f[2] + d[2] * f[0]),
                             0.5 * (d[1] * f[2] + d[2] * f[1])};
        std::copy(w, w + 6, parts + 6 * k);
    }
}

bool FixHolonomic::due(int every) const { return every > 0 && update->ntimestep % every == 0; }

void FixHolonomic::keep_forces() {
    for (int i = 0; i < atom->nlocal; ++i) std::fill(array_atom[i], array_atom[i] + 3, 0.0);
    return_reactions([&](int i, const double *g) { std::copy(g, g + 3, array_atom[i]); });
}

void FixHolonomic::keep_tensions() {
    std::vector<Divided::Known> divided = divided_bonds();
    divided.erase(std::remove_if(divided.begin(), divided.end(), [](const auto &bond) { return !bond.counts; }),
                  divided.end());
    size_local_rows = static_cast<int>(tensions_.size() + divided.size());
    if (size_local_rows > max_rows_) {
        max_rows_ = size_local_rows;
        memory->destroy(array_local);
        memory->create(array_local, max_rows_, 4, "holonomic:array_local");
    }
    int row = 0;
    for (const Resident &resident : plan_->residents())
        for (const auto &pair : plan_->shapes()[resident.shape].pairs) {
            const int a = resident.first + pair[0], b = resident.first + pair[1];
            double square = 0;
            for (int c = 0; c < 3; ++c) square += std::pow(now_[3 * b + c] - now_[3 * a + c], 2);
            const double numbers[4] = {static_cast<double>(plan_->tags()[a]), static_cast<double>(plan_->tags()[b]),
                                       tensions_[row], std::sqrt(square)};
            std::copy(numbers, numbers + 4, array_local[row++]);
        }
    for (const Divided::Known &bond : divided) {
        const double length = std::sqrt(bond.d[0] * bond.d[0] + bond.d[1] * bond.d[1] + bond.d[2] * bond.d[2]);
        const double numbers[4] = {static_cast<double>(bond.from), static_cast<double>(bond.to),
                                   2 * bond.lambda * length / force->ftm2v, length};
        std::copy(numbers, numbers + 4, array_local[row++]);
    }
}

/** A rigid distance takes half a degree of freedom from either of its atoms, a body the same from each. */
Dof FixHolonomic::dof(int igroup) {
    const int bit = group->bitmask[igroup];
    double taken = 0;
    for (int i = 0; i < atom->nlocal; ++i)
        if (atom->mask[i] & bit) taken += atoms_[i].taken;
    MPI_Allreduce(MPI_IN_PLACE, &taken, 1, MPI_DOUBLE, MPI_SUM, world);
    // Thirds of a body's atoms may add up to a little less than a whole number.
    return static_cast<Dof>(std::floor(taken + 1e-6));
}

hol_worst FixHolonomic::errors() {
    hol_worst worst{};
    guarded([&] {
        for (const Block &block : blocks_) {
            const hol_worst here = block.packed.violation(now_.data(), velocities_.data());
            worst.length = std::max(worst.length, here.length);
            worst.rate = std::max(worst.rate, here.rate);
        }
        const hol_worst here = divided_errors();
        worst.length = std::max(worst.length, here.length);
        worst.rate = std::max(worst.rate, here.rate);
    });
    double both[2] = {worst.length, worst.rate};
    MPI_Allreduce(MPI_IN_PLACE, both, 2, MPI_DOUBLE, MPI_MAX, world);
    worst.length = both[0];
    worst.rate = both[1];
    return worst;
}

double FixHolonomic::compute_scalar() { return errors().length; }

double FixHolonomic::compute_vector(int k) {
    switch (k) {
        case 0:
            return errors().length;
        case 1:
            return errors().rate;
        case 2:
            return static_cast<double>(registry_.n_molecules());
        case 3:
            return static_cast<double>(registry_.n_bonds());
        default:
            break;
    }
    double away = plan_->n_away(), here = plan_->n_slots();
    MPI_Allreduce(MPI_IN_PLACE, &away, 1, MPI_DOUBLE, MPI_SUM, world);
    MPI_Allreduce(MPI_IN_PLACE, &here, 1, MPI_DOUBLE, MPI_MAX, world);
    return k == 4 ? away : here;
}

double FixHolonomic::memory_usage() {
    double bytes = static_cast<double>(atoms_.capacity() * sizeof(Belonging));
    bytes += static_cast<double>((6 * now_.capacity() + tensions_.capacity() + masses_.capacity()) * sizeof(double));
    for (const Block &block : blocks_) bytes += static_cast<double>(block.packed.memory());
    return bytes;
}
