#include "core/rigid/heights.hpp"
#include "core/index.hpp"

#include <algorithm>
#include <cmath>

namespace holonomic::rigid {

namespace {

class Heights {
public:
    Heights(std::int64_t n, const double *squares) : n_(n), squares_(squares), x_(3 * at(n), 0), height_(at(n)) {
        for (std::int64_t i = 0; i < n; ++i) height_[at(i)] = squares[i];
        for (std::int64_t e = 0; e < n * n; ++e) largest_ = std::max(largest_, squares[e]);
    }
    void go_on() {
        const std::int64_t p = std::max_element(height_.begin(), height_.end()) - height_.begin();
        if (!(height_[at(p)] > 0)) return;
        const long double root = std::sqrt(height_[at(p)]);
        for (std::int64_t i = 0; i < n_; ++i) {
            long double product = (static_cast<long double>(squares_[i]) + squares_[p] - squares_[i * n_ + p]) / 2;
            for (int c = 0; c < dimension_; ++c) product -= x_[at(3 * i + c)] * x_[at(3 * p + c)];
            x_[at(3 * i + dimension_)] = i == 0 ? 0 : product / root;
        }
        for (std::int64_t i = 0; i < n_; ++i) height_[at(i)] -= x_[at(3 * i + dimension_)] * x_[at(3 * i + dimension_)];
        height_[at(p)] = 0;
        ++dimension_;
    }
    double left() const {
        const auto less = [](long double a, long double b) { return std::fabs(a) < std::fabs(b); };
        return static_cast<double>(*std::max_element(height_.begin(), height_.end(), less)) / largest_;
    }
    const std::vector<long double> &coordinates() const { return x_; }

private:
    const std::int64_t n_;
    const double *const squares_;
    std::vector<long double> x_, height_;
    double largest_ = 0;
    int dimension_ = 0;
};

}  // namespace

double coordinates_in(int dimension, std::int64_t n, const double *squares, std::vector<double> &coordinates) {
    Heights heights(n, squares);
    for (int d = 0; d < dimension; ++d) heights.go_on();
    coordinates.resize(3 * at(n));
    for (std::size_t i = 0; i < coordinates.size(); ++i) coordinates[i] = static_cast<double>(heights.coordinates()[i]);
    return heights.left();
}

}  // namespace holonomic::rigid
