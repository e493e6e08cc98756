// SPDX-License-Identifier: GPL-2.0-only
#include "blocks.hpp"

#include <algorithm>

namespace holonomic_lammps {

namespace {

/** Arrays of a block stay in the cache between taking them, solving, and giving them back. */
constexpr int atoms_of_block = 2048;

/** Residents that are not yet in a block, and the blocks so far. */
class Cutter {
public:
    Cutter(const Plan &plan, const double *masses) : plan_(plan), masses_(masses) {}

    int end() const { return end_; }
    /** Whether those since the last block make one of their own, or none at all. */
    bool may_keep() const { return n_atoms_ == 0 || n_atoms_ >= atoms_of_block / 2; }

    void take() { n_atoms_ += n_atoms_of(end_++); }

    void keep(Packed &&block) {
        cut();
        block.move_to(end_, n_bonds_);
        add(std::move(block));
    }

    /** Makes blocks, as even as molecules allow, of those since the last one. */
    void cut() {
        const int n_blocks = std::max(1, (n_atoms_ + atoms_of_block / 2) / atoms_of_block);
        const int size = (n_atoms_ + n_blocks - 1) / n_blocks;
        while (first_ < end_) {
            int last = first_;
            for (int n = 0; last < end_ && n < size;) n += n_atoms_of(last++);
            add(Packed(plan_, masses_, first_, last, n_bonds_));
        }
        n_atoms_ = 0;
    }

    std::vector<Packed> blocks() { return std::move(blocks_); }

private:
    int n_atoms_of(int resident) const { return plan_.shapes()[plan_.residents()[resident].shape].n_atoms; }
    void add(Packed &&block) {
        first_ = block.end_resident();
        end_ = std::max(end_, first_);
        n_bonds_ += static_cast<int>(block.n_bonds());
        blocks_.push_back(std::move(block));
    }

    const Plan &plan_;
    const double *masses_;
    std::vector<Packed> blocks_;
    int first_ = 0, end_ = 0, n_atoms_ = 0, n_bonds_ = 0;
};

}  // namespace

std::vector<Packed> cut_into_blocks(const Plan &plan, const double *masses, std::vector<Packed> last) {
    std::unordered_map<Tag, Packed *> starts;
    for (Packed &block : last) starts[block.name()] = &block;
    const int n_residents = static_cast<int>(plan.residents().size());
    Cutter cutter(plan, masses);
    while (cutter.end() < n_residents) {
        const auto found = starts.find(plan.residents()[cutter.end()].molecule);
        if (found != starts.end() && cutter.may_keep() && found->second->holds(cutter.end(), masses))
            cutter.keep(std::move(*found->second));
        else
            cutter.take();
    }
    cutter.cut();
    return cutter.blocks();
}

}  // namespace holonomic_lammps
