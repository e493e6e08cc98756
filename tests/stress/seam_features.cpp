#include "seam_features.hpp"

#include <algorithm>
#include <cmath>

namespace stress
{

namespace
{

std::size_t at(std::int64_t i)
{
    return static_cast<std::size_t>(i);
}

/** A unit vector square to u, along an axis if u is. */
void square_to(const double *u, double *out)
{
    const std::size_t least = static_cast<std::size_t>(
        std::min_element(u, u + 3, [](double a, double b) { return std::fabs(a) < std::fabs(b); }) - u);
    const std::size_t y = (least + 1) % 3, z = (least + 2) % 3;
    const double size = std::hypot(u[y], u[z]);
    out[least] = 0;
    out[y] = u[z] / size;
    out[z] = -u[y] / size;
}

/** Gives bond k a direction; what follows is carried along. */
void set_direction(hostile_chain &c, std::int64_t k, const double *u)
{
    double *const r = c.r.data() + 3 * k, a = std::hypot(r[3] - r[0], r[4] - r[1], r[5] - r[2]), move[3];
    for (std::size_t x = 0; x < 3; ++x) move[x] = r[x] + a * u[x] - r[3 + x];
    for (std::size_t i = 3 * at(k + 1); i < c.r.size(); ++i) c.r[i] += move[i % 3];
}

void unit_of_bond(const hostile_chain &c, std::int64_t k, double *u)
{
    const double *const r = c.r.data() + 3 * k, a = std::hypot(r[3] - r[0], r[4] - r[1], r[5] - r[2]);
    for (std::size_t x = 0; x < 3; ++x) u[x] = (r[3 + x] - r[x]) / a;
}

void bend(hostile_chain &c, seam_feature feature, std::int64_t atom)
{
    if (atom < 1 || atom >= c.n_bonds) return;
    double before[3], u[3];
    unit_of_bond(c, atom - 1, before);
    square_to(before, u);
    const double along = feature == FOLDED_THERE ? -1 : 1, beside = feature == IN_LINE_THERE ? 1e-6 : 0;
    for (std::size_t x = 0; x < 3 && feature != SQUARE_THERE; ++x) u[x] = along * before[x] + beside * u[x];
    set_direction(c, atom, u);
}

void set_mass_at(hostile_chain &c, std::int64_t atom, double factor)
{
    if (atom < 0 || atom > c.n_bonds || c.w[at(atom)] == 0) return;
    set_mass(c, at(atom), c.mass[at(atom)] * factor);
}

}  // namespace

const char *seam_feature_name(int feature)
{
    static const char *const names[N_SEAM_FEATURES] = {
        "a fixed atom", "a right angle",      "a straight joint", "a folded joint",   "a heavy atom",
        "a light atom", "heavy beside light", "a large force",    "a large velocity", "a light atom in line"};
    return names[feature];
}

void seam_features::put_masses(hostile_chain &c) const
{
    for (const std::int64_t i : atoms) {
        if (feature == HEAVY_THERE || feature == HEAVY_BESIDE_LIGHT) set_mass_at(c, i, 1e12);
        if (feature == LIGHT_THERE) set_mass_at(c, i, 1e-12);
        if (feature == HEAVY_BESIDE_LIGHT) set_mass_at(c, i + 1, 1e-12);
        if (feature == IN_LINE_THERE) set_mass_at(c, i, 1e-14);
        if (feature != FIXED_THERE || i < 0 || i > c.n_bonds) continue;
        if ((i > 0 && c.w[at(i - 1)] == 0) || (i < c.n_bonds && c.w[at(i + 1)] == 0)) continue;
        c.w[at(i)] = c.mass[at(i)] = 0;
    }
}

void seam_features::put_forces(hostile_chain &c) const
{
    for (const std::int64_t i : atoms)
        for (std::size_t x = 0; x < 3 && i >= 0 && i <= c.n_bonds; ++x) {
            if (feature == PULLED_THERE) c.f[3 * at(i) + x] *= 1e18;
            if (feature == FAST_THERE) c.v[3 * at(i) + x] *= 1e6;
            if (feature == IN_LINE_THERE) c.f[3 * at(i) + x] = c.v[3 * at(i) + x] = 0;
        }
}

void seam_features::put_bends(hostile_chain &c) const
{
    if (feature == IN_LINE_THERE) {
        for (std::size_t k = 0; k < atoms.size(); k += 2) bend(c, feature, atoms[k]);
        if (atoms.empty() || atoms[0] < 0 || atoms[0] > c.n_bonds) return;
        // near the origin, where differences of coordinates have roundings
        double off[3];
        for (std::size_t x = 0; x < 3; ++x) off[x] = 0.9999 * c.r[3 * at(atoms[0]) + x];
        for (std::size_t i = 0; i < c.r.size(); ++i) c.r[i] -= off[i % 3];
    }
    if (feature != SQUARE_THERE && feature != STRAIGHT_THERE && feature != FOLDED_THERE) return;
    for (const std::int64_t i : atoms) bend(c, feature, i);
}

seam_features at_all_seams(seam_feature feature, const std::vector<std::int64_t> &seams, int offset)
{
    seam_features out{feature, seams};
    for (std::size_t k = 0; k < seams.size(); ++k) out.atoms[k] += feature == IN_LINE_THERE && k % 2 ? 0 : offset;
    return out;
}

seam_features at_one_seam(seam_feature feature, const std::vector<std::int64_t> &seams, int offset, std::size_t one)
{
    if (seams.empty()) return {feature, {}};
    seam_features out{feature, {seams[one % seams.size()] + offset}};
    if (feature == IN_LINE_THERE) out.atoms.push_back(seams[(one + 1) % seams.size()]);
    return out;
}

namespace
{

/** One number as digits to several bases. */
struct digits {
    std::uint64_t left;
    int next(int base)
    {
        const int digit = static_cast<int>(left % static_cast<std::uint64_t>(base));
        left /= static_cast<std::uint64_t>(base);
        return digit;
    }
};

/** Rods are bent a little, so that their bonds are not all rounded alike (docs/stability.md). */
enum background { COIL, ROD, ROD_OF_UNEQUAL_MASSES, N_BACKGROUNDS };
constexpr double aside[N_BACKGROUNDS] = {1, 1e-3, 1e-11}, ahead[N_BACKGROUNDS] = {0, 1, 1};

struct seam_case {
    seam_feature feature;
    int offset, lanes;
    bool windows, all;
    background shape;
    explicit seam_case(std::uint64_t number)
    {
        digits d{number};
        feature = static_cast<seam_feature>(d.next(N_SEAM_FEATURES));
        offset = first_seam_offset + d.next(n_seam_offsets);
        lanes = lane_counts[d.next(n_lane_counts)];
        windows = d.next(2) == 0;
        all = d.next(2) == 0;
        shape = static_cast<background>(d.next(N_BACKGROUNDS));
    }
    /** Just enough for windows; with one lane they are longer. */
    std::int64_t n_bonds() const
    {
        return lanes == 1 ? 1100 : std::max(300, 100 * lanes);
    }
};

}  // namespace

std::uint64_t n_seam_chains()
{
    return N_SEAM_FEATURES * n_seam_offsets * n_lane_counts * 2 * 2 * N_BACKGROUNDS;
}

std::string words_of_seam_chain(std::uint64_t number)
{
    const seam_case s(number);
    static const char *const shapes[N_BACKGROUNDS] = {"a coil", "a rod", "a rod of light and heavy atoms"};
    return std::string(seam_feature_name(s.feature)) + (s.all ? " at all" : " at one of the") +
           (s.windows ? " windows" : " segments") + " of " + std::to_string(s.lanes) + " lanes, " +
           std::to_string(s.offset) + " behind the seam, in " + shapes[s.shape];
}

hostile_chain make_seam_chain(std::uint64_t number)
{
    const seam_case s(number);
    hostile_chain c;
    c.seed = number;
    c.n_bonds = s.n_bonds();
    const std::size_t atoms = at(c.n_bonds) + 1;
    c.w.resize(atoms), c.mass.resize(atoms);
    c.r.assign(3 * atoms, 0), c.v.resize(3 * atoms), c.f.resize(3 * atoms);
    random_stream stream = random_seed(number / (N_SEAM_FEATURES * n_seam_offsets));
    for (std::size_t i = 0; i < atoms; ++i)
        set_mass(c, i, s.shape == ROD_OF_UNEQUAL_MASSES ? (i % 2 ? 1e10 : 1e-10) : 1);
    const cuts where = cuts_of_chain(s.lanes, c.n_bonds);
    const std::vector<std::int64_t> &seams = s.windows ? where.windows : where.segments;
    const seam_features put =
        s.all ? at_all_seams(s.feature, seams, s.offset) : at_one_seam(s.feature, seams, s.offset, seams.size() / 2);
    put.put_masses(c);
    double along[3];
    random_direction(&stream, along);
    for (std::size_t k = 0; k + 1 < atoms; ++k) {
        double u[3];
        random_direction(&stream, u);
        for (std::size_t x = 0; x < 3; ++x)
            c.r[3 * k + 3 + x] = c.r[3 * k + x] + ahead[s.shape] * along[x] + aside[s.shape] * u[x];
    }
    put.put_bends(c);
    for (std::size_t i = 0; i < 3 * atoms; ++i) {
        const double v = random_normal(&stream), f = random_normal(&stream);
        c.v[i] = c.w[i / 3] == 0 ? 0 : v;
        c.f[i] = f;
    }
    put.put_forces(c);
    complete(c, 1e-3);
    return c;
}

}  // namespace stress
