#!/bin/sh
# Builds all pages as a book in target/book, with the mdbook and the mathcore named as arguments.
set -eu
cd "$(dirname "$0")/.."
mdbook=$1
mathcore=$2
book=target/book-src
rm -rf "$book"
mkdir -p "$book/src"
cp docs/book.toml docs/book.css "$book"

# The pages where they stand in the repository, with what they show or link to.
git ls-files --cached --others --exclude-standard -- \
    '*.md' ':!.github' 'docs/**.png' docs/scene.schema.json \
    'validation/**' scenes 'LICENSE*' CITATION.cff 'tests/python/*.py' 'python/**' |
    while read -r file; do
        mkdir -p "$book/src/$(dirname "$file")"
        cp "$file" "$book/src/$file"
    done
# A README becomes the index of its folder.
find "$book/src" -name '*.md' -exec sed -i 's/\(](\([^)]*\/\)\{0,1\}\)README\.md/\1index.md/g' {} +

# A line of the table of contents for each page: its first heading.
entries() {
    indent=$1
    shift
    for page; do
        printf '%s- [%s](%s)\n' "$indent" "$(sed -n '/^# /{s/^# *//p;q}' "$page")" "$page"
    done
}
others() { # FOLDER: its pages beside the first one, README.md.
    find "$1" -maxdepth 1 -name '*.md' ! -name README.md | LC_ALL=C sort
}
{
    printf '# Summary\n\n'
    entries '' README.md docs/README.md docs/scenes.md docs/study.md docs/price-lists.md docs/performance.md
    entries '' docs/output.md
    entries '' docs/validation.md
    # shellcheck disable=SC2046 # Paths of the repository have no spaces.
    entries '    ' $(find validation -name README.md | LC_ALL=C sort)
    entries '' docs/comparison.md docs/plate-study.md docs/set-ups.md docs/stability.md docs/theory/README.md
    # shellcheck disable=SC2046
    entries '    ' $(others docs/theory)
    entries '' docs/architecture.md docs/protocol.md
    # shellcheck disable=SC2046
    entries '    ' python/README.md $(find python/examples -name README.md | LC_ALL=C sort)
    entries '' docs/decisions/README.md
    # shellcheck disable=SC2046
    entries '    ' $(others docs/decisions)
    entries '' CONTRIBUTING.md CHANGELOG.md shared/output/assets/README.md
} > "$book/src/SUMMARY.md"

"$mdbook" build "$book"

# Formulas are code to Markdown, so that it leaves them as they are: a block ```math, or $`...`$ within a line. What
# mdbook makes of them becomes MathML here. A formula with an error ends the script with the file's name.
"$mathcore" --recursive --inline-open '$<code>' --inline-close '</code>$' \
    --block-open '<pre><code class="language-math">' --block-close '</code></pre>' target/book
echo "The book: $PWD/target/book/index.html"
