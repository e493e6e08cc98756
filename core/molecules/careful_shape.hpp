// What the careful solver needs to know of a shape, made once.
#pragma once

#include <cstdint>
#include <vector>

#include "core/kernels/careful/plan.hpp"
#include "core/molecules/elimination_order.hpp"

namespace holonomic {

class CarefulShape {
public:
    // A connected molecule: bond k joins the atoms pairs[2 k] < pairs[2 k + 1].
    // Throws TooMuchMemory where its core would fill more than most_bytes.
    CarefulShape(std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
                 std::int64_t most_bytes = no_limit);
    CarefulShape(const CarefulShape &) = delete;
    CarefulShape &operator=(const CarefulShape &) = delete;

    const CarefulPlan &plan() const { return plan_; }
    std::int64_t memory() const;  // bytes

private:
    using List = std::vector<std::int32_t>;

    void find_arms();
    void strip();
    void order_core(std::int64_t most_bytes);
    void find_ring();

    List atom_i_, atom_j_, arm_start_, arms_, parent_, hanging_, core_, place_, rows_, ring_, column_start_;
    std::vector<std::int64_t> table_start_;
    CarefulPlan plan_{};
};

}  // namespace holonomic
