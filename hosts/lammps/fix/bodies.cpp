// SPDX-License-Identifier: GPL-2.0-only
#include "bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "../plan/registry.hpp"
#include "../plan/route.hpp"
#include "atom.h"
#include "domain.h"
#include "error.h"
#include "image.hpp"

using namespace LAMMPS_NS;
using namespace std::string_literals;

namespace holonomic_lammps {

/** Molecules as they stand share a shape if they differ by less than this part of its shortest distance. */
static constexpr double same_shape = 1e-6;

/** An atom of the group, of a molecule or of a body that is listed. */
struct Bodies::Part {
    Tag body, tag;
    int type;
    double x[3];
};

/** A molecule of the group or a listed body: its atoms in the order of IDs. */
struct Bodies::Group {
    const Part *first, *last;
    bool listed;
    std::size_t size() const { return last - first; }
};

/** The best template so far. */
struct Bodies::Fit {
    int best = -1;
    double part = HUGE_VAL, distance = 0;
};

void Bodies::needs_molecule_ids() const {
    if (!atom->molecule_flag)
        error->all(FLERR, "Fix holonomic: rigid needs molecule IDs, of the atom style or of fix property/atom mol"s);
}

void Bodies::add_file(const char *file) {
    needs_molecule_ids();
    templates_.push_back(read_template(world, file));
}

void Bodies::take_as_they_stand() {
    needs_molecule_ids();
    as_they_stand_ = true;
}

void Bodies::add_list(const char *file) {
    std::istringstream lines(text_of(world, file, "list of bodies"));
    std::string line;
    while (std::getline(lines, line)) {
        std::istringstream words(line.substr(0, line.find('#')));
        Tag number, type, tag;
        if (!(words >> number)) continue;
        const std::string name = "body " + std::to_string(number) + " of the file " + file;
        words >> type;
        std::set<Tag> tags;
        while (words >> tag)
            if (!tags.insert(tag).second) throw ErrorEverywhere(name + " has atom " + std::to_string(tag) + " twice");
        if (tags.size() < 2 || !words.eof())
            throw ErrorEverywhere(name +
                                  ": a number, a type and the IDs of two atoms at least are needed, not: " + line);
        for (Tag atom : tags) listed_[atom].push_back(first_name + static_cast<Tag>(lists_.size()));
        lists_.push_back({tags.size(), name});
    }
}

std::string Bodies::words(Tag name) const {
    return name < first_name ? "molecule " + std::to_string(name) : lists_[name - first_name].words;
}

/** Whether a group without a template becomes one. */
bool Bodies::stands(const Group &group) const {
    return group.size() > 1 && (as_they_stand_ || group.first->body >= first_name);
}

/** The bookkeeper of a body's name, which is a molecule ID or that of a list, learns of all its atoms. */
std::vector<Bodies::Part> Bodies::gather(int groupbit, const std::vector<int> &which) const {
    const int n_ranks = size_of(world);
    Outgoing<Part> outgoing(n_ranks);
    const auto tell = [&](Tag body, int i) {
        const double *x = atom->x[i];
        outgoing[bookkeeper(body, n_ranks)].push_back({body, atom->tag[i], atom->type[i], {x[0], x[1], x[2]}});
    };
    for (int i : which) {
        if (!(atom->mask[i] & groupbit)) continue;
        const auto listed = listed_.find(atom->tag[i]);
        if (listed != listed_.end())
            for (Tag body : listed->second) tell(body, i);
        else if (atom->molecule_flag && atom->molecule[i] > 0)
            tell(atom->molecule[i], i);
    }
    std::vector<Part> parts = route(world, outgoing).items;
    std::sort(parts.begin(), parts.end(),
              [](const Part &p, const Part &q) { return p.body != q.body ? p.body < q.body : p.tag < q.tag; });
    return parts;
}

std::vector<Bodies::Group> Bodies::group(const std::vector<Part> &parts) const {
    std::vector<Group> groups;
    std::string trouble;
    const Part *const end = parts.data() + parts.size();
    for (const Part *first = parts.data(), *last = first; first != end; first = last) {
        while (last != end && last->body == first->body) ++last;
        groups.push_back({first, last, first->body >= first_name});
        if (!groups.back().listed) continue;
        const Listed &body = lists_[first->body - first_name];
        if (groups.back().size() != body.size)
            trouble = body.words + " has " + std::to_string(body.size) + " atoms, of which " +
                      std::to_string(groups.back().size()) + " are in the group";
    }
    throw_together(world, trouble);
    return groups;
}

/** The molecule's positions in the images that are next to each other where the template's atoms are. */
Points Bodies::whole(const Group &molecule, const Points &shape) const {
    Points points(molecule.size());
    for (std::size_t k = 0; k < points.size(); ++k) std::copy_n(molecule.first[k].x, 3, points[k].begin());
    for (const auto &step : shortest_way(shape)) {
        auto &to = points[step[0]];
        const auto &from = points[step[1]];
        const double d[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
        const auto shift = image_vector(*domain, nearest_image(*domain, d));
        for (int c = 0; c < 3; ++c) to[c] += shift[c];
    }
    return points;
}

void Bodies::try_template(std::size_t t, const std::vector<Group> &groups, std::vector<Fit> &fits) const {
    const Template &molecule = templates_[t];
    const double shortest = shortest_distance(molecule.at);
    for (std::size_t g = 0; g < groups.size(); ++g) {
        if (groups[g].listed != molecule.listed) continue;
        if (!std::equal(groups[g].first, groups[g].last, molecule.types.begin(), molecule.types.end(),
                        [](const Part &p, int type) { return p.type == type; }))
            continue;
        const double distance = largest_displacement(molecule.at, whole(groups[g], molecule.at));
        if (distance / shortest < fits[g].part || fits[g].best < 0)
            fits[g] = {static_cast<int>(t), distance / shortest, distance};
    }
}

/** The first molecule that no template fits becomes one; gives whether there was one, on whatever rank. */
bool Bodies::adopt_next(double within, const std::vector<Group> &groups, const std::vector<Fit> &fits) {
    constexpr Tag none = std::numeric_limits<Tag>::max();
    Tag mine = none;
    std::size_t at = 0;
    for (; at < groups.size() && mine == none; ++at)
        if (stands(groups[at]) && !(fits[at].part < within)) mine = groups[at].first->body;
    Tag first = mine;
    MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT64_T, MPI_MIN, world);
    if (first == none) return false;
    const int owner = bookkeeper(first, size_of(world));
    Template stands;
    if (mine == first) {
        const Group &molecule = groups[at - 1];
        for (const Part *p = molecule.first; p != molecule.last; ++p) stands.types.push_back(p->type);
        // Atom by atom behind the nearest: no two atoms next to each other are further apart than half the box.
        Points points(1);
        std::copy_n(molecule.first->x, 3, points[0].begin());
        for (const Part *p = molecule.first + 1; p != molecule.last; ++p) {
            std::array<double, 3> best{};
            double least = HUGE_VAL;
            for (const auto &q : points) {
                const double d[3] = {p->x[0] - q[0], p->x[1] - q[1], p->x[2] - q[2]};
                const auto shift = image_vector(*domain, nearest_image(*domain, d));
                double square = 0;
                for (int c = 0; c < 3; ++c) square += std::pow(d[c] + shift[c], 2);
                if (square < least) least = square, best = {p->x[0] + shift[0], p->x[1] + shift[1], p->x[2] + shift[2]};
            }
            points.push_back(best);
        }
        stands.at = points;
    }
    int n = static_cast<int>(stands.at.size());
    MPI_Bcast(&n, 1, MPI_INT, owner, world);
    stands.types.resize(n);
    stands.at.resize(n);
    MPI_Bcast(stands.types.data(), n, MPI_INT, owner, world);
    MPI_Bcast(stands.at.data(), 3 * n, MPI_DOUBLE, owner, world);
    stands.name = words(first);
    stands.listed = first >= first_name;
    templates_.push_back(stands);
    return true;
}

void Bodies::check(const std::vector<Group> &groups, const std::vector<Fit> &fits) {
    Displacement most;
    Tag name = 0;
    for (std::size_t g = 0; g < groups.size(); ++g)
        if (fits[g].best >= 0 && fits[g].part > most.part)
            most.part = fits[g].part, most.distance = fits[g].distance, name = groups[g].first->body;
    struct {
        double part;
        int rank;
    } worst = {most.part, rank_of(world)};
    MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
    double numbers[4] = {most.part, most.distance, static_cast<double>(name), 0};
    for (std::size_t g = 0; g < groups.size(); ++g)
        if (groups[g].first->body == name) numbers[3] = std::max(fits[g].best, 0);
    MPI_Bcast(numbers, 4, MPI_DOUBLE, worst.rank, world);
    most_ = {numbers[0], numbers[1], words(static_cast<Tag>(numbers[2])), ""};
    if (!templates_.empty()) most_.name = templates_[static_cast<std::size_t>(numbers[3])].name;
    if (most_.part > too_far)
        throw ErrorEverywhere("an atom of " + most_.whose + " is " + std::to_string(most_.distance) + " from where " +
                              most_.name +
                              " has it, more than a tenth of its shortest distance: another shape, another order of "
                              "atoms, or the mirror image; rigid without a file takes molecules as they stand");
}

std::vector<BodyAtom> Bodies::select(int groupbit, const std::vector<int> &which) {
    std::vector<BodyAtom> bodies;
    if (empty()) return bodies;
    const std::vector<Part> parts = gather(groupbit, which);
    const std::vector<Group> groups = group(parts);
    std::vector<Fit> fits(groups.size());
    for (std::size_t t = 0; t < templates_.size(); ++t) try_template(t, groups, fits);
    if (as_they_stand_ || !lists_.empty())
        while (adopt_next(selected_ ? too_far : same_shape, groups, fits))
            try_template(templates_.size() - 1, groups, fits);
    selected_ = true;
    check(groups, fits);
    for (std::size_t g = 0; g < groups.size(); ++g) {
        if (fits[g].best < 0) continue;
        const Points &shape = templates_[fits[g].best].at;
        for (std::size_t k = 0; k < shape.size(); ++k)
            bodies.push_back({groups[g].first->body,
                              groups[g].first->tag,
                              groups[g].first[k].tag,
                              {shape[k][0], shape[k][1], shape[k][2]}});
    }
    return bodies;
}

}  // namespace holonomic_lammps
