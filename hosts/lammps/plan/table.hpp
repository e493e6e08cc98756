// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_PLAN_TABLE_HPP
#define HOLONOMIC_LAMMPS_PLAN_TABLE_HPP

#include "components.hpp"

namespace holonomic_lammps {

/** Numbers by tag, in one array: each atom is looked up at each reneighbouring. */
class Table {
public:
    Table() { clear(0); }

    void clear(std::size_t expected) {
        std::size_t capacity = 16;
        while (capacity < 2 * expected) capacity *= 2;
        entries_.assign(capacity, Entry{0, -1});
        used_ = 0;
    }

    /** The number of a tag, -1 if it has none. */
    int find(Tag tag) const { return entries_[place(tag)].number; }

    /** The number of a tag; a tag that has none gets the one offered. */
    int find_or_insert(Tag tag, int number) {
        std::size_t k = place(tag);
        if (entries_[k].number >= 0) return entries_[k].number;
        if (2 * (used_ + 1) > entries_.size()) {
            grow();
            k = place(tag);
        }
        entries_[k] = {tag, number};
        ++used_;
        return number;
    }

private:
    struct Entry {
        Tag tag;
        int number;
    };

    std::size_t place(Tag tag) const {
        std::size_t k = (static_cast<std::uint64_t>(tag) * 0x9E3779B97F4A7C15u) >> 20;
        for (k &= entries_.size() - 1; entries_[k].number >= 0 && entries_[k].tag != tag;)
            k = (k + 1) & (entries_.size() - 1);
        return k;
    }

    void grow() {
        const std::vector<Entry> old = entries_;
        entries_.assign(2 * old.size(), Entry{0, -1});
        for (const Entry &entry : old)
            if (entry.number >= 0) entries_[place(entry.tag)] = entry;
    }

    std::vector<Entry> entries_;
    std::size_t used_ = 0;
};

}  // namespace holonomic_lammps

#endif
