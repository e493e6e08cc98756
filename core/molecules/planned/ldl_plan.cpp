#include "core/molecules/planned/ldl_plan.hpp"

#include "core/molecules/planned/ldl_columns.hpp"
#include "core/molecules/planned/ldl_order.hpp"

namespace holonomic {

namespace {

void pad(Numbers &list, std::int32_t inert) {
    list.resize(static_cast<std::size_t>(in_fours(static_cast<std::int64_t>(list.size()))), inert);
}

void close(const EliminationPlan &s, LdlArrays &a) {
    LdlPlan &l = a.list;
    l.n_atoms = s.n_atoms;
    l.n_bonds = s.n_bonds;
    l.n_sites = size_of(a.atom_of);
    l.n_rows = size_of(a.from);
    l.n_tiles = size_of(a.tile);
    l.n_subtrees = size_of(a.subtree) - 1;
    pad(a.bond_of, 0);
    l.tile = a.tile.data();
    l.subtree = a.subtree.data();
    l.atom_of = a.atom_of.data();
    l.home = a.home.data();
    l.site_of = a.site_of.data();
    l.bond_of = a.bond_of.data();
    l.from = a.from.data();
    l.to = a.to.data();
    l.run = a.run.data();
    l.row = a.row.data();
    l.row_4 = a.row_4.data();
    l.column_4 = a.column_4.data();
    l.mass = a.mass.data();
    l.update = a.update.data();
    l.late = a.late.data();
    l.late_entry = a.late_entry.data();
    l.visit = a.visit.data();
    l.outer = a.outer.data();
}

}  // namespace

void make_ldl_plan(const EliminationPlan &s, Lists bonds, Numbers leaves_first, LdlArrays &arrays) {
    list_ldl_entries(make_ldl_tiles(s, std::move(bonds), std::move(leaves_first), arrays), arrays);
    close(s, arrays);
}

void make_ldl_plan(const EliminationPlan &s, Lists bonds, LdlArrays &arrays) {
    Numbers leaves_first = bonds_from_the_leaves(s, bonds);
    make_ldl_plan(s, std::move(bonds), std::move(leaves_first), arrays);
}

}  // namespace holonomic
