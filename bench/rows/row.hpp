/**
 * A row of the comparison: one call, on a scene, in a layout of the caller's arrays.
 */
#ifndef BENCH_ROWS_ROW_HPP
#define BENCH_ROWS_ROW_HPP

#include <functional>
#include <string>
#include <vector>

#include "scene.hpp"

namespace rows {

enum class Layout { packed, separate, floats };

/// One vector per atom, in a layout.
class Field {
public:
    Field(Layout layout, const std::vector<double> &values);
    Field(Field &&) = default;  // the view goes on pointing to the same elements
    /// The values of another one of the same layout and size.
    void copy(const Field &other);
    double *packed() { return static_cast<double *>(view_.x); }  ///< of that layout alone
    const hol_view *view() const { return &view_; }
    const hol_const_view *input() {
        read_ = hol_view_read(&view_);
        return &read_;
    }

private:
    std::vector<double> doubles_;
    std::vector<float> floats_;
    hol_view view_;
    hol_const_view read_;
};

/// Arrays of one call.
struct Arrays {
    Field reference, r, v, f, g;
    std::vector<double> lambda, more;  ///< [bonds]; tensions, determinants
    Arrays(Layout layout, const Scene &scene, bool moved);
};

struct Call {
    const Library &calls;
    const Scene &scene;
    hol_chains *chains;
    hol_factors *factors;  ///< of rows that have some, at the positions of the arrays
    Arrays &arrays;
};

struct Row {
    std::string name;
    bool common = true;  ///< packed or listed atoms, no box or an orthorhombic one
    bool alone = false;  ///< one molecule that may take the kernels of one lane
    bool keeps = false;  ///< factors, made before the call
    bool moved = false;  ///< r after a step; otherwise on the constraints
    Layout layout = Layout::packed;
    std::function<Recipe()> recipe;
    std::function<int(const Call &)> call;
};

std::vector<Row> all_rows();

}  // namespace rows

#endif
