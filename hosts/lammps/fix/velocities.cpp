// SPDX-License-Identifier: GPL-2.0-only
// Velocities and constraint forces, and what is made known of them.
#include <algorithm>
#include <cmath>

#include "atom.h"
#include "domain.h"
#include "fix_holonomic.h"
#include "force.h"
#include "templates.hpp"
#include "update.h"

using namespace LAMMPS_NS;
using namespace std::string_literals;
using namespace holonomic_lammps;

/** What a force changes a velocity by in half a step; 0 for atoms that are held fixed. */
double FixHolonomic::kick_of(int i) const {
    const double mass = mass_of(i);
    return mass > 0 ? 0.5 * update->dt * force->ftm2v / mass : 0.0;
}

/**
 * Where a barostat or fix deform changes the box and moves the atoms with it, they move with v + L x, and it is that
 * motion that has to keep the lengths: d.(v_rel + L d) = 0. The boxes before and after a step give the mean L of the
 * step, and two steps its value at the end: with the mean itself a barostat's conserved quantity would drift.
 */
void FixHolonomic::measure_rate() {
    const double *h = domain->h, *old = last_box_;
    double d[6], m[6];
    for (int k = 0; k < 6; ++k) {
        d[k] = h[k] - old[k];
        m[k] = 0.5 * (h[k] + old[k]);
    }
    // A triclinic box that was flipped is still the same lattice.
    const double yz = std::round(d[3] / m[1]), xy = std::round(d[5] / m[0]);
    d[5] -= xy * h[0];
    d[3] -= yz * h[1];
    d[4] -= yz * (h[5] - xy * h[0]);
    d[4] -= std::round(d[4] / m[0]) * h[0];
    for (int k = 3; k < 6; ++k) m[k] = h[k] - 0.5 * d[k];
    double L[6];
    L[0] = d[0] / m[0], L[1] = d[1] / m[1], L[2] = d[2] / m[2];
    L[5] = (d[5] - L[0] * m[5]) / m[1];
    L[3] = (d[3] - L[1] * m[3]) / m[2];
    L[4] = (d[4] - L[0] * m[4] - L[5] * m[3]) / m[2];
    // Atoms that do not move with the box: those of fix deform with remapped velocities.
    const bool moves = last_box_[0] > 0 && !domain->deform_vremap;
    for (int k = 0; k < 6; ++k) {
        const double mean = moves ? L[k] / update->dt : 0.0;
        rate_[k] = 1.5 * mean - 0.5 * step_rate_[k];
        step_rate_[k] = mean;
        last_box_[k] = h[k];
    }
    streaming_ = std::any_of(rate_, rate_ + 6, [](double x) { return x != 0; });
}

/** Velocities of the slots, v + scale times half a kick; forces in the library's units. */
void FixHolonomic::collect_velocities(double scale, bool with_forces) {
    double **v = atom->v, **f = atom->f;
    const double half = scale * 0.5 * update->dt * force->ftm2v;
    const int *atoms = plan_->atoms().data();
    const int n_slots = plan_->n_slots();
    for (int slot = 0; slot < n_slots; ++slot) {
        const int i = atoms[slot];
        if (i < 0) continue;
        const double kick = masses_[slot] > 0 ? half / masses_[slot] : 0.0;
        for (int c = 0; c < 3; ++c) velocities_[3 * slot + c] = v[i][c] + kick * f[i][c];
    }
    const auto read = [&](int i, double *u) {
        const double kick = scale * kick_of(i);
        for (int c = 0; c < 3; ++c) u[c] = v[i][c] + kick * f[i][c];
    };
    if (!with_forces) {
        plan_->exchange.to_homes<3>(world, read,
                                    [&](int slot, const double *u) { std::copy(u, u + 3, &velocities_[3 * slot]); });
    } else {
        for (int slot = 0; slot < n_slots; ++slot)
            if (atoms[slot] >= 0)
                for (int c = 0; c < 3; ++c) forces_[3 * slot + c] = force->ftm2v * f[atoms[slot]][c];
        plan_->exchange.to_homes<6>(
            world,
            [&](int i, double *numbers) {
                read(i, numbers);
                for (int c = 0; c < 3; ++c) numbers[3 + c] = force->ftm2v * f[i][c];
            },
            [&](int slot, const double *numbers) {
                std::copy(numbers, numbers + 3, &velocities_[3 * slot]);
                std::copy(numbers + 3, numbers + 6, &forces_[3 * slot]);
            });
    }
    add_streaming();
}

/** Velocities with which the slots really move: images with their box, atoms with the box that is deformed. */
void FixHolonomic::add_streaming() {
    if (domain->deform_vremap) {
        const double *h = domain->h_rate;
        for (const Shifted &shifted : shifted_) {
            const Shifts &n = shifted.images;
            double *v = &velocities_[3 * shifted.slot];
            v[0] += n[0] * h[0] + n[1] * h[5] + n[2] * h[4];
            v[1] += n[1] * h[1] + n[2] * h[3];
            v[2] += n[2] * h[2];
        }
    }
    if (!streaming_) return;
    const double *L = rate_;
    for (const Resident &resident : plan_->residents()) {
        const double *origin = &now_[3 * resident.first];
        const int n_atoms = plan_->shapes()[resident.shape].n_atoms;
        for (int k = 1; k < n_atoms; ++k) {
            const double *r = origin + 3 * k;
            const double x = r[0] - origin[0], y = r[1] - origin[1], z = r[2] - origin[2];
            double *v = &velocities_[3 * (resident.first + k)];
            v[0] += L[0] * x + L[5] * y + L[4] * z;
            v[1] += L[1] * y + L[3] * z;
            v[2] += L[2] * z;
        }
    }
}

/** Constraint forces of this instant, tensions and virial, in LAMMPS's units, from positions, velocities and forces. */
void FixHolonomic::exact_forces() {
    packed_->forces(now_.data(), projected_.data(), forces_.data(), tensions_.data(), reactions_.data(), virial_);
    const double unit = 1 / force->ftm2v;
    for (double &x : reactions_) x *= unit;
    for (double &x : tensions_) x *= unit;
    for (double &x : virial_) x *= unit;
}

/** Before the first step: velocities onto the constraints, and the constraint forces of this instant. */
void FixHolonomic::setup(int vflag) {
    guarded([&] {
        if (!std::equal(last_box_, last_box_ + 6, domain->h)) {
            std::fill(rate_, rate_ + 6, 0.0);
            std::fill(step_rate_, step_rate_ + 6, 0.0);
        }
        std::copy(domain->h, domain->h + 6, last_box_);
        streaming_ = std::any_of(rate_, rate_ + 6, [](double x) { return x != 0; });
        collect_positions();
        collect_velocities(0.0, true);
        projected_ = velocities_;
        if (!reruns()) {
            packed_->velocities(now_.data(), projected_.data());
            for (std::size_t k = 0; k < projected_.size(); ++k) velocities_[k] = projected_[k] - velocities_[k];
            return_to_atoms(velocities_, [&](int i, const double *dv) {
                for (int c = 0; c < 3; ++c) atom->v[i][c] += dv[c];
            });
        }
        exact_forces();
        return_to_atoms(reactions_, [&](int i, const double *g) {
            for (int c = 0; c < 3; ++c) atom->f[i][c] += g[c];
        });
        tally(vflag);
    });
}

/** Adds the force with which the half step to come ends with velocities on the constraints. */
void FixHolonomic::post_force(int vflag) {
    guarded([&] {
        measure_rate();
        v_init(vflag);
        const bool exact = evflag || due(forces_every_) || due(tensions_every_);
        collect_velocities(1.0, exact);
        projected_ = velocities_;
        packed_->velocities(now_.data(), projected_.data());
        for (std::size_t k = 0; k < projected_.size(); ++k) velocities_[k] = projected_[k] - velocities_[k];
        double **f = atom->f;
        return_to_atoms(velocities_, [&](int i, const double *dv) {
            const double kick = kick_of(i);
            if (kick > 0)
                for (int c = 0; c < 3; ++c) f[i][c] += dv[c] / kick;
        });
        if (!exact) return;
        exact_forces();
        tally(vflag);
    });
}
