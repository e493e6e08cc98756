// SPDX-License-Identifier: GPL-2.0-only
// The positions: from the atoms of all ranks to whole molecules and back.
#include <algorithm>
#include <cmath>

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "fix_holonomic.h"
#include "image.hpp"
#include "input.h"
#include "templates.hpp"
#include "update.h"

using namespace LAMMPS_NS;
using namespace std::string_literals;
using namespace holonomic_lammps;

bool FixHolonomic::reruns() const { return CommandName::of(input) == "rerun"s; }

double FixHolonomic::mass_of(int i) const {
    if (fixed_bit_ && atom->mask[i] & fixed_bit_) return 0;
    if (minimises()) return 1;
    return atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
}

/** Bonds that other fixes have made or atoms that they have taken away since show here: they ask for reneighbouring. */
void FixHolonomic::pre_neighbor() {
    guarded([&] {
        const bool found_anew = replan(false);
        make_whole();
        if (found_anew) settle();
    });
}

/** Puts positions onto the constraints that these molecules have not obeyed so far. */
void FixHolonomic::settle() {
    int moved = constrain_positions(true, 1.0);
    MPI_Allreduce(MPI_IN_PLACE, &moved, 1, MPI_INT, MPI_MAX, world);
    if (moved) comm->forward_comm();
}

/** Plans, and puts positions that come from a file onto the constraints before the first forces are computed. */
void FixHolonomic::setup_pre_neighbor() {
    guarded([&] {
        replan(true);
        make_whole();
        if (!reruns()) settle();
    });
}

/** Which image of each atom makes its molecule whole, seen from the atom at place 0; bonds are shorter than half a box.
 */
void FixHolonomic::make_whole() {
    shifted_.clear();
    collect_all_positions();
    for (Block &block : blocks_) {
        block.first_shifted = static_cast<int>(shifted_.size());
        for (int m = block.packed.first_resident(); m < block.packed.end_resident(); ++m) {
            const Resident &resident = plan_->residents()[m];
            for (const auto &step : plan_->walk_of(resident.shape)) {
                double *to = &now_[3 * (resident.first + step[0])];
                const double *from = &now_[3 * (resident.first + step[1])];
                const double d[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
                const Shifts images = nearest_image(*domain, d);
                if (images == Shifts{0, 0, 0}) continue;
                shifted_.push_back({resident.first + step[0], images});
                const Vector shift = image_vector(*domain, images);
                for (int c = 0; c < 3; ++c) to[c] += shift[c];
            }
        }
        block.end_shifted = static_cast<int>(shifted_.size());
        const auto behind = [](const Away &away, int slot) { return away.slot < slot; };
        const auto find = [&](int slot) {
            return static_cast<int>(std::lower_bound(away_.begin(), away_.end(), slot, behind) - away_.begin());
        };
        block.first_away = find(block.packed.first_slot());
        block.end_away = find(block.packed.end_slot());
    }
}

void FixHolonomic::add_images(const Block &block, int sign) {
    for (int k = block.first_shifted; k < block.end_shifted; ++k) {
        const Vector shift = image_vector(*domain, shifted_[k].images);
        for (int c = 0; c < 3; ++c) now_[3 * shifted_[k].slot + c] += sign * shift[c];
    }
}

/** Positions as the atoms have them, not yet whole. */
void FixHolonomic::collect_all_positions() {
    for (int slot = 0; slot < plan_->n_slots(); ++slot)
        if (plan_->atoms()[slot] >= 0) std::copy_n(atom->x[plan_->atoms()[slot]], 3, &now_[3 * slot]);
    plan_->exchange.to_homes<3>(
        world, [&](int i, double *r) { std::copy_n(atom->x[i], 3, r); },
        [&](int slot, const double *r) { std::copy_n(r, 3, &now_[3 * slot]); });
}

/** Those of a block's own atoms; what other ranks sent is there. Whole molecules. */
void FixHolonomic::collect_positions(const Block &block) {
    const double *x = atom->nlocal > 0 ? atom->x[0] : nullptr;
    const int *atoms = plan_->atoms().data();
    double *now = now_.data();
    for (int slot = block.packed.first_slot(); slot < block.packed.end_slot(); ++slot) {
        if (atoms[slot] < 0) continue;
        const double *from = x + 3 * static_cast<std::ptrdiff_t>(atoms[slot]);
        double *to = now + 3 * slot;
        const double r0 = from[0], r1 = from[1], r2 = from[2];
        to[0] = r0, to[1] = r1, to[2] = r2;
    }
    add_images(block, 1);
}

/** An atom's new position; its velocity gets the displacement over the time. */
static inline void move_atom(double *x, double *v, const double *r, double inverse_time) {
    // All read before anything is written: the compiler need not think of overlaps, and takes two at a time.
    const double r0 = r[0], r1 = r[1], r2 = r[2];
    const double v0 = v[0] + inverse_time * (r0 - x[0]), v1 = v[1] + inverse_time * (r1 - x[1]),
                 v2 = v[2] + inverse_time * (r2 - x[2]);
    x[0] = r0, x[1] = r1, x[2] = r2;
    v[0] = v0, v[1] = v1, v[2] = v2;
}

/** A block's positions go back to its own atoms, and into the answers to other ranks. */
void FixHolonomic::return_positions(const Block &block, double inverse_time) {
    const int first = block.packed.first_slot(), end = block.packed.end_slot();
    whole_.resize(3 * static_cast<std::size_t>(block.end_shifted - block.first_shifted));
    for (int k = block.first_shifted; k < block.end_shifted; ++k)
        std::copy_n(&now_[3 * shifted_[k].slot], 3, &whole_[3 * (k - block.first_shifted)]);
    add_images(block, -1);
    const int *atoms = plan_->atoms().data();
    double *x = atom->nlocal > 0 ? atom->x[0] : nullptr, *v = atom->nlocal > 0 ? atom->v[0] : nullptr;
    const double *now = now_.data();
    for (int slot = first; slot < end; ++slot) {
        if (atoms[slot] < 0) continue;
        const std::ptrdiff_t i = 3 * static_cast<std::ptrdiff_t>(atoms[slot]);
        move_atom(x + i, v + i, now + 3 * slot, inverse_time);
    }
    for (int k = block.first_away; k < block.end_away; ++k)
        std::copy_n(&now_[3 * away_[k].slot], 3, &answers_[3 * away_[k].order]);
    // Whole again, to the bit
    for (int k = block.first_shifted; k < block.end_shifted; ++k)
        std::copy_n(&whole_[3 * (k - block.first_shifted)], 3, &now_[3 * shifted_[k].slot]);
}

/**
 * Positions onto the constraints, along the bonds of those of the last step or of themselves; velocities get the
 * displacements over the time, or nothing. Gives whether any has moved along its own bonds.
 */
bool FixHolonomic::constrain_positions(bool from_themselves, double time) {
    const double inverse_time = from_themselves ? 0.0 : 1 / time;
    before_.swap(now_);
    plan_->exchange.to_homes<3>(
        world, [&](int i, double *r) { std::copy_n(atom->x[i], 3, r); },
        [&](int slot, const double *r) { std::copy_n(r, 3, &now_[3 * slot]); });
    std::int64_t n_moved = 0;
    for (Block &block : blocks_) {
        collect_positions(block);
        if (from_themselves)
            std::copy(&now_[3 * block.packed.first_slot()], now_.data() + 3 * block.packed.end_slot(),
                      &before_[3 * block.packed.first_slot()]);
        block.packed.positions(before_.data(), now_.data(), time, from_themselves ? &n_moved : nullptr);
        return_positions(block, inverse_time);
    }
    const double *answer = answers_.data();
    plan_->exchange.to_owners<3>(
        world, [&](int, double *r) { std::copy_n(answer, 3, r), answer += 3; },
        [&](int i, const double *r) { move_atom(atom->x[i], atom->v[i], r, inverse_time); });
    return constrain_divided_positions(from_themselves, time) || n_moved > 0;
}

void FixHolonomic::post_integrate() {
    guarded([&] { constrain_positions(false, update->dt); });
}
