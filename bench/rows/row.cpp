#include "row.hpp"

#include <algorithm>

namespace rows {

Field::Field(Layout layout, const std::vector<double> &values) {
    const std::size_t atoms = values.size() / 3;
    view_ = hol_view{};
    if (layout == Layout::floats) {
        floats_.assign(values.begin(), values.end());
        view_.x = floats_.data(), view_.y = floats_.data() + 1, view_.z = floats_.data() + 2;
        view_.stride = 3 * sizeof(float);
        view_.element = HOL_FLOAT;
        return;
    }
    doubles_ = values;
    view_.element = HOL_DOUBLE;
    if (layout == Layout::packed) {
        view_.x = doubles_.data(), view_.y = doubles_.data() + 1, view_.z = doubles_.data() + 2;
        view_.stride = 3 * sizeof(double);
        return;
    }
    for (std::size_t i = 0; i < atoms; ++i)
        for (std::size_t x = 0; x < 3; ++x) doubles_[x * atoms + i] = values[3 * i + x];
    view_.x = doubles_.data(), view_.y = doubles_.data() + atoms, view_.z = doubles_.data() + 2 * atoms;
    view_.stride = sizeof(double);
}

void Field::copy(const Field &other) {
    std::copy(other.doubles_.begin(), other.doubles_.end(), doubles_.begin());
    std::copy(other.floats_.begin(), other.floats_.end(), floats_.begin());
}

Arrays::Arrays(Layout layout, const Scene &scene, bool moved)
    : reference(layout, scene.r), r(layout, moved ? scene.moved : scene.r), v(layout, scene.v), f(layout, scene.f),
      g(layout, std::vector<double>(scene.f.size())), lambda(scene.bonds(), 0.1), more(scene.bonds() + scene.atoms()) {}

}  // namespace rows
