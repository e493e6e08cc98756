#include "markdown.hpp"

#include <cmath>
#include <cstdio>

namespace bench {

std::string number(double x) {
    if (std::isnan(x)) return "";
    char text[32];
    std::snprintf(text, sizeof text, std::fabs(x) >= 999.5 && std::fabs(x) < 1e6 ? "%.0f" : "%.3g", x);
    return text;
}

std::string error_text(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1e", x);
    return text;
}

std::string size_text(long long chains, long long bonds) {
    return std::to_string(chains) + " x " + std::to_string(bonds);
}

MarkdownTable::MarkdownTable(const std::vector<std::string> &head) {
    add(head);
    text_ += "|";
    for (std::size_t i = 0; i < head.size(); ++i) text_ += "---|";
    text_ += "\n";
    rows_ = 0;
}

void MarkdownTable::add(const std::vector<std::string> &cells) {
    text_ += "|";
    for (const std::string &cell : cells) text_ += " " + cell + (cell.empty() ? "|" : " |");
    text_ += "\n";
    ++rows_;
}

}  // namespace bench
