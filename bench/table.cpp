#include "table.hpp"

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace bench {
namespace {

std::vector<std::vector<std::string>> read_csv(const std::string &name, std::size_t columns) {
    std::ifstream file(name);
    if (!file) throw std::runtime_error("cannot read " + name);
    std::vector<std::vector<std::string>> rows;
    std::string line;
    std::getline(file, line);  // the head
    while (std::getline(file, line)) {
        std::vector<std::string> cells;
        std::istringstream stream(line);
        for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
        if (cells.size() != columns)
            throw std::runtime_error(name + ": not " + std::to_string(columns) + " columns: " + line);
        rows.push_back(std::move(cells));
    }
    return rows;
}

}  // namespace

bool Measurement::is_molecule() const {
    for (const char *name : {"coil", "tetrahedral", "straight5", "light_joints", "fixed_ends", "melt"})
        if (problem == name) return false;
    return true;
}

Table::Table(const std::string &directory) {
    const auto results = read_csv(directory + "/results.csv", 10), spread = read_csv(directory + "/spread.csv", 13);
    if (results.size() != spread.size()) throw std::runtime_error("results.csv and spread.csv differ in length");
    for (std::size_t i = 0; i < results.size(); ++i) {
        const auto &r = results[i], &s = spread[i];
        Measurement m;
        m.level = r[0], m.problem = r[1], m.method = r[5], m.setting = r[6];
        m.chains = std::stoll(r[2]), m.bonds = std::stoll(r[3]), m.threads = std::stoi(r[4]);
        m.error = std::stod(r[7]), m.ns = std::stod(r[8]), m.passes = std::stod(r[9]);
        m.repetitions = std::stoi(s[7]), m.lower = std::stod(s[9]), m.upper = std::stod(s[11]);
        rows_.push_back(m);
    }
}

const Measurement *Table::find(const Key &key) const {
    for (const Measurement &m : rows_)
        if (m.level == key.level && m.problem == key.problem && m.chains == key.chains && m.bonds == key.bonds &&
            m.method == key.method && m.setting == key.setting && m.threads == key.threads)
            return &m;
    return nullptr;
}

double Table::ns(const Key &key) const {
    const Measurement *m = find(key);
    return m ? m->ns : std::nan("");
}

}  // namespace bench
