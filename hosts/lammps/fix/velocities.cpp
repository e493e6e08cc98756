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
}

/** From other ranks: v + half f / m, or v if half is 0; and the forces of all atoms, in the library's units. */
void FixHolonomic::receive_velocities(double half, bool with_forces) {
    double **v = atom->v, **f = atom->f;
    const double unit = force->ftm2v;
    const auto read = [&](int i, double *u) {
        const double mass = mass_of(i), kick = mass > 0 ? half / mass : 0.0;
        for (int c = 0; c < 3; ++c) u[c] = v[i][c] + kick * f[i][c];
    };
    if (!with_forces) {
        plan_->exchange.to_homes<3>(world, read,
                                    [&](int slot, const double *u) { std::copy_n(u, 3, &velocities_[3 * slot]); });
        return;
    }
    const int *atoms = plan_->atoms().data();
    for (int slot = 0; slot < plan_->n_slots(); ++slot)
        if (atoms[slot] >= 0)
            for (int c = 0; c < 3; ++c) forces_[3 * slot + c] = unit * f[atoms[slot]][c];
    plan_->exchange.to_homes<6>(
        world,
        [&](int i, double *numbers) {
            read(i, numbers);
            for (int c = 0; c < 3; ++c) numbers[3 + c] = unit * f[i][c];
        },
        [&](int slot, const double *numbers) {
            std::copy_n(numbers, 3, &velocities_[3 * slot]);
            std::copy_n(numbers + 3, 3, &forces_[3 * slot]);
        });
}

/** The same for a block's own atoms; then the motion of images for all. A copy goes into given_. */
void FixHolonomic::collect_velocities(const Block &block, double half) {
    const int first = block.packed.first_slot();
    const std::size_t size = 3 * static_cast<std::size_t>(block.packed.end_slot() - first);
    if (given_.size() < size) given_.resize(size);
    if (atom->nlocal > 0) {
        double *given = given_.data();
        const double *v = atom->v[0], *f = atom->f[0];
        const int *atoms = plan_->atoms().data();
        double *velocities = velocities_.data();
        for (int slot = first; slot < block.packed.end_slot(); ++slot) {
            if (atoms[slot] < 0) continue;
            const std::ptrdiff_t i = 3 * static_cast<std::ptrdiff_t>(atoms[slot]);
            const double kick = half * inverse_masses_[slot];
            const double u0 = v[i] + kick * f[i], u1 = v[i + 1] + kick * f[i + 1], u2 = v[i + 2] + kick * f[i + 2];
            double *to = velocities + 3 * slot, *copy = given + 3 * (slot - first);
            to[0] = u0, to[1] = u1, to[2] = u2;
            copy[0] = u0, copy[1] = u1, copy[2] = u2;
        }
    }
    const bool moved = add_streaming(block);
    if (block.first_away == block.end_away && !moved) return;
    std::copy_n(&velocities_[3 * first], size, given_.data());
}

/** Images move with their box where fix deform remaps velocities. Gives whether it does. */
bool FixHolonomic::add_streaming(const Block &block) {
    if (domain->deform_vremap) {
        const double *h = domain->h_rate;
        for (int k = block.first_shifted; k < block.end_shifted; ++k) {
            const Shifts &n = shifted_[k].images;
            double *v = &velocities_[3 * shifted_[k].slot];
            v[0] += n[0] * h[0] + n[1] * h[5] + n[2] * h[4];
            v[1] += n[1] * h[1] + n[2] * h[3];
            v[2] += n[2] * h[2];
        }
    }
    return domain->deform_vremap != 0;
}

/** What a block's velocities have become more than given_: to its own atoms, and into the answers to other ranks. */
template <class Give>
void FixHolonomic::give_changes(const Block &block, Give give) {
    const int first = block.packed.first_slot(), end = block.packed.end_slot();
    const int *atoms = plan_->atoms().data();
    const double *given = given_.data(), *masses = masses_.data(), *velocities = velocities_.data();
    for (int slot = first; slot < end; ++slot) {
        if (atoms[slot] < 0) continue;
        const double *v = velocities + 3 * slot, *u = given + 3 * (slot - first);
        const double change[3] = {v[0] - u[0], v[1] - u[1], v[2] - u[2]};
        give(atoms[slot], change, masses[slot]);
    }
    for (int k = block.first_away; k < block.end_away; ++k)
        for (int c = 0; c < 3; ++c)
            answers_[3 * away_[k].order + c] =
                velocities[3 * away_[k].slot + c] - given[3 * (away_[k].slot - first) + c];
}

/**
 * Velocities onto the constraints, those of now or those that a half step with the present forces would give: calls
 * give(atom, change, mass) on the owners' ranks. velocities_ is what comes out, with the motion of images; that of
 * atoms with a box that is deformed is the library's.
 */
template <class Give>
void FixHolonomic::constrain_velocities(bool half_kick, bool with_forces, Give give) {
    const double half = half_kick ? 0.5 * update->dt * force->ftm2v : 0.0;
    const double L[9] = {rate_[0], rate_[5], rate_[4], 0, rate_[1], rate_[3], 0, 0, rate_[2]};
    receive_velocities(half, with_forces);
    for (Block &block : blocks_) {
        block.packed.set_rate(L);
        collect_velocities(block, half);
        if (!reruns_) block.packed.velocities(now_.data(), velocities_.data());
        give_changes(block, give);
    }
    const double *answer = answers_.data();
    plan_->exchange.to_owners<3>(
        world, [&](int, double *out) { std::copy_n(answer, 3, out), answer += 3; },
        [&](int i, const double *change) { give(i, change, mass_of(i)); });
    const std::vector<double> changes = divided_changes(half);
    for (std::size_t k = 0; k < changes.size() / 3; ++k)
        give(divided_->atoms()[k], &changes[3 * k], mass_of(divided_->atoms()[k]));
}

/** Constraint forces of this instant, tensions and virial, in LAMMPS's units, from positions, velocities and forces. */
void FixHolonomic::exact_forces() {
    std::fill(virial_, virial_ + 9, 0.0);
    // Those of distances that depend on each other take long.
    double *tensions = vflag_atom || due(tensions_every_) ? tensions_.data() : nullptr;
    for (Block &block : blocks_) {
        double part[9];
        block.packed.forces(now_.data(), velocities_.data(), forces_.data(), tensions, reactions_.data(), part);
        for (int k = 0; k < 9; ++k) virial_[k] += part[k];
    }
    divided_forces();
    const double unit = 1 / force->ftm2v;
    for (double &x : reactions_) x *= unit;
    for (double &x : divided_g_) x *= unit;
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
        collect_all_positions();
        for (const Block &block : blocks_) add_images(block, 1);
        reruns_ = reruns();
        constrain_velocities(false, true, [&](int i, const double *change, double) {
            for (int c = 0; c < 3; ++c) atom->v[i][c] += change[c];
        });
        reruns_ = false;
        v_init(vflag);
        exact_forces();
        return_reactions([&](int i, const double *g) {
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
        const double inverse_half = 2 / (update->dt * force->ftm2v);
        double *f = atom->nlocal > 0 ? atom->f[0] : nullptr;
        constrain_velocities(true, exact, [&](int i, const double *change, double mass) {
            const double factor = mass * inverse_half;
            double *force_of = f + 3 * static_cast<std::ptrdiff_t>(i);
            const double f0 = force_of[0] + factor * change[0], f1 = force_of[1] + factor * change[1],
                         f2 = force_of[2] + factor * change[2];
            force_of[0] = f0, force_of[1] = f1, force_of[2] = f2;
        });
        if (!exact) return;
        exact_forces();
        tally(vflag);
    });
}

/** In a minimisation: the force's part along the constraints, as those of a state at rest leave it. */
void FixHolonomic::min_post_force(int vflag) {
    guarded([&] {
        v_init(vflag);
        // Fire and quickmin move atoms with their velocities, the others leave them as they are.
        const bool moves =
            utils::strmatch(update->minimize_style, "^fire") || utils::strmatch(update->minimize_style, "^quickmin");
        constrain_velocities(false, true, [&](int i, const double *change, double) {
            for (int c = 0; moves && c < 3; ++c) atom->v[i][c] += change[c];
        });
        std::fill(velocities_.begin(), velocities_.end(), 0.0);
        std::fill(divided_v_.begin(), divided_v_.end(), 0.0);
        exact_forces();
        return_reactions([&](int i, const double *g) {
            for (int c = 0; c < 3; ++c) atom->f[i][c] += g[c];
        });
        tally(vflag);
    });
}
