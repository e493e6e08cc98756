#include "core/caller/reduce.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/double_pair.hpp"

namespace holonomic {

namespace {

typedef double Rows[3][3];

// What lies on the border between two cells, as the tilt of half a side, stays as it is: its rounding decides nothing.
constexpr double border = 1e-9;
// Each round shortens a gradient. A cell whose rows are 1e10 times as long as needed takes some ten.
constexpr int most_rounds = 200;

double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Faces i are 1 / |g_i| apart: the widest cell has the shortest gradients. g_i -= n g_j is row j += n row i.
class Reduction {
public:
    Reduction(const Rows m, const bool *periodic) : periodic_(periodic) { std::memcpy(m_, m, sizeof m_); }

    // Whether there was anything to do.
    bool run() {
        int round = 0;
        for (; round < most_rounds; ++round) {
            gradients_of(m_, g_);
            if (!shorten_by_one() && !shorten_by_two()) break;
        }
        return round > 0;
    }

    // The rows as whole multiples of those that came, each sum rounded once.
    void rows(const Rows from, Rows to) const {
        for (int i = 0; i < 3; ++i)
            for (int c = 0; c < 3; ++c) {
                DoublePair sum = as_pair(0);
                for (int j = 0; j < 3; ++j) sum = sum + n_[i][j] * as_pair(from[j][c]);
                to[i][c] = rounded(sum);
            }
    }

private:
    void add(int to, double times, int row) {
        for (int c = 0; c < 3; ++c) {
            n_[to][c] += times * n_[row][c];
            m_[to][c] = std::fma(times, m_[row][c], m_[to][c]);
        }
    }

    // Takes the nearest multiple of one gradient off another.
    bool shorten_by_one() {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                if (i == j || !periodic_[i] || !periodic_[j]) continue;
                const double part = dot(g_[i], g_[j]) / dot(g_[j], g_[j]);
                if (!(std::fabs(part) > 0.5 + border)) continue;
                add(j, std::nearbyint(part), i);
                return true;
            }
        return false;
    }

    // Where no multiple of one does, the sum or the difference of the two others may.
    bool shorten_by_two() {
        if (!periodic_[0] || !periodic_[1] || !periodic_[2]) return false;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            for (const double p : {1.0, -1.0})
                for (const double q : {1.0, -1.0}) {
                    double s[3];
                    for (int c = 0; c < 3; ++c) s[c] = g_[i][c] - p * g_[j][c] - q * g_[k][c];
                    if (!(dot(s, s) < (1 - border) * dot(g_[i], g_[i]))) continue;
                    add(j, p, i);
                    add(k, q, i);
                    return true;
                }
        }
        return false;
    }

    const bool *periodic_;
    Rows m_, g_ = {}, n_ = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
};

double steepest(const Rows m, const bool *periodic) {
    Rows g;
    gradients_of(m, g);
    double most = 0;
    for (int i = 0; i < 3; ++i)
        if (periodic[i]) most = std::max(most, dot(g[i], g[i]));
    return most;
}

}  // namespace

double gradients_of(const double m[3][3], double g[3][3]) {
    for (int i = 0; i < 3; ++i) {
        const double *const a = m[(i + 1) % 3], *const b = m[(i + 2) % 3];
        for (int c = 0; c < 3; ++c) g[i][c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
    }
    double volume = 0;
    for (int c = 0; c < 3; ++c) volume += m[0][c] * g[0][c];
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c) g[i][c] /= volume;
    return volume;
}

bool reduce_cell(double m[3][3], const bool *periodic) {
    Reduction reduction(m, periodic);
    if (!reduction.run()) return false;
    Rows rows;
    reduction.rows(m, rows);
    if (!(steepest(rows, periodic) < (1 - border) * steepest(m, periodic))) return false;
    std::memcpy(m, rows, sizeof rows);
    return true;
}

}  // namespace holonomic
