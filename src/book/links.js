// Links that leave the book lead to Markdown pages of the repository, which have no HTML beside them: see `book.toml`.
for (const link of document.querySelectorAll('main a[href^="../../"]')) {
    link.setAttribute("href", link.getAttribute("href").replace(/\.html(?=#|$)/, ".md"));
}
