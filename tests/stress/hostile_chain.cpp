#include "hostile_chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "seam_features.hpp"

namespace stress
{

namespace
{

using vec = std::vector<double>;

struct dice {
    random_stream stream;
    double uniform(double low, double high)
    {
        return low + (high - low) * random_uniform(&stream);
    }
    double decades(double low, double high)
    {
        return std::pow(10.0, uniform(low, high));
    }
    bool chance(double p)
    {
        return random_uniform(&stream) < p;
    }
    int one_of(int n)
    {
        return static_cast<int>(random_integer(&stream, 0, n - 1));
    }
    double sign()
    {
        return chance(0.5) ? 1 : -1;
    }
    std::int64_t atom(const hostile_chain &c)
    {
        return random_integer(&stream, 0, c.n_bonds);
    }
};

std::size_t at(std::int64_t i)
{
    return static_cast<std::size_t>(i);
}

void draw_masses(hostile_chain &c, dice &d)
{
    const std::size_t atoms = c.mass.size();
    const int style = c.features & UNEQUAL_MASSES ? d.one_of(4) : 4;
    const double ratio = d.decades(0, 24), heavy = std::sqrt(ratio), base = d.decades(-3, 3);
    const std::size_t special = at(d.atom(c));
    const double odd = d.decades(-12, 12);
    for (std::size_t i = 0; i < atoms; ++i) {
        double m = base;
        if (style == 0) m = d.decades(-12, 12);
        if (style == 1) m = i % 2 ? heavy : 1 / heavy;
        if (style == 2) m = i == special ? odd : 1;
        if (style == 3) m = std::pow(ratio, static_cast<double>(i) / static_cast<double>(atoms) - 0.5);
        set_mass(c, i, m);
    }
    if (!(c.features & FIXED_ATOMS)) return;
    const int where = d.one_of(4);
    const double share = d.decades(-2, -0.4);
    for (std::size_t i = 0; i < atoms; ++i) {
        bool fixed = where == 3 && d.chance(share);
        fixed = fixed || (i == 0 && (where == 0 || where == 2)) || (i + 1 == atoms && (where == 1 || where == 2));
        if (fixed && (i == 0 || c.w[i - 1] != 0)) c.w[i] = c.mass[i] = 0;  // a bond between fixed atoms is an error
    }
}

vec draw_lengths(const hostile_chain &c, dice &d)
{
    vec a(at(c.n_bonds));
    const int style = c.features & UNEQUAL_BONDS ? d.one_of(3) : 3;
    const double scale = d.decades(-3, 3), ratio = d.decades(0, 12);
    const std::size_t special = at(random_integer(&d.stream, 0, c.n_bonds - 1));
    for (std::size_t k = 0; k < a.size(); ++k) {
        a[k] = scale;
        if (style == 0) a[k] *= d.decades(-6, 6);
        if (style == 1 && k % 2) a[k] /= ratio;
        if (style == 2 && k == special) a[k] /= ratio;
    }
    return a;
}

void normal_to(const double *u, dice &d, double *out)
{
    double x[3], along = 0, square = 0;
    do {
        random_direction(&d.stream, x);
        along = x[0] * u[0] + x[1] * u[1] + x[2] * u[2];
        square = 1 - along * along;
    } while (square < 0.1);
    for (int i = 0; i < 3; ++i) out[i] = (x[i] - along * u[i]) / std::sqrt(square);
}

/** Turns the direction u by the next joint. */
void turn(double *u, dice &d, bool straight, bool right, double fold)
{
    double n[3], cosine = 0, sine = 1;
    if (!straight && !right) {
        random_direction(&d.stream, u);
        return;
    }
    if (right && (!straight || d.chance(0.5))) {
        cosine = d.chance(0.3) ? 0 : d.sign() * d.decades(-17, -1);
    } else {
        const double angle = d.chance(0.2) ? 0 : d.decades(-16, 0);
        cosine = std::cos(angle) * (d.chance(fold) ? -1 : 1);
        sine = std::sin(angle);
    }
    normal_to(u, d, n);
    for (int i = 0; i < 3; ++i) u[i] = cosine * u[i] + sine * n[i];
}

/** Along x with exact steps and sideways by tiny amounts: angles of 1e-16 that rounding does not drown. */
void walk_along_axis(hostile_chain &c, const vec &a, dice &d)
{
    const double fold = d.chance(0.5) ? 0 : d.uniform(0, 1), quiet = d.uniform(0, 1);
    for (std::size_t k = 0; k < a.size(); ++k) {
        c.r[3 * k + 3] = c.r[3 * k] + (d.chance(fold) ? -1 : 1) * std::exp2(std::round(std::log2(a[k])));
        for (std::size_t x = 1; x < 3; ++x)
            c.r[3 * k + 3 + x] = d.chance(quiet) ? c.r[3 * k + x] : d.sign() * d.decades(-16, -1) * a[k];
    }
}

/** Joints of right angles to the last bit, or off by a tiny part of the next bond. */
void walk_on_lattice(hostile_chain &c, const vec &a, dice &d)
{
    const double off = d.chance(0.5) ? 0 : d.uniform(0, 1);
    std::size_t axis = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        axis = (axis + 1 + (d.chance(0.5) ? 1 : 0)) % 3;
        for (std::size_t x = 0; x < 3; ++x) c.r[3 * k + 3 + x] = c.r[3 * k + x];
        c.r[3 * k + 3 + axis] += d.sign() * std::exp2(std::round(std::log2(a[k])));
        if (d.chance(off)) c.r[3 * k + 3 + (axis + 1) % 3] += d.sign() * d.decades(-16, -1) * a[k];
    }
}

void draw_positions(hostile_chain &c, dice &d)
{
    const vec a = draw_lengths(c, d);
    const bool straight = c.features & STRAIGHT, right = c.features & RIGHT_ANGLES;
    std::fill(c.r.begin(), c.r.end(), 0.0);
    if (straight && !right && d.chance(0.5)) return walk_along_axis(c, a, d);
    if (right && !straight && d.chance(0.3)) return walk_on_lattice(c, a, d);
    double u[3];
    random_direction(&d.stream, u);
    const double fold = d.chance(0.5) ? 0 : d.uniform(0, 1);
    const bool all = d.chance(0.5);
    const double hard = d.uniform(0, 1);
    for (std::size_t k = 0; k < a.size(); ++k) {
        const bool plain = !all && !d.chance(hard);
        if (k > 0) turn(u, d, straight && !plain, right && !plain, fold);
        for (std::size_t x = 0; x < 3; ++x) c.r[3 * k + 3 + x] = c.r[3 * k + x] + a[k] * u[x];
    }
}

void shift(hostile_chain &c, dice &d)
{
    for (std::size_t x = 0; x < 3; ++x) {
        const double offset = d.sign() * d.decades(0, 8);
        for (std::size_t i = 0; i < c.mass.size(); ++i) c.r[3 * i + x] += offset;
    }
}

/** Forces or velocities: normal, or over 30 decades, in one of several patterns. */
void draw_vectors(vec &out, const hostile_chain &c, dice &d, bool velocities)
{
    const bool wide = c.features & WIDE_FORCES;
    const int style = d.one_of(wide ? 6 : 5);
    const std::size_t special = at(d.atom(c));
    double common[3];
    random_direction(&d.stream, common);
    const double size = wide ? d.decades(-8, 8) : 1;
    for (std::size_t i = 0; i < c.mass.size(); ++i) {
        const double thermal = velocities ? std::sqrt(c.w[i]) : 1;
        const double spread = d.decades(-15, 15);
        for (std::size_t x = 0; x < 3; ++x) {
            double value = thermal * random_normal(&d.stream);
            if (style == 0) value = 0;
            if (style == 1) value = common[x] * size;                   // the same for all
            if (style == 2 && i != special) value = 0;                  // on one atom alone
            if (style == 3) value = common[x] * size * 1e8 + value;     // a large part that is common
            if (style == 5) value = spread * random_normal(&d.stream);  // of any size, atom by atom
            out[3 * i + x] = value;
        }
    }
}

void make_denormal(vec &out, dice &d)
{
    const double share = d.chance(0.3) ? 1 : d.uniform(0, 1);
    for (double &x : out)
        if (d.chance(share)) x = d.sign() * d.decades(-323, -300);
}

/** Of chains that are cut, every third one has something at the seams of some number of lanes. */
seam_features draw_seams(const hostile_chain &c, dice &d)
{
    if (c.seed < first_with_seams || !d.chance(1.0 / 3)) return {FIXED_THERE, {}};
    const cuts where = cuts_of_chain(lane_counts[d.one_of(n_lane_counts)], c.n_bonds);
    const std::vector<std::int64_t> &seams = d.chance(0.7) ? where.windows : where.segments;
    const seam_feature feature = static_cast<seam_feature>(d.one_of(n_drawn_features));
    const int offset = first_seam_offset + d.one_of(n_seam_offsets);
    return d.chance(0.7) ? at_all_seams(feature, seams, offset)
                         : at_one_seam(feature, seams, offset, at(random_integer(&d.stream, 0, 1000)));
}

}  // namespace

void set_mass(hostile_chain &c, std::size_t i, double mass)
{
    for (int attempt = 0; attempt < 100; ++attempt, mass = std::nextafter(mass, HUGE_VAL)) {
        c.w[i] = 1 / mass;
        c.mass[i] = 1 / c.w[i];
        if (1 / c.mass[i] == c.w[i]) return;
    }
}

const char *feature_name(int bit)
{
    static const char *const names[n_features] = {"unequal masses",     "fixed atoms",     "unequal bonds",
                                                  "straight or folded", "right angles",    "far away",
                                                  "wide forces",        "denormal numbers"};
    return names[bit];
}

solution_problem hostile_chain::problem() const
{
    return {n_bonds, nullptr, w.data(), r.data(), v.data(), f.data(), nullptr};
}

std::string hostile_chain::words() const
{
    std::string all;
    for (int bit = 0; bit < n_features; ++bit)
        if (features >> bit & 1u) all += (all.empty() ? "" : ", ") + std::string(feature_name(bit));
    return all.empty() ? "ordinary" : all;
}

std::vector<double> drifted(const hostile_chain &c)
{
    vec r = c.r;
    for (std::size_t i = 0; i < r.size(); ++i) r[i] += c.dt * c.v[i];
    return r;
}

bool complete(hostile_chain &c, double drift)
{
    c.length.assign(at(c.n_bonds), 0);
    c.dt = HUGE_VAL;
    for (std::size_t k = 0; k < c.length.size(); ++k) {
        long double square = 0, speed = 0;
        for (std::size_t x = 0; x < 3; ++x) {
            const long double d = static_cast<long double>(c.r[3 * k + 3 + x]) - c.r[3 * k + x];
            square += d * d;
            speed = std::max({speed, std::fabs(static_cast<long double>(c.v[3 * k + x])),
                              std::fabs(static_cast<long double>(c.v[3 * k + 3 + x]))});
        }
        c.length[k] = static_cast<double>(std::sqrt(square));
        if (!(c.length[k] > 0)) return false;
        if (speed > 0) c.dt = std::min(c.dt, static_cast<double>(drift * std::sqrt(square) / speed));
    }
    // a step whose square, or the square's reciprocal, is no finite number is refused
    if (!(c.dt > 1e-120 && c.dt < 1e120)) c.dt = 0;
    return true;
}

hostile_chain make_hostile_chain(std::uint64_t seed, std::int64_t longest)
{
    hostile_chain c;
    c.seed = seed;
    dice d{random_seed(seed * UINT64_C(0x9e3779b97f4a7c15) + 1)};
    const double share = d.uniform(0, 0.7);  // between ordinary chains and those that have everything
    for (int bit = 0; bit < n_features; ++bit)
        if (d.chance(bit == 7 ? share / 4 : share)) c.features |= 1u << bit;
    c.n_bonds = static_cast<std::int64_t>(std::exp(d.uniform(0, std::log(static_cast<double>(longest) + 1))));
    c.n_bonds = std::min(std::max(c.n_bonds, std::int64_t{1}), longest);
    const std::size_t atoms = at(c.n_bonds) + 1;
    c.w.resize(atoms), c.mass.resize(atoms);
    c.r.resize(3 * atoms), c.v.resize(3 * atoms), c.f.resize(3 * atoms);
    const seam_features seams = draw_seams(c, d);
    do {
        draw_masses(c, d);
        seams.put_masses(c);
    } while (c.n_bonds == 1 && c.w[0] == 0 && c.w[1] == 0);
    draw_vectors(c.f, c, d, false);
    draw_vectors(c.v, c, d, true);
    if (c.features & DENORMAL_FORCES) {
        make_denormal(c.f, d);
        if (d.chance(0.5)) make_denormal(c.v, d);
    }
    seams.put_forces(c);
    if (d.chance(0.7))  // fixed atoms may be given a velocity, too: a wall that moves
        for (std::size_t i = 0; i < atoms; ++i)
            if (c.w[i] == 0) c.v[3 * i] = c.v[3 * i + 1] = c.v[3 * i + 2] = 0;
    const double drift = d.decades(-9, -1.5);
    for (int attempt = 0;; ++attempt) {
        draw_positions(c, d);
        seams.put_bends(c);
        if (c.features & FAR_AWAY) shift(c, d);
        if (complete(c, drift)) return c;
        // the coordinates' rounding has swallowed a bond
        c.features &= ~static_cast<unsigned>(attempt < 8 ? FAR_AWAY : UNEQUAL_BONDS);
    }
}

}  // namespace stress
