// The order in which the bonds of one large molecule are eliminated.
#pragma once

#include "core/molecules/given/lists.hpp"
#include "core/molecules/planned/elimination_order.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic {

// The bonds of a tree as they come free when all atoms with one bond are taken away, and again, so that no bond waits
// for more others than it must. `bonds` of each atom.
Numbers bonds_from_the_leaves(const EliminationPlan &s, const Lists &bonds);

// The columns of a factor in another order with the same fill: what depends on each other stands near each other, a
// post-order of the elimination's tree, but in rounds of columns that do not wait for each other, so that a processor
// works on them at once. Within a round columns of as many entries follow each other. Large molecules have subtrees:
// no column of one depends on another, and what depends on several is the separator, behind the last.
struct ListOrder {
    Numbers column, subtree_end;
};
ListOrder order_of_list(const Fill &fill);

}  // namespace holonomic
