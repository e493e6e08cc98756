#!/usr/bin/env bash
# Words that had a meaning of their own here, where the field has a word: none is back in the core or in its pages.
#
#   words.sh TOP
set -u
cd "$1" || exit 1
# word, and what is said now
words='
[Ff]lat_?[Ll]ist      sparse L D L^T
[Ff]orests?           batch of trees
[Oo]ne_?[Tt]ree       large tree
[Ss]chedules?         elimination plan
[Kk]nots?             junction
[Gg]uests?            ghost
[Tt]runks?            separator
[Cc]areful            extended precision
[Ff]ourfold           quad-double
[Tt]wofold            double-double
[Dd]oubtful           flagged
[Ff]aint              cancelling
[Tt]orn               overcorrected
[Pp]ieces?.of.work    chunk
Plan::Piece           Plan::Chunk
Form::(chain|tree)     Topology
LooseParts?           AffineParts
run/apart             run/staging
[Rr]oomy              padded
[Rr]emainder          effective inverse mass
pieces?.of.paths?     section
pieces?.of.(a.)?(large.)?trees?  tile
[Ss]lots?             index (in the order of elimination)
place_of              bond_index_of, site_of
(n_|At)[Pp]laces       row (of a batch of trees)
places_in_lanes       elements
(first|end)_place     first_index, end_index
(clear|add|give)_sides  contributions
size_of_side          size of the right-hand side
'
status=0
while read -r word now; do
    [ -n "$word" ] || continue
    # Whole words, and parts of identifiers.
    found=$(grep -rnE --include='*.cpp' --include='*.hpp' --include='*.md' --include='*.cmake' "(^|[^A-Za-z])$word([^a-z]|\$)" \
        core docs/architecture.md docs/stability.md docs/theory.md docs/performance.md docs/development/*.md | grep -v _knot_mask | head -n 5)
    [ -z "$found" ] || { echo "$found"; echo "^ the word is: $now"; status=1; }
done <<<"$words"
[ $status -ne 0 ] || echo "no old word"
exit $status
