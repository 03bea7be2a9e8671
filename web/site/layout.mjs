// What surrounds a page's text: bar, navigation, its own contents, the pages before and after it.
import { posix } from 'node:path';
import { escape_html } from './markdown.mjs';

// From one place of the site to another, so that it works from a disk.
export function find_way(from, to) {
  return posix.relative(posix.dirname(from), to);
}

function make_navigation(navigation, page) {
  const sections = navigation.sections.map(({ title, folded, pages }) => {
    const here = pages.includes(page);
    const items = pages.map((other) => {
      const current = other === page ? ' aria-current="page"' : '';
      return `<li><a href="${find_way(page.place, other.place)}"${current}>${escape_html(other.label)}</a></li>`;
    });
    return `<details${!folded || here ? ' open' : ''}><summary>${escape_html(title)}</summary><ul>${items.join('')}</ul></details>`;
  });
  return `<nav id="pages" aria-label="Pages">${sections.join('\n')}</nav>`;
}

function make_contents(headings) {
  const shown = headings.filter(({ level }) => level === 2 || level === 3);
  if (shown.length < 2) {
    return '<aside></aside>';
  }
  const items = shown.map(({ level, slug, text }) => `<li class="level-${level}"><a href="#${slug}">${escape_html(text)}</a></li>`);
  return `<aside aria-label="On this page"><p>On this page</p><ul>${items.join('')}</ul></aside>`;
}

function make_neighbours(navigation, page) {
  const index = navigation.pages.indexOf(page);
  const link = (other, name, word, label = other?.label) =>
    other
      ? `<a class="${name}" href="${find_way(page.place, other.place)}"><span>${word}</span>${escape_html(label)}</a>`
      : '<span></span>';
  // Where the page names no next step, the next page is one; after the last page, the first.
  const next = navigation.pages.find(({ source }) => source === page.step?.source) ?? navigation.pages[index + 1] ?? navigation.pages[0];
  const words = page.step?.words.replaceAll('`', '').replace(/^./, (letter) => letter.toUpperCase());
  return `<nav class="neighbours" aria-label="Neighbours">${link(navigation.pages[index - 1], 'before', 'Before')}${link(next, 'after', 'Next', words)}</nav>`;
}

// The theme is set before anything is drawn, so that a dark page never flashes white.
const kTheme = "try{var t=localStorage.getItem('armwright-theme');if(t)document.documentElement.dataset.theme=t}catch(e){}";

export function make_html(navigation, page, { html, headings }, version) {
  const root = find_way(page.place, 'x').slice(0, -1);
  const is_home = page === navigation.pages[0];
  const title = is_home ? navigation.title : `${page.title.replaceAll('`', '')} - ${navigation.title}`;
  return `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>${escape_html(title)}</title>
<script>${kTheme}</script>
<link rel="stylesheet" href="${root}site.css">
<link rel="icon" href="data:,">
</head>
<body data-root="${root}"${is_home ? ' class="home"' : ''}>
<a class="skip" href="#text">To the text</a>
<header>
<button id="menu" type="button" aria-expanded="false" aria-controls="pages" aria-label="Pages">&#9776;</button>
<a class="name" href="${root}index.html">${escape_html(navigation.title)}<span>${escape_html(version)}</span></a>
<div class="search" role="search"><input id="search" type="search" placeholder="Search ( / )" aria-label="Search" autocomplete="off" spellcheck="false"><div id="found" hidden></div></div>
<button id="theme" type="button" aria-label="Light or dark">&#9680;</button>
</header>
<div class="columns">
${make_navigation(navigation, page)}
<main id="text">
<article>
${html}</article>
${make_neighbours(navigation, page)}
<footer>Made from <code>${escape_html(page.source)}</code></footer>
</main>
${make_contents(headings)}
</div>
<script src="${root}site.js"></script>
</body>
</html>
`;
}
