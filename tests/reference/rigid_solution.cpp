#include "rigid_solution.hpp"

#include <algorithm>

#include "rigid_nodes.hpp"

namespace reference
{

namespace
{

using namespace rigid_nodes;

/** Multipliers of all rows, nodes' accelerations, velocities or places, and the scale of the multipliers. */
struct outcome {
    bool there = false;
    std::vector<real> t;
    std::vector<long double> scale;
    std::vector<vec> z, z_size;  // of nodes; sizes of what they are made of, without the constraints
};

class solver
{
public:
    solver(const rigid_problem &p, kind which, bool scales)
        : p_(p), s_(p, which), scales_(scales), q_(s_.nodes(p.r)), g_(s_.differentiate(q_)), a_(s_.matrix(g_, g_)),
          factor_(a_)
    {
        real least = factor_.regular() ? real(1) : real(0);
        for (std::size_t k = 0; factor_.regular() && k < a_.size(); ++k) {
            const real part = factor_.pivots()[k] / a_[k].at(k);
            if (part < least) least = part;
        }
        regular = least > zero_pivot;
        least_pivot = static_cast<long double>(least);
        if (!regular || !scales_) return;
        inverse_ = inverse_of(factor_, n_rows());
        // (A^-1)_kk is one over the pivot of row k where it comes last, which is the least that it can have.
        for (std::size_t k = 0; k < a_.size(); ++k)
            least_pivot = std::min(least_pivot, 1 / (static_cast<long double>(a_[k].at(k)) * inverse_[k][k]));
    }

    bool regular = false;
    long double least_pivot;
    std::size_t n_rows() const
    {
        return s_.rows.size();
    }

    outcome forces() const
    {
        outcome o;
        o.z = s_.forces(p_.f, false);
        o.z_size = s_.forces(p_.f, true);
        s_.add_lifted(p_, q_, false, o.z);
        s_.add_lifted(p_, q_, true, o.z_size);
        const std::vector<vec> u = s_.nodes(p_.v), u_size = s_.node_sizes(p_.v);
        std::vector<real> c, c_size;
        for (const constraint &k : s_.rows) {
            c.push_back(product(at(k.left, u), at(k.right, u)));
            // bonds between two atoms of none have differences of velocities, which are exact
            c_size.push_back(k.bond >= 0 ? product_of_sizes(at(k.left, u), at(k.right, u))
                                         : product(at(k.left, u_size), at(k.right, u_size)));
        }
        for (std::size_t n = 0; n < u.size(); ++n)
            for (std::size_t x = 0; x < 3; ++x) o.z[n][x] *= s_.w[n], o.z_size[n][x] *= s_.w[n];
        solve(c, c_size, o);
        return o;
    }
    outcome velocities() const
    {
        outcome o;
        o.z = s_.nodes(p_.v);
        o.z_size = s_.node_sizes(p_.v);
        solve({}, {}, o);
        return o;
    }
    outcome given(const std::vector<double> &rhs) const
    {
        outcome o;
        o.z.resize(s_.w.size());
        o.z_size.resize(s_.w.size());
        std::vector<real> c;
        for (const constraint &k : s_.rows)
            c.push_back(k.bond < 0 ? real(0) : real(rhs[static_cast<std::size_t>(k.bond)]).scaled(-1));
        o.t = factor_.solve(c);
        o.there = true;
        if (!scales_) return o;
        std::vector<real> size;
        for (std::size_t k = 0; k < c.size(); ++k) {
            size.push_back(absolute(c[k]));
            for (const auto &[l, x] : a_[k]) size[k] += absolute(x * o.t[l]);
        }
        o.scale = amplified(inverse_, size);
        return o;
    }
    /** Newton's method begins at the drifted atoms, or near `found`, if that is not empty. */
    outcome positions(const std::vector<double> &drifted, const std::vector<double> &found) const
    {
        outcome o;
        o.z = s_.nodes(drifted);
        o.t.resize(n_rows());
        if (!found.empty()) move_near(s_.nodes(found), o);
        if (!newton(o)) return o;
        o.there = true;
        if (!scales_) return o;
        real extent(0);
        for (std::size_t i = 0; i < p_.n_atoms(); ++i) {
            vec x{};
            for (const share &s : s_.of_atom[i]) add_times(x, s.factor, o.z[s.of]);
            if (largest(x) > extent) extent = largest(x);
        }
        std::vector<real> size;
        for (const constraint &k : s_.rows) size.push_back(k.scale + k.reach * extent);
        const sparse_factor<real> factor(s_.matrix(s_.differentiate(o.z), g_));
        o.there = factor.regular();
        if (!o.there) return o;
        o.scale = amplified(inverse_of(factor, n_rows()), size);
        for (std::size_t k = 0; k < size.size(); ++k) o.scale[k] += static_cast<long double>(absolute(o.t[k]));
        return o;
    }

    /** t in units of forces: multiplied by `unit`. */
    rigid_level level(const outcome &o, const real &unit, bool moved) const;

    /** Values of one frame with the scales of another. */
    friend bool put_scales(const solver &of, const outcome &o, const real &unit, bool moved, rigid_level &to);

private:
    const rigid_problem &p_;
    node_system s_;
    bool scales_;
    std::vector<vec> q_;
    node_system::gradients g_;
    sparse_matrix<real> a_;
    sparse_factor<real> factor_;

    using matrix_of_sizes = std::vector<std::vector<long double>>;
    matrix_of_sizes inverse_;

    /** Elements of |A^-1|, column by column. */
    static matrix_of_sizes inverse_of(const sparse_factor<real> &factor, std::size_t n)
    {
        matrix_of_sizes all;
        for (std::size_t l = 0; l < n; ++l) {
            std::vector<real> column(n);
            column[l] = real(1);
            column = factor.solve(column);
            all.emplace_back();
            for (const real &x : column) all.back().push_back(static_cast<long double>(absolute(x)));
        }
        return all;
    }

    static std::vector<long double> amplified(const matrix_of_sizes &inverse, const std::vector<real> &size)
    {
        std::vector<long double> sum(size.size());
        for (std::size_t l = 0; l < size.size(); ++l)
            for (std::size_t k = 0; k < size.size(); ++k) sum[k] += inverse[l][k] * static_cast<long double>(size[l]);
        return sum;
    }

    void solve(const std::vector<real> &c, const std::vector<real> &c_size, outcome &o) const
    {
        std::vector<real> b(n_rows()), size(n_rows());
        for (std::size_t k = 0; k < b.size(); ++k) {
            if (!c.empty()) b[k] = c[k], size[k] = c_size[k];
            for (const auto &g : g_[k]) {
                b[k] += product(g.g, o.z[g.node]);
                size[k] += product_of_sizes(g.g, o.z_size[g.node]);
            }
        }
        o.t = factor_.solve(b);
        for (std::size_t k = 0; k < b.size(); ++k)
            for (const auto &g : g_[k]) add_times(o.z[g.node], -s_.w[g.node] * o.t[k], g.g);
        o.there = true;
        if (!scales_) return;
        for (std::size_t k = 0; k < b.size(); ++k)
            for (const auto &g : g_[k]) size[k] += absolute(product(g.g, o.z[g.node]));
        o.scale = amplified(inverse_, size);
    }

    /** As near to `target` as the multipliers can bring the nodes. */
    void move_near(const std::vector<vec> &target, outcome &o) const
    {
        std::vector<real> b(n_rows());
        for (std::size_t k = 0; k < b.size(); ++k)
            for (const auto &g : g_[k]) b[k] += product(g.g, o.z[g.node]) - product(g.g, target[g.node]);
        o.t = factor_.solve(b);
        for (std::size_t k = 0; k < b.size(); ++k)
            for (const auto &g : g_[k]) add_times(o.z[g.node], -s_.w[g.node] * o.t[k], g.g);
    }

    bool newton(outcome &o) const
    {
        const real done = real(1).scaled(-real::bits * 3 / 4);
        for (int solves = 0; solves <= 60; ++solves) {
            std::vector<real> error;
            real worst(0);
            for (const constraint &k : s_.rows) {
                error.push_back((product(at(k.left, o.z), at(k.right, o.z)) - k.target).scaled(-1));
                const real part = absolute(error.back()) / k.scale;
                if (part > worst) worst = part;
            }
            if (worst < done) return true;
            if (worst > real(1e30)) return false;
            const sparse_factor<real> factor(s_.matrix(s_.differentiate(o.z), g_));
            if (!factor.regular()) return false;
            const std::vector<real> change = factor.solve(error);
            for (std::size_t k = 0; k < error.size(); ++k) {
                o.t[k] += change[k];
                for (const auto &g : g_[k]) add_times(o.z[g.node], -s_.w[g.node] * change[k], g.g);
            }
        }
        return false;
    }
};

rigid_level solver::level(const outcome &o, const real &unit, bool moved) const
{
    rigid_level to;
    to.there = o.there;
    if (!o.there) return to;
    const std::size_t n = p_.n_atoms();
    to.lambda.resize(p_.pairs.size());
    std::vector<vec> pull(s_.w.size());
    std::array<real, 9> virial{};
    for (std::size_t k = 0; k < s_.rows.size(); ++k) {
        const constraint &row = s_.rows[k];
        const real t = o.t[k] * unit;
        if (row.bond >= 0) to.lambda[static_cast<std::size_t>(row.bond)] = static_cast<long double>(t.scaled(-1));
        for (const auto &g : g_[k]) add_times(pull[g.node], -t, g.g);
        const vec left = at(row.left, q_), right = at(row.right, q_);
        for (std::size_t x = 0; x < 3; ++x)
            for (std::size_t y = 0; y < 3; ++y)
                virial[3 * x + y] -= t * (left[x] * right[y] + right[x] * left[y]).scaled(-1);
    }
    for (const lifted &site : s_.sites) {
        if (moved) continue;
        const vec f = row_of(p_.f, site.atom), first = at(site.first, q_), second = at(site.second, q_);
        const vec normal = cross_product(first, second), on[2] = {cross_product(second, f), cross_product(f, first)};
        for (std::size_t x = 0; x < 3; ++x)
            for (std::size_t y = 0; y < 3; ++y)
                virial[3 * x + y] += site.z * (first[x] * on[0][y] + second[x] * on[1][y] - normal[x] * f[y]);
    }
    for (std::size_t i = 0; i < 9; ++i) to.virial[i] = static_cast<long double>(virial[i]);
    std::vector<vec> lift(n);  // velocities, or places, of sites off planes
    for (const lifted &site : s_.sites) {
        if (!moved || o.z.empty()) continue;
        const vec first = at(site.first, o.z), second = at(site.second, o.z);
        if (o.z_size.empty()) {
            add_times(lift[site.atom], site.z, cross_product(first, second));
            continue;
        }
        add_times(lift[site.atom], site.z, cross_product(first, at(site.second, q_)));
        add_times(lift[site.atom], site.z, cross_product(at(site.first, q_), second));
    }
    for (std::size_t i = 0; i < n; ++i) {
        vec z{}, g{};
        for (const share &s : s_.of_atom[i]) add_times(z, s.factor, o.z[s.of]);
        if (!s_.in_body[i])
            g = pull[s_.of_atom[i][0].of];
        else if (!moved)
            for (std::size_t x = 0; x < 3; ++x) g[x] = real(p_.mass[i]) * z[x] - real(p_.f[3 * i + x]);
        for (std::size_t x = 0; x < 3; ++x) {
            to.g.push_back(static_cast<long double>(g[x]));
            to.moved.push_back(static_cast<long double>(z[x] + lift[i][x]));
        }
    }
    return to;
}

/** False if the multipliers of bonds or what atoms do are not those of `to`. */
bool put_scales(const solver &of, const outcome &o, const real &unit, bool moved, rigid_level &to)
{
    const node_system &s = of.s_;
    const rigid_level same = of.level(o, unit, moved);
    to.lambda_scale.resize(to.lambda.size());
    std::vector<real> pull(s.w.size());
    real virial(0);
    for (std::size_t k = 0; k < s.rows.size(); ++k) {
        const constraint &row = s.rows[k];
        const real t = real(o.scale[k]) * absolute(unit);
        if (row.bond >= 0) to.lambda_scale[static_cast<std::size_t>(row.bond)] = static_cast<long double>(t.scaled(-1));
        for (const auto &g : of.g_[k]) pull[g.node] += t * length(g.g);
        virial += t * length(at(row.left, of.q_)) * length(at(row.right, of.q_));
    }
    for (const lifted &site : s.sites)
        if (!moved)
            virial += real(3) * absolute(site.z) * length(row_of(of.p_.f, site.atom)) * length(at(site.first, of.q_)) *
                      length(at(site.second, of.q_));
    to.virial_scale = static_cast<long double>(virial);
    const auto size_of = [&](const combination &all) {
        real sum(0);
        for (const share &c : all)
            sum += absolute(c.factor) *
                   ((o.z_size.empty() ? real(0) : largest(o.z_size[c.of])) + s.w[c.of] * pull[c.of] / absolute(unit));
        return sum;
    };
    for (std::size_t i = 0; i < of.p_.n_atoms(); ++i) {
        real z(0), g(0);
        for (const share &c : s.of_atom[i]) {
            const real start = o.z_size.empty() ? real(0) : largest(o.z_size[c.of]);
            z += absolute(c.factor) * (start + s.w[c.of] * pull[c.of] / absolute(unit));
            if (!s.in_body[i]) g = pull[c.of];
        }
        if (s.in_body[i] && !moved) g = real(of.p_.mass[i]) * z + largest(row_of(of.p_.f, i));
        for (const lifted &site : s.sites)
            if (site.atom == i)
                z += absolute(site.z) * (size_of(site.first) * length(at(site.second, of.q_)) +
                                         size_of(site.second) * length(at(site.first, of.q_)));
        if (o.z_size.empty())  // places: what they are counts beside what moves them
            z += largest({real(to.moved[3 * i]), real(to.moved[3 * i + 1]), real(to.moved[3 * i + 2])});
        to.moved_scale.push_back(static_cast<long double>(z));
        to.g_scale.push_back(static_cast<long double>(g));
    }
    // All nodes of a loose part are in all of its atoms, and so in bonds at it, though what they are made of may be
    // zero: roundings of twice the precision are allowed there.
    for (std::vector<long double> *scale : {&to.g_scale, &to.moved_scale, &to.lambda_scale}) {
        if (of.p_.parts.empty() || scale->empty()) continue;
        const long double most = *std::max_element(scale->begin(), scale->end());
        for (long double &each : *scale) each = std::max(each, 0x1p-40L * most);
    }
    const auto alike = [](long double a, long double b, long double scale) {
        const long double off = a < b ? b - a : a - b;
        return off <= 0x1p-50L * scale || off == 0;
    };
    bool good = true;
    for (std::size_t k = 0; k < to.lambda.size(); ++k)
        good = good && alike(to.lambda[k], same.lambda[k], to.lambda_scale[k]);
    for (std::size_t i = 0; i < to.moved.size(); ++i)
        good = good && alike(to.moved[i], same.moved[i], to.moved_scale[i / 3]) &&
               alike(to.g[i], same.g[i], to.g_scale[i / 3]);
    for (std::size_t i = 0; i < 9; ++i) good = good && alike(to.virial[i], same.virial[i], to.virial_scale);
    return good;
}

}  // namespace

body_facts facts_of_body(const rigid_problem &p, std::size_t body)
{
    return rigid_frame<real>(p, p.bodies[body], false).facts;
}

body_shape shape_of_body(const rigid_problem &p, const std::vector<std::size_t> &atoms)
{
    const rigid_frame<real> frame(p, atoms, true);
    body_shape shape;
    for (std::size_t d = 0; d < frame.rank; ++d) shape.length.push_back(static_cast<double>(length(frame.vectors[d])));
    for (std::size_t a = 0; a < atoms.size(); ++a) {
        shape.share.emplace_back();
        for (std::size_t d = 0; d < frame.rank; ++d)
            shape.share[a][d] = static_cast<double>(real(p.mass[atoms[a]]) * frame.y[a][d] / frame.mass);
    }
    return shape;
}

rigid_solution solve_rigid(const rigid_problem &p, const std::vector<double> &rhs, const std::vector<double> &drifted,
                           double dt, const std::vector<double> &found)
{
    rigid_solution out;
    const solver points(p, kind::points, false), vectors(p, kind::vectors, true);
    out.regular = vectors.regular && points.regular;
    out.least_pivot = vectors.least_pivot;
    out.n_constraints = points.n_rows();
    if (!out.regular) return out;
    bool same = true;
    const auto both = [&](const outcome &values, const outcome &scales, const real &unit, bool moved) {
        rigid_level level = points.level(values, unit, moved);
        level.there = values.there && scales.there;
        same = !level.there || put_scales(vectors, scales, unit, moved, level);
        return level;
    };
    out.forces = both(points.forces(), vectors.forces(), real(1), false);
    out.agrees = same;
    out.velocities = both(points.velocities(), vectors.velocities(), real(1), true);
    out.agrees = out.agrees && same;
    if (!rhs.empty()) out.solve = both(points.given(rhs), vectors.given(rhs), real(1), true);
    out.agrees = out.agrees && same;
    if (drifted.empty() || !(dt > 0)) return out;
    // From far away Newton's method may come to different solutions: that case has no reference.
    out.positions = both(points.positions(drifted, found), vectors.positions(drifted, found),
                         real(1) / (real(dt) * real(dt)), true);
    out.positions.there = out.positions.there && same;
    return out;
}

}  // namespace reference
