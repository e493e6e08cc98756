#include <Eigen/Eigenvalues>
#include <cmath>

#include "bodies/movers.hpp"

namespace bench {
namespace {

constexpr int lanes = 8;

// Of `lanes` bodies, number by number.
struct Block {
    double q[4][lanes], p[4][lanes];  // quaternion and its momentum
    double c[3][lanes], u[3][lanes];  // centre and its velocity
};

// P_k q of Miller et al., (21).
template <int k>
inline void permuted(const double *q, double *to) {
    constexpr int from[3][4] = {{1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}};
    constexpr double sign[3][4] = {{-1, 1, 1, -1}, {-1, -1, 1, 1}, {-1, 1, -1, 1}};
    for (int j = 0; j < 4; ++j) to[j] = sign[k][j] * q[from[k][j]];
}

// sin and cos of angles that are small in any sensible step; from Taylor's series to 1e-17 at a quarter.
inline void small_turn(double x, double &s, double &c) {
    const double y = x * x;
    s = x * (1 - y / 6 * (1 - y / 20 * (1 - y / 42 * (1 - y / 72 * (1 - y / 110 * (1 - y / 156))))));
    c = 1 - y / 2 * (1 - y / 12 * (1 - y / 30 * (1 - y / 56 * (1 - y / 90 * (1 - y / 132 * (1 - y / 182))))));
}

class Quaternions final : public Mover {
public:
    explicit Quaternions(const BodyScene &s)
        : n_(s.atoms_each()), n_bodies_(s.n_bodies), r_(s.r),
          blocks_(static_cast<std::size_t>((s.n_bodies + lanes - 1) / lanes)) {
        find_axes(s);
        for (std::int64_t b = 0; b < n_bodies_; ++b) start(s, b);
        for (std::int64_t b = n_bodies_; b < static_cast<std::int64_t>(blocks_.size()) * lanes; ++b)
            for (int j = 0; j < 4; ++j) of(b).q[j][b % lanes] = j == 0;
    }

    void first_half(const double *f, double dt) override {
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            kick(blocks_[b], f, b, dt);
            drift(blocks_[b], dt);
            write(blocks_[b], b);
        }
    }
    void second_half(const double *f, double dt) override {
        for (std::size_t b = 0; b < blocks_.size(); ++b) kick(blocks_[b], f, b, dt);
    }
    const double *positions() const override { return r_.data(); }
    double kinetic() const override {
        double sum = 0;
        for (std::int64_t b = 0; b < n_bodies_; ++b) {
            const Block &k = blocks_[static_cast<std::size_t>(b / lanes)];
            const long l = b % lanes;
            double q[4], x[4];
            for (int j = 0; j < 4; ++j) q[j] = k.q[j][l];
            for (int c = 0; c < 3; ++c) {
                sum += 0.5 * mass_ * k.u[c][l] * k.u[c][l];
                c == 0 ? permuted<0>(q, x) : c == 1 ? permuted<1>(q, x) : permuted<2>(q, x);
                double along = 0;
                for (int j = 0; j < 4; ++j) along += 0.5 * k.p[j][l] * x[j];
                sum += 0.5 * along * along * inverse_[c];
            }
        }
        return sum;
    }

private:
    const std::int64_t n_, n_bodies_;
    double mass_ = 0, inverse_[3] = {0, 0, 0};  // of the moments; 0: about the line of a linear body
    std::vector<double> x_;                     // [n][3] in the body's axes
    Eigen::Matrix3d axes_;
    std::vector<double> r_;
    std::vector<Block> blocks_;

    Block &of(std::int64_t b) { return blocks_[static_cast<std::size_t>(b / lanes)]; }

    void find_axes(const BodyScene &s) {
        Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
        for (std::int64_t i = 0; i < n_; ++i) {
            const Eigen::Vector3d x(&s.place[static_cast<std::size_t>(3 * i)]);
            const double m = s.mass[static_cast<std::size_t>(i)];
            mass_ += m;
            moments += m * (x.squaredNorm() * Eigen::Matrix3d::Identity() - x * x.transpose());
        }
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> found(moments);
        axes_ = found.eigenvectors();
        if (axes_.determinant() < 0) axes_.col(0) *= -1;
        for (int k = 0; k < 3; ++k)
            inverse_[k] = found.eigenvalues()[k] > 1e-10 * found.eigenvalues()[2] ? 1 / found.eigenvalues()[k] : 0;
        for (std::int64_t i = 0; i < n_; ++i) {
            const Eigen::Vector3d x = axes_.transpose() * Eigen::Vector3d(&s.place[static_cast<std::size_t>(3 * i)]);
            x_.insert(x_.end(), x.data(), x.data() + 3);
        }
    }

    // The rotation that takes the places to where the atoms are, and the momenta of their velocities.
    void start(const BodyScene &s, std::int64_t b) {
        Eigen::Matrix3d fit = Eigen::Matrix3d::Zero();
        Eigen::Vector3d c = Eigen::Vector3d::Zero(), u = c, angular = c;
        const double *const r = &s.r[static_cast<std::size_t>(3 * n_ * b)],
                            *const v = &s.v[static_cast<std::size_t>(3 * n_ * b)];
        for (std::int64_t i = 0; i < n_; ++i) {
            const double part = s.mass[static_cast<std::size_t>(i)] / mass_;
            c += part * Eigen::Vector3d(r + 3 * i), u += part * Eigen::Vector3d(v + 3 * i);
        }
        for (std::int64_t i = 0; i < n_; ++i) {
            const double m = s.mass[static_cast<std::size_t>(i)];
            const Eigen::Vector3d x = Eigen::Vector3d(r + 3 * i) - c;
            fit += m * x * Eigen::Vector3d(&x_[static_cast<std::size_t>(3 * i)]).transpose();
            angular += m * x.cross(Eigen::Vector3d(v + 3 * i) - u);
        }
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(fit, Eigen::ComputeFullU | Eigen::ComputeFullV);
        Eigen::Matrix3d signs = Eigen::Matrix3d::Identity();
        signs(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant();
        const Eigen::Matrix3d turned = svd.matrixU() * signs * svd.matrixV().transpose();
        const Eigen::Quaterniond q(turned);
        const Eigen::Vector3d inside = turned.transpose() * angular;
        const double values[4] = {q.w(), q.x(), q.y(), q.z()};
        Block &k = of(b);
        const long l = b % lanes;
        for (int j = 0; j < 4; ++j) k.q[j][l] = values[j], k.p[j][l] = 0;
        add_moment(k, l, inside[0], inside[1], inside[2]);
        for (int x = 0; x < 3; ++x) k.c[x][l] = c[x], k.u[x][l] = u[x];
    }

    // p += 2 S(q) (0, m)
    static inline void add_moment(Block &k, long l, double x, double y, double z) {
        const double a = k.q[0][l], b = k.q[1][l], c = k.q[2][l], d = k.q[3][l];
        k.p[0][l] += 2 * (-b * x - c * y - d * z);
        k.p[1][l] += 2 * (a * x - d * y + c * z);
        k.p[2][l] += 2 * (d * x + a * y - b * z);
        k.p[3][l] += 2 * (-c * x + b * y + a * z);
    }

    static inline void rotation(const Block &k, long l, double (*to)[3]) {
        const double a = k.q[0][l], b = k.q[1][l], c = k.q[2][l], d = k.q[3][l];
        to[0][0] = a * a + b * b - c * c - d * d, to[0][1] = 2 * (b * c - a * d), to[0][2] = 2 * (b * d + a * c);
        to[1][0] = 2 * (b * c + a * d), to[1][1] = a * a - b * b + c * c - d * d, to[1][2] = 2 * (c * d - a * b);
        to[2][0] = 2 * (b * d - a * c), to[2][1] = 2 * (c * d + a * b), to[2][2] = a * a - b * b - c * c + d * d;
    }

    // Sum of x f^T in body's coordinates by space's: nine sums that hold the torque whichever way the body points.
    void kick(Block &k, const double *f, std::size_t block, double dt) {
        double force[3][lanes] = {}, outer[3][3][lanes] = {};
        const std::int64_t first = static_cast<std::int64_t>(block) * lanes,
                           here = n_bodies_ - first < lanes ? n_bodies_ - first : lanes;
        for (std::int64_t i = 0; i < n_; ++i) {
            const double *const x = &x_[static_cast<std::size_t>(3 * i)], *const at = f + 3 * (first * n_ + i);
            double g[3][lanes] = {};
            for (long l = 0; l < here; ++l)
                for (int c = 0; c < 3; ++c) g[c][l] = at[3 * n_ * l + c];
            for (int c = 0; c < 3; ++c)
                for (int l = 0; l < lanes; ++l) {
                    force[c][l] += g[c][l];
                    for (int d = 0; d < 3; ++d) outer[d][c][l] += x[d] * g[c][l];
                }
        }
        const double half = 0.5 * dt;
        for (int l = 0; l < lanes; ++l) {
            double a[3][3], m[3][3];
            rotation(k, l, a);
            for (int d = 0; d < 3; ++d)
                for (int e = 0; e < 3; ++e)
                    m[d][e] = outer[d][0][l] * a[0][e] + outer[d][1][l] * a[1][e] + outer[d][2][l] * a[2][e];
            add_moment(k, l, half * (m[1][2] - m[2][1]), half * (m[2][0] - m[0][2]), half * (m[0][1] - m[1][0]));
            for (int c = 0; c < 3; ++c) k.u[c][l] += half / mass_ * force[c][l];
        }
    }

    template <int axis>
    void turn(Block &k, double dt) const {
        const double per = 0.25 * inverse_[axis] * dt;
        if (per == 0) return;
        for (int l = 0; l < lanes; ++l) {
            double q[4], p[4], x[4], y[4], s, c, angle = 0;
            for (int j = 0; j < 4; ++j) q[j] = k.q[j][l], p[j] = k.p[j][l];
            permuted<axis>(q, x);
            permuted<axis>(p, y);
            for (int j = 0; j < 4; ++j) angle += p[j] * x[j];
            small_turn(per * angle, s, c);
            for (int j = 0; j < 4; ++j) k.q[j][l] = c * q[j] + s * x[j], k.p[j][l] = c * p[j] + s * y[j];
        }
    }

    void drift(Block &k, double dt) const {
        turn<2>(k, dt / 2), turn<1>(k, dt / 2), turn<0>(k, dt), turn<1>(k, dt / 2), turn<2>(k, dt / 2);
        for (int c = 0; c < 3; ++c)
            for (int l = 0; l < lanes; ++l) k.c[c][l] += dt * k.u[c][l];
    }

    void write(const Block &k, std::size_t block) {
        double a[3][3][lanes];
        for (int l = 0; l < lanes; ++l) {
            double one[3][3];
            rotation(k, l, one);
            for (int d = 0; d < 3; ++d)
                for (int e = 0; e < 3; ++e) a[d][e][l] = one[d][e];
        }
        const std::int64_t first = static_cast<std::int64_t>(block) * lanes,
                           here = n_bodies_ - first < lanes ? n_bodies_ - first : lanes;
        for (std::int64_t i = 0; i < n_; ++i) {
            const double *const x = &x_[static_cast<std::size_t>(3 * i)];
            double *const to = &r_[static_cast<std::size_t>(3 * (first * n_ + i))];
            double g[3][lanes];
            for (int d = 0; d < 3; ++d)
                for (int l = 0; l < lanes; ++l)
                    g[d][l] = k.c[d][l] + a[d][0][l] * x[0] + a[d][1][l] * x[1] + a[d][2][l] * x[2];
            for (long l = 0; l < here; ++l)
                for (int c = 0; c < 3; ++c) to[3 * n_ * l + c] = g[c][l];
        }
    }
};

}  // namespace

std::unique_ptr<Mover> by_quaternions(const BodyScene &s) { return std::make_unique<Quaternions>(s); }

}  // namespace bench
