// SPDX-License-Identifier: GPL-2.0-only
#include "template.hpp"

#include <fstream>
#include <sstream>

#include "../plan/registry.hpp"

namespace holonomic_lammps {

std::string text_of(MPI_Comm world, const std::string &file, const std::string &what) {
    std::string text, trouble;
    if (rank_of(world) == 0) {
        std::ifstream in(file);
        std::ostringstream all;
        all << in.rdbuf();
        if (!in) trouble = "the " + what + " " + file + " can't be read";
        text = all.str();
    }
    throw_together(world, trouble);
    int length = static_cast<int>(text.size());
    MPI_Bcast(&length, 1, MPI_INT, 0, world);
    text.resize(length);
    MPI_Bcast(&text[0], length, MPI_CHAR, 0, world);
    return text;
}

Template read_template(MPI_Comm world, const std::string &file) {
    std::istringstream lines(text_of(world, file, "molecule file"));
    const auto wrong = [&](const std::string &what) { return ErrorEverywhere("molecule file " + file + ": " + what); };
    Template molecule;
    molecule.name = "the file " + file;
    std::size_t n_coords = 0, n_types = 0;
    std::string line, section;
    std::getline(lines, line);  // a title
    while (std::getline(lines, line)) {
        std::istringstream words(line.substr(0, line.find('#')));
        std::string first, second;
        if (!(words >> first)) continue;
        if (first.find_first_not_of("+-.0123456789eE") != std::string::npos) {
            section = first;
            continue;
        }
        words >> second;
        if (section.empty() && second == "atoms") {
            molecule.types.assign(std::stoul(first), 0);
            molecule.at.assign(std::stoul(first), {0, 0, 0});
        }
        if (section != "Coords" && section != "Types") continue;
        const std::size_t k = std::stoul(first) - 1;
        if (k >= molecule.at.size()) throw wrong("there is no atom " + first);
        std::istringstream values(line);
        values >> first;
        const bool coords = section == "Coords";
        if (coords ? !(values >> molecule.at[k][0] >> molecule.at[k][1] >> molecule.at[k][2])
                   : !(values >> molecule.types[k]))
            throw wrong("not understood: " + line);
        ++(coords ? n_coords : n_types);
    }
    if (molecule.at.size() < 2 || n_coords != molecule.at.size() || n_types != molecule.at.size())
        throw wrong("a rigid molecule needs two atoms at least, and Coords and Types of all of them");
    return molecule;
}

}  // namespace holonomic_lammps
