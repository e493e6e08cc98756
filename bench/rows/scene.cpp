#include "scene.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rows {
namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

void shuffle(random_stream &s, std::vector<std::int64_t> &list) {
    for (std::size_t i = list.size(); i > 1; --i)
        std::swap(list[i - 1], list[at(random_integer(&s, 0, static_cast<std::int64_t>(i) - 1))]);
}

/// Bonds of all molecules, masses, and where the atoms stand.
void lay_out(Scene &scene, random_stream &s) {
    const Recipe &recipe = scene.recipe;
    std::vector<double> mass;
    for (std::int64_t m = 0; m < recipe.molecules; ++m) {
        const bench::Kind &kind = recipe.kinds[at(m) % recipe.kinds.size()];
        const auto first = static_cast<std::int64_t>(mass.size());
        for (std::size_t k = 0; k < kind.n_bonds(); ++k) {
            scene.pairs.push_back(first + kind.first[k]);
            scene.pairs.push_back(first + kind.second[k]);
            scene.length.push_back(kind.length[k]);
        }
        mass.insert(mass.end(), kind.mass.begin(), kind.mass.end());
    }
    scene.place.resize(mass.size());
    std::iota(scene.place.begin(), scene.place.end(), std::int64_t(0));
    if (recipe.order == Order::any) shuffle(s, scene.place);
    if (recipe.order == Order::apart) {
        const std::int64_t size = static_cast<std::int64_t>(mass.size()) / recipe.molecules;
        for (std::int64_t &i : scene.place) i = i % size * recipe.molecules + i / size;
    }
    for (std::int64_t &atom : scene.pairs) atom = scene.place[at(atom)];
    scene.mass.resize(mass.size());
    for (std::size_t i = 0; i < mass.size(); ++i) scene.mass[at(scene.place[i])] = mass[i];
}

/// At the density of a bead-rod melt, and no smaller than a bond can be across it.
void make_box(Scene &scene) {
    const double longest = *std::max_element(scene.length.begin(), scene.length.end());
    const double side = longest * std::max(4.0, std::cbrt(static_cast<double>(scene.atoms()) / 0.85));
    const double straight[9] = {side, 0, 0, 0, 1.1 * side, 0, 0, 0, 1.2 * side};
    std::copy(straight, straight + 9, scene.box);
    if (scene.recipe.box == Boxed::triclinic) {
        scene.box[3] = 0.3 * side;
        scene.box[6] = 0.2 * side;
        scene.box[7] = -0.25 * side;
    }
}

/// Every atom into the box, by itself: bonds cross its faces.
void wrap(const double *box, double *r) {
    for (int a = 2; a >= 0; --a) {
        const double shift = std::floor(r[a] / box[4 * a]);
        for (int x = 0; x < 3; ++x) r[x] -= shift * box[3 * a + x];
    }
}

void place(Scene &scene, random_stream &s) {
    const Recipe &recipe = scene.recipe;
    scene.r.resize(3 * scene.atoms());
    std::vector<double> own;
    std::size_t first = 0;
    for (std::int64_t m = 0; m < recipe.molecules; ++m) {
        const bench::Kind &kind = recipe.kinds[at(m) % recipe.kinds.size()];
        own.assign(3 * kind.n_atoms(), 0);
        bench::place_atoms(kind, s, own.data());
        double origin[3];
        for (int x = 0; x < 3; ++x) origin[x] = scene.box[4 * x] * random_uniform(&s);
        for (std::size_t i = 0; i < kind.n_atoms(); ++i) {
            double *const r = &scene.r[3 * at(scene.place[first + i])];
            for (std::size_t x = 0; x < 3; ++x) r[x] = origin[x] + own[3 * i + x];
            if (recipe.box != Boxed::no) wrap(scene.box, r);
        }
        first += kind.n_atoms();
    }
}

void move(Scene &scene, const Library &library, random_stream &s) {
    // Chemical molecules: nm, ps, kJ/mol, 300 K.
    const bool chemical = scene.recipe.kinds[0].chemical;
    const double kT = chemical ? 2.494 : 1;
    scene.dt = chemical ? 0.002 : 0.005;
    const double force = chemical ? 1000 : 1;
    for (std::size_t i = 0; i < scene.atoms(); ++i)
        for (int x = 0; x < 3; ++x) {
            scene.v.push_back(std::sqrt(kT / scene.mass[i]) * random_normal(&s));
            scene.f.push_back(force * std::sqrt(chemical ? 1 : scene.mass[i]) * random_normal(&s));
        }
    const Handle handle = make_handle(library, scene);
    std::vector<double> along = scene.v;
    library.check(library.hol_project_velocities(handle.get(), scene.r.data(), along.data(), nullptr, nullptr));
    for (std::size_t i = 0; i < along.size(); ++i) scene.moved.push_back(scene.r[i] + scene.dt * along[i]);
}

bool one_block(const Recipe &recipe) { return recipe.kinds.size() == 1 && recipe.order == Order::consecutive; }

void add_chains(const Library &library, const Scene &scene, hol_chains *chains) {
    const Recipe &recipe = scene.recipe;
    if (one_block(recipe)) {
        const bench::Kind &kind = recipe.kinds[0];
        return library.check(library.hol_chains_add_block(
            chains, recipe.molecules, static_cast<std::int64_t>(kind.n_bonds()), 0, kind.length.data()));
    }
    std::size_t first = 0;
    for (std::int64_t m = 0; m < recipe.molecules; ++m) {
        const bench::Kind &kind = recipe.kinds[at(m) % recipe.kinds.size()];
        library.check(library.hol_chains_add(chains, static_cast<std::int64_t>(kind.n_bonds()), &scene.place[first],
                                             kind.length.data()));
        first += kind.n_atoms();
    }
}

}  // namespace

Handle make_handle(const Library &library, const Scene &scene) {
    hol_chains *made = nullptr;
    const Recipe &recipe = scene.recipe;
    library.check(library.hol_chains_create(static_cast<std::int64_t>(scene.atoms()), scene.mass.data(), &made));
    Handle handle(made, library.hol_chains_destroy);
    const auto bonds = static_cast<std::int64_t>(scene.bonds());
    if (recipe.linear)
        add_chains(library, scene, made);
    else if (one_block(recipe))
        library.check(library.hol_chains_add_molecules(
            made, recipe.molecules, static_cast<std::int64_t>(recipe.kinds[0].n_atoms()), 0, bonds / recipe.molecules,
            scene.pairs.data(), scene.length.data()));
    else
        library.check(library.hol_chains_add_bonds(made, bonds, scene.pairs.data(), scene.length.data()));
    if (recipe.box != Boxed::no) library.check(library.hol_chains_set_box(made, scene.box));
    return handle;
}

Scene make_scene(const Recipe &recipe, const Library &library) {
    Scene scene;
    scene.recipe = recipe;
    random_stream s = random_seed(7);
    lay_out(scene, s);
    make_box(scene);
    place(scene, s);
    move(scene, library, s);
    return scene;
}

Recipe chains(std::int64_t n, std::int64_t bonds, const Chain &chain, std::int64_t kinds) {
    Recipe recipe;
    recipe.linear = true;
    recipe.molecules = n;
    random_stream s = random_seed(3);
    for (std::int64_t k = 0; k < kinds; ++k) {
        bench::KindMaker maker;
        auto mass = [&] { return chain.general_masses ? std::pow(10, 2 * random_uniform(&s) - 1) : chain.mass; };
        int last = maker.atom(mass());
        for (std::int64_t b = 0; b < bonds; ++b)
            last = maker.atom(mass(), last, chain.general_lengths ? 0.7 + 0.8 * random_uniform(&s) : 1);
        recipe.kinds.push_back(maker.done());
    }
    return recipe;
}

Recipe molecules(std::int64_t n, const std::vector<bench::Kind> &kinds) {
    Recipe recipe;
    recipe.molecules = n;
    recipe.kinds = kinds;
    return recipe;
}

}  // namespace rows
