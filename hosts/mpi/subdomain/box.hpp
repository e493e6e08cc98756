#ifndef HOLONOMIC_SUBDOMAIN_BOX_HPP
#define HOLONOMIC_SUBDOMAIN_BOX_HPP

#include <algorithm>
#include <cmath>

#include "twice.hpp"

namespace holonomic_subdomain {

/** A periodic box as hol_chains_set_box takes it. */
class Box {
public:
    Box() = default;

    explicit Box(const double *rows) : periodic_(rows != nullptr) {
        if (!rows) return;
        std::copy(rows, rows + 9, h_);
        double full[9];
        std::copy(rows, rows + 9, full);
        for (int i = 0; i < 3; ++i)
            if (h_[3 * i] == 0 && h_[3 * i + 1] == 0 && h_[3 * i + 2] == 0) full[4 * i] = 1, open_[i] = true;
        const auto minor = [&](int i, int j) {
            const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            return full[3 * a + c] * full[3 * b + d] - full[3 * a + d] * full[3 * b + c];
        };
        const double volume = full[0] * minor(0, 0) + full[1] * minor(0, 1) + full[2] * minor(0, 2);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) inverse_[3 * j + i] = minor(i, j) / volume;
    }

    const double *rows() const { return periodic_ ? h_ : nullptr; }

    /** From a to b, to the image nearest to a. It is the right one if the vector is shorter than half the box. */
    HOL_SUBDOMAIN_INLINE TwiceVector between(const double *a, const double *b) const {
        TwiceVector d = difference(b, a);
        if (!periodic_) return d;
        for (int i = 0; i < 3; ++i) {
            if (open_[i]) continue;
            const double n = std::round(d.hi[0] * inverse_[i] + d.hi[1] * inverse_[3 + i] + d.hi[2] * inverse_[6 + i]);
            if (n != 0) d = d + multiple(-n, h_ + 3 * i);
        }
        return d;
    }

private:
    bool periodic_ = false, open_[3] = {false, false, false};
    double h_[9] = {0}, inverse_[9] = {0};  // coordinates along box vector i: sum over c of d_c inverse_[3 c + i]
};

}  // namespace holonomic_subdomain

#endif
