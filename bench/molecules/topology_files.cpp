#include "topology_files.hpp"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>

namespace bench {
namespace {

std::string unpacked(const std::string &name) {
    std::FILE *pipe = popen(("gzip -dc '" + name + "'").c_str(), "r");
    if (!pipe) throw std::runtime_error("cannot run gzip");
    std::string text;
    char part[65536];
    for (std::size_t n; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) text.append(part, n);
    pclose(pipe);
    return text;
}

std::string contents(const std::string &name) {
    if (name.size() > 3 && name.substr(name.size() - 3) == ".gz") return unpacked(name);
    std::ifstream file(name);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A line without its comment, in words.
std::vector<std::string> words(const std::string &line) {
    std::istringstream stream(line.substr(0, line.find('#')));
    std::vector<std::string> list;
    for (std::string word; stream >> word;) list.push_back(word);
    return list;
}

class LammpsData {
public:
    LammpsData(const std::string &text, bool charges) : charges_(charges) {
        std::istringstream stream(text);
        std::string line, section;
        std::getline(stream, line);  // the title
        while (std::getline(stream, line)) {
            const std::vector<std::string> w = words(line);
            if (w.empty()) continue;
            const bool number = w[0].find_first_not_of("+-.0123456789eE") == std::string::npos;
            if (!number)
                section = w[0] + (w.size() > 1 ? " " + w[1] : "");
            else if (section.empty())
                head(w);
            else
                entry(section, w);
        }
        for (std::size_t i = 0; i < type_.size(); ++i) file.mass.push_back(masses_[type_[i]]);
        if (file.mass.empty() || file.bonds.empty()) throw std::runtime_error("a data file without atoms or bonds");
    }
    TopologyFile file;

private:
    void head(const std::vector<std::string> &w) {
        if (w.size() == 2 && w[1] == "atoms") {
            type_.resize(std::stoul(w[0]));
            file.r.resize(type_.size());
        }
        for (std::size_t x = 0; x < 3; ++x)
            if (w.size() == 4 && w[2] == std::string(1, "xyz"[x]) + "lo")
                file.box[x] = (std::stod(w[1]) - std::stod(w[0])) / 10;
    }
    void entry(const std::string &section, const std::vector<std::string> &w) {
        if (section == "Masses") masses_[std::stoi(w[0])] = std::stod(w[1]);
        if (section == "Bonds") file.bonds.push_back({std::stoi(w[2]) - 1, std::stoi(w[3]) - 1, std::stoi(w[1])});
        if (section != "Atoms") return;
        const std::size_t atom = std::stoul(w[0]) - 1, first = charges_ ? 4 : 3;
        type_.at(atom) = std::stoi(w[2]);
        for (std::size_t x = 0; x < 3; ++x) file.r[atom][x] = std::stod(w.at(first + x)) / 10;
    }
    bool charges_;
    std::map<int, double> masses_;
    std::vector<int> type_;
};

}  // namespace

TopologyFile read_lammps_data(const std::string &name, bool charges) {
    return LammpsData(contents(name), charges).file;
}

TopologyFile read_water_gro(const std::string &name) {
    std::istringstream stream(contents(name));
    std::string line;
    std::getline(stream, line);
    std::getline(stream, line);
    TopologyFile file;
    const int atoms = std::stoi(line);
    for (int i = 0; i < atoms && std::getline(stream, line); ++i) {
        const bool oxygen = line.substr(10, 5).find('O') != std::string::npos;
        file.mass.push_back(oxygen ? 15.9994 : 1.008);
        file.r.push_back({std::stod(line.substr(20, 8)), std::stod(line.substr(28, 8)), std::stod(line.substr(36, 8))});
        if (!oxygen) file.bonds.push_back({i - i % 3, i, 1});
    }
    if (std::getline(stream, line))
        for (std::size_t x = 0; x < 3; ++x) file.box[x] = std::stod(words(line).at(x));
    return file;
}

}  // namespace bench
