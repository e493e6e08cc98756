# Pages for man out of the C header: one for each comment before a function or a type, named after what is declared there first;
# the other names lead to it. The conventions at the header's beginning are holonomic.h(3).
#
#   awk -v folder=FOLDER -v version=VERSION -f manual.awk holonomic.h holonomic.h      (read twice: first the names)

function name_of(line) {
    if (match(line, /hol_[a-z_]+\(/)) return substr(line, RSTART, RLENGTH - 1)
    if (match(line, /hol_[a-z_]+;$/)) return substr(line, RSTART, RLENGTH - 1)
    return ""
}
NR == FNR {
    if (/^(HOL_API|static inline|typedef|})/ && name_of($0) != "") documented[name_of($0)] = 1
    next
}

/^\/\*\*/ { flush_page(); n = m = 0; inside = 1; sub(/^\/\*\* ?/, "") }
inside {
    inside = !sub(/ *\*\/ *$/, "")
    sub(/^ \* ?/, "")
    if (n || $0 != "") comment[++n] = $0
    if (!inside && comment[1] ~ /^@file/) { comment[1] = "@file"; names = "holonomic.h"; write_page() }
    next
}
/^$/ || /^\/\*/ { flush_page(); next }
n { code[++m] = $0 }
END { flush_page() }

# What is declared after the comment; of a function with a body, its head.
function flush_page(    i, open, indented, k) {
    names = ""
    for (i = 1; i <= m; ++i) {
        if (open) { open = code[i] != "}"; continue }
        open = code[i] ~ /^static inline/
        if (open) sub(/ \{$/, ";", code[i])
        if ((code[i] ~ /^(HOL_API|static inline|typedef [^{]*;|}|typedef .*} )/) && name_of(code[i]) != "")
            names = names (names == "" ? "" : " ") name_of(code[i])
        if (sub(/^HOL_API /, "", code[i])) indented = 1; else if (code[i] ~ /^[^ ]/) indented = 0
        if (indented) sub(/^        /, "", code[i])
        sub(/ HOL_IS_INT/, "", code[i])
        sub(/\/\*\*</, "/*", code[i])
        shown[++k] = code[i]
    }
    for (i = 1; i <= k; ++i) code[i] = shown[i]
    m = k
    if (names != "") write_page()
    n = m = 0
}

function roff(text) {
    gsub(/\\/, "\\e", text)
    gsub(/-/, "\\-", text)
    return text ~ /^[.']/ ? "\\&" text : text
}
function put(line) { print line >page }

function write_page(    list, n_names, i) {
    n_names = split(names, list, " ")
    page = folder "/" list[1] ".3"
    put(".TH \"" list[1] "\" 3 \"\" \"holonomic " version "\" \"Library functions\"\n.nh\n.ad l\n.SH NAME")
    put(join(list, n_names) " \\- " roff(brief()))
    put(".SH SYNOPSIS\n.nf\n#include <holonomic.h>")
    if (m) put(".PP")
    for (i = 1; i <= m; ++i) put(roff(code[i]))
    put(".fi")
    write_part("text", "DESCRIPTION")
    write_part("@param", "ARGUMENTS")
    write_part("@return", "RETURN VALUE")
    see_also()
    close(page)
    for (i = 2; i <= n_names; ++i) {
        page = folder "/" list[i] ".3"
        put(".so man3/" list[1] ".3")
        close(page)
    }
}

function join(list, n_names,    text, i) {
    for (i = 1; i <= n_names; ++i) text = text (i > 1 ? ", " : "") list[i]
    return text
}

# The first sentence, or what stands of it before a colon.
function brief(    text, i) {
    for (i = 1; i <= n && comment[i] != "" && (i == 1 || comment[i] !~ /^@/); ++i) text = text " " comment[i]
    sub(/^ (@file )?/, "", text)
    sub(/[.:;]( .*)?$/, "", text) # the last one
    while (match(text, /[.:;] /)) text = substr(text, 1, RSTART - 1)
    return text
}

# The lines of one kind: text, or those from @param or @return to the next of these, or to a blank line. In text, items begin with a
# hyphen, and equations are indented.
function write_part(wanted, title,    i, line, kind, block) {
    kind = "text"
    for (i = 1; i <= n; ++i) {
        line = comment[i]
        if (line ~ /^@/) kind = line; else if (line == "") kind = "text"
        if (index(kind, wanted) != 1 || line == "@file") continue
        if (title != "") put(".SH " title)
        title = ""
        if (line ~ /^@param/) {
            argument(line)
        } else if (wanted != "text") {
            sub(/^(@return)? */, "", line)
            put(roff(line))
        } else if (line ~ /^    / && block != "item") {
            if (block == "") put(".PP\n.RS 4\n.nf")
            block = "code"
            put(roff(substr(line, 5)))
        } else {
            if (block == "code") put(".fi\n.RE")
            if (block == "code" || (block == "item" && line !~ /^(- |  )/) || line == "") { if (line !~ /^- /) put(".PP"); block = "" }
            if (line ~ /^- /) { put(".IP \\(bu 2"); block = "item"; line = substr(line, 3) }
            sub(/^ */, "", line)
            if (line != "") put(roff(line))
        }
    }
    if (block == "code") put(".fi\n.RE")
}

function argument(line,    way) {
    sub(/^@param */, "", line)
    if (match(line, /^\[[a-z,]*\] */)) {
        way = substr(line, 1, RLENGTH)
        line = substr(line, RLENGTH + 1)
        gsub(/[][ ]/, "", way)
    }
    if (!match(line, /^[A-Za-z_0-9]+(, *[A-Za-z_0-9]+)+ /)) match(line, /^[A-Za-z_0-9]+ ?/)
    put(".TP\n.IR " "\"" trimmed(substr(line, 1, RLENGTH)) "\"" (way == "" ? "" : " \" (" way ")\""))
    line = substr(line, RLENGTH + 1)
    sub(/^ */, "", line)
    put(line == "" ? "\\&" : roff(line))
}

function trimmed(text) {
    sub(/ +$/, "", text)
    return text
}

# What the comment names.
function see_also(    i, text, name, list, seen) {
    for (i = 1; i <= n + m; ++i) {
        text = i <= n ? comment[i] : code[i - n]
        while (match(text, /hol_[a-z_]*[a-z]/)) {
            name = substr(text, RSTART, RLENGTH)
            text = substr(text, RSTART + RLENGTH)
            if ((name in documented) && !(name in seen) && index(" " names " ", " " name " ") == 0) {
                seen[name] = 1
                list = list ".BR " name " (3),\n"
            }
        }
    }
    put(".SH SEE ALSO\n" list (names == "holonomic.h" ? "" : ".BR holonomic.h (3),\n") ".BR holonomic (3)")
}
