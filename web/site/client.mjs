// In the reader's browser: search, theme, copying, the menu of small screens. Pages can be read without it.
import MiniSearch from 'minisearch';
import { find_parts, kSearch, make_excerpt } from './search.mjs';

const root = document.body.dataset.root;
const kMost = 12; // results shown

function find(id) {
  return document.getElementById(id);
}

// ---- Theme: the page's head has set what is stored; a choice made in another tab comes by itself ----
const kStored = 'armwright-theme';
find('theme').addEventListener('click', () => {
  const element = document.documentElement;
  const dark = element.dataset.theme ? element.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  element.dataset.theme = dark ? 'light' : 'dark';
  try {
    localStorage.setItem(kStored, element.dataset.theme);
  } catch {
    // Some browsers keep nothing for files; the next page then has the system's theme.
  }
});
addEventListener('storage', ({ key, newValue }) => {
  if (key === kStored && newValue) {
    document.documentElement.dataset.theme = newValue;
  }
});

// ---- Copying: of a session what is typed, of everything else all ----
for (const button of document.querySelectorAll('.copy')) {
  button.addEventListener('click', async () => {
    const figure = button.closest('figure');
    const typed = [...figure.querySelectorAll('.typed')].map((line) => line.textContent);
    const text = figure.classList.contains('console') ? typed.join('\n') : figure.querySelector('code').textContent;
    try {
      await navigator.clipboard.writeText(`${text}\n`);
      button.textContent = 'Copied';
    } catch {
      getSelection().selectAllChildren(figure.querySelector('code'));
      button.textContent = 'Selected';
    }
    setTimeout(() => (button.textContent = 'Copy'), 1500);
  });
}

// ---- Boxes that scroll: the keyboard reaches them while something in them is cut ----
const observer = new ResizeObserver((entries) => {
  for (const { target: box } of entries) {
    const is_cut = box.scrollWidth > box.clientWidth;
    const attributes = { tabindex: '0', role: 'group', 'aria-label': box.tagName === 'PRE' ? 'Code' : 'Table' };
    for (const [name, value] of Object.entries(attributes)) {
      if (is_cut) {
        box.setAttribute(name, value);
      } else {
        box.removeAttribute(name);
      }
    }
  }
});
document.querySelectorAll('.table, figure.code pre').forEach((box) => observer.observe(box));

// ---- The menu ----
const menu = find('menu');
menu.addEventListener('click', () => {
  const open = document.body.classList.toggle('menu-open');
  menu.setAttribute('aria-expanded', String(open));
});
// The page's own line of a long navigation is in sight.
const current = document.querySelector('#pages [aria-current]');
if (current) {
  const pages = find('pages');
  pages.scrollTop = current.offsetTop - pages.clientHeight / 2;
}

// ---- Which part of the page is in sight ----
const marks = new Map([...document.querySelectorAll('aside a')].map((link) => [decodeURIComponent(link.hash.slice(1)), link]));
const headings = [...marks.keys()].map(find).filter(Boolean);
function mark() {
  const passed = headings.filter((heading) => heading.getBoundingClientRect().top < 120).at(-1) ?? headings[0];
  for (const [id, link] of marks) {
    link.classList.toggle('here', passed?.id === id);
  }
}
if (headings.length > 0) {
  addEventListener('scroll', mark, { passive: true });
  mark();
}

// ---- Search: the index comes with the first letter ----
const input = find('search');
const found = find('found');
let index;
function load_index() {
  index ??= new Promise((resolve, reject) => {
    const script = document.createElement('script');
    script.src = `${root}search-index.js`;
    script.onload = () => resolve(MiniSearch.loadJS(globalThis.armwright_index, kSearch));
    script.onerror = () => reject(new Error(`${script.src} cannot be read`));
    document.head.append(script);
  });
  return index;
}

function make_result({ place, slug, page, title, text, terms }) {
  const link = document.createElement('a');
  link.href = root + place + (slug ? `#${slug}` : '');
  for (const [tag, content] of [
    ['strong', title || page],
    ['small', title ? page : ''],
    ['span', make_excerpt(text, terms)],
  ]) {
    if (content) {
      link.append(Object.assign(document.createElement(tag), { textContent: content }));
    }
  }
  return link;
}

async function search() {
  const words = input.value.trim();
  if (words === '') {
    found.hidden = true;
    return;
  }
  const results = find_parts(await load_index(), words).slice(0, kMost);
  if (input.value.trim() !== words) {
    return; // typed on meanwhile
  }
  found.replaceChildren(...results.map(make_result));
  if (results.length === 0) {
    found.append(Object.assign(document.createElement('p'), { textContent: `Nothing about "${words}"` }));
  }
  found.hidden = false;
}

input.addEventListener('input', search);
input.addEventListener('focus', search);
function step(by) {
  const links = [...found.querySelectorAll('a')];
  const next = links.indexOf(document.activeElement) + by;
  (next < 0 ? input : links[Math.min(next, links.length - 1)])?.focus();
}
document.addEventListener('keydown', (event) => {
  const typing = event.target.closest('input, textarea');
  if (event.key === '/' && !typing && !event.ctrlKey && !event.metaKey) {
    event.preventDefault();
    input.focus();
    input.select();
  } else if (event.key === 'Escape') {
    found.hidden = true;
    input.blur();
  } else if (!found.hidden && (event.key === 'ArrowDown' || event.key === 'ArrowUp')) {
    event.preventDefault();
    step(event.key === 'ArrowDown' ? 1 : -1);
  } else if (event.key === 'Enter' && event.target === input) {
    found.querySelector('a')?.click();
  }
});
document.addEventListener('click', (event) => {
  if (!event.target.closest('.search')) {
    found.hidden = true;
  }
});
// A result may be on this very page.
found.addEventListener('click', () => (found.hidden = true));
